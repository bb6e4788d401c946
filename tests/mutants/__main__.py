"""Draw mutants once, and see which of them the tests kill: `python -m tests.mutants --seed S [--only K] [--resume]`.

The list of a seed is written to `tests/mutants/seed-S.json` before any of them runs; where it is there, it stands.
What became of each is in `seed-S-results.json` beside it.  Sixty take about half an hour on one core.

A list whose survivors got tests says what these catch; a list that is drawn anew, what the tests catch of anything.
"""

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from tests.mutants.chosen import chosen_for, importers
from tests.mutants.drawn import COUNT, ROOT, Mutant, draw, kept, list_of, written
from tests.mutants.known import EQUIVALENT
from tests.mutants.running import ready
from tests.mutants.trial import Verdict, copied, tried

PATIENCE_S = 120.0
"""Of a processor, for one mutant; one that lives longer counts as one that survives."""
KILLED = frozenset({"killed", "timed out"})
ENOUGH = 0.9
"""What share the tests have to kill."""


def main() -> int:
    """Return the exit code: 1 where too many survive."""
    asked = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    asked.add_argument("--seed", type=int, default=1, metavar="S", help="of the list")
    asked.add_argument("--only", type=int, metavar="K", help="the mutant of this number")
    asked.add_argument("--resume", action="store_true", help="those that have not run")
    asked.add_argument("--seconds", type=float, default=PATIENCE_S, help="of a processor, for each")
    asked.add_argument("--files", type=int, metavar="N", help="ask at most the N likeliest files of tests")
    words = asked.parse_args()
    ready()
    mutants_file = list_of(words.seed)
    results = mutants_file.with_name(f"{mutants_file.stem}-results.json")
    if not mutants_file.exists():
        mutants_file.write_text(written(draw(ROOT, words.seed, COUNT)), "utf-8")
    mutants = kept(mutants_file)
    found = verdicts(results) if words.resume or words.only else {}
    wanted = [mutant for mutant in mutants if words.only in {None, mutant.number}]
    waiting = [mutant for mutant in wanted if not (words.resume and mutant.number in found)]
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        for _ in go_through(copied(ROOT, Path(folder)), waiting, found, words.seconds, words.files):
            results.write_text(as_text(found), "utf-8")
    known = EQUIVALENT.get(words.seed, {})
    print(summary(mutants, found, known))
    return 0 if share(mutants, found, known) >= ENOUGH else 1


def go_through(
    tree: Path, waiting: Sequence[Mutant], found: dict[int, Verdict], seconds: float, most: int | None
) -> Iterator[None]:
    """Try mutants one after the other, and yield after each is entered."""
    known = importers(tree)
    for mutant in waiting:
        tests = chosen_for(tree, known, mutant.file)
        verdict = tried(tree, mutant, tests[:most], seconds)
        found[mutant.number] = replace(verdict, whole=verdict.whole and most is None)
        print(told(mutant, found[mutant.number]), flush=True)
        yield


def verdicts(file: Path) -> dict[int, Verdict]:
    """Return what is known from earlier runs."""
    rows = json.loads(file.read_text("utf-8")) if file.exists() else []
    return {row["number"]: Verdict(**row) for row in rows}


def as_text(found: dict[int, Verdict]) -> str:
    """Return what became of the mutants as JSON, one a line."""
    return "[\n" + ",\n".join(json.dumps(asdict(found[number])) for number in sorted(found)) + "\n]\n"


def told(mutant: Mutant, verdict: Verdict) -> str:
    """Return a line about a mutant."""
    change = f"{mutant.before} -> {mutant.after or 'nothing'}" if mutant.kind != "return" else "another value returned"
    how = f"{verdict.verdict} by {verdict.by}" if verdict.by else f"{verdict.verdict}, {verdict.tests} tests"
    return f"{mutant.number:3d} {mutant.file}:{mutant.line}:{mutant.column} {change}: {how}"


def counted(mutants: Sequence[Mutant], found: dict[int, Verdict], known: dict[int, str]) -> Counter[str]:
    """Return how many came to what; those that nothing can tell from the program are `equivalent` in any case."""
    return Counter(
        "equivalent" if one.number in known else found[one.number].verdict if one.number in found else "not run"
        for one in mutants
    )


def share(mutants: Sequence[Mutant], found: dict[int, Verdict], known: dict[int, str]) -> float:
    """Return the share of the killed among those that ran and could be noticed."""
    count = counted(mutants, found, known)
    killed = sum(count[how] for how in KILLED)
    return killed / max(killed + count["survived"], 1)


def summary(mutants: Sequence[Mutant], found: dict[int, Verdict], known: dict[int, str]) -> str:
    """Return what became of all of them, and why some are not counted."""
    count = ", ".join(f"{number} {how}" for how, number in sorted(counted(mutants, found, known).items()))
    reasons = [f"  {number} is equivalent: {reason}" for number, reason in sorted(known.items())]
    return "\n".join([f"{len(mutants)} mutants: {count}; {share(mutants, found, known):.0%} killed", *reasons])


if __name__ == "__main__":
    sys.exit(main())
