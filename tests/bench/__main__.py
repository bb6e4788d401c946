"""The benchmark: planish beside what one would take instead, on one machine in one run, as one table.

`python3 dev.py bench` takes some ten minutes on two cores that have nothing else to do (`--full` takes 25);
`--write BENCHMARKS.md` keeps the table, and leaves what stands in that file under `## Longer runs`, which other
commands measured.  Each topic runs in a process of its own, one after the other.  One that fails is told, the others
run, and the end is 1.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from tests.bench.rows import Asked, Section
from tests.bench.sections import TOPICS, alone
from tests.bench.surroundings import heading
from tests.bench.tables import as_markdown, as_text, longer

ONE_THREAD = "OPENBLAS_NUM_THREADS"
"""As the program itself has it, for all: the matrices are small."""
MINUTE_S = 60.0


def main(words: Sequence[str]) -> None:
    """Run the topics that were asked for and show their rows."""
    given = parsed(words)
    asked = Asked(extent="quick" if given.quick else "full" if given.full else "usual", seconds=given.seconds)
    os.environ.setdefault(ONE_THREAD, "1")
    head, start, sections = heading(asked), perf_counter(), list[Section]()
    try:
        for name in given.only or TOPICS:
            print(f"{name} ...", file=sys.stderr, flush=True)
            sections.append(alone(name, asked))
    except KeyboardInterrupt:
        sys.exit(as_text(head, sections) + "\ninterrupted: the topics so far")
    head = head._replace(minutes=(perf_counter() - start) / MINUTE_S)
    print(as_text(head, sections))
    if given.write:
        before = given.write.read_text("utf-8") if given.write.exists() else ""
        given.write.write_text(as_markdown(head, sections) + longer(before), "utf-8")
    failed = [one.name for one in sections if one.failed]
    sys.exit(f"failed: {', '.join(failed)}" if failed else 0)


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """Return what the words ask for."""
    asks = argparse.ArgumentParser("dev.py bench", description=__doc__.partition("\n")[0])
    asks.add_argument("--only", nargs="+", choices=TOPICS, help="these topics alone")
    sizes = asks.add_mutually_exclusive_group()
    sizes.add_argument("--quick", action="store_true", help="small sizes: whether all of it works, no figures to keep")
    sizes.add_argument("--full", action="store_true", help="the largest sizes too, which take 25 minutes")
    asks.add_argument("--seconds", type=float, default=Asked().seconds, help="for each nesting engine on each instance")
    asks.add_argument("--write", type=Path, metavar="FILE", help="write the table there as Markdown")
    given = asks.parse_args(words)
    if given.write and (given.only or given.quick):
        asks.error("--write keeps one run of all topics: without --only and --quick")
    return given


if __name__ == "__main__":
    main(sys.argv[1:])
