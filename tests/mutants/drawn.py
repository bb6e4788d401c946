"""Lists of mutants: each drawn once from all that there are, and found again where the program has moved since.

As many of each package, and in a package of as many kinds as can be: drawn from all places alike, half of them would be
numbers, and a third would lie in the geometry.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random

from tests.mutants.operators import Change, changes

ROOT = Path(__file__).parents[2]
PACKAGES = ("pipeline", "stages")
SHARED = {"stages": "stages/model", "pipeline/asmade": "pipeline", "pipeline/cad": "pipeline"}
"""Files beside the stages count as of the values that pass between them: they are the errors that do."""
COUNT = 60


@dataclass(frozen=True, slots=True)
class Mutant:
    """A change with its place as one reads it: line and column count from 1, `text` is the line without its margin."""

    number: int
    file: str
    line: int
    column: int
    kind: str
    before: str
    after: str
    text: str


def list_of(seed: int) -> Path:
    """Return where the list of a seed is kept."""
    return Path(__file__).with_name(f"seed-{seed}.json")


def package(file: str) -> str:
    """Return the package of a file: a stage, or a part of the pipeline."""
    folders = file.split("/")[:-1]
    name = "/".join(folders[:2])
    return SHARED.get(name, name)


def read_as(file: str, source: bytes, number: int, change: Change) -> Mutant:
    """Return a change as one reads it."""
    line = source.count(b"\n", 0, change.begin) + 1
    start = source.rfind(b"\n", 0, change.begin) + 1
    text = source[start:].split(b"\n", 1)[0].decode().strip()
    column = len(source[start : change.begin].decode()) + 1
    return Mutant(number, file, line, column, change.kind, change.before, change.after, text)


def every(root: Path) -> Iterator[tuple[str, Change]]:
    """Yield all mutants of a tree with the names of their files."""
    for name in PACKAGES:
        for path in sorted((root / name).rglob("*.py")):
            file = path.relative_to(root).as_posix()
            yield from ((file, change) for change in changes(path.read_bytes()))


def draw(root: Path, seed: int, count: int) -> list[Mutant]:
    """Return as many mutants of each package, of different kinds as far as there are enough."""
    random, places = Random(seed), sorted_by_kind(every(root))
    share, rest = divmod(count, len(places))
    chosen = []
    for i, kinds in enumerate(places.values()):
        wanted = share + (i < rest)
        names = (random.sample(sorted(kinds), len(kinds)) * wanted)[:wanted]
        chosen += [random.choice(kinds[name]) for name in names]
    return [read_as(file, (root / file).read_bytes(), i, change) for i, (file, change) in enumerate(chosen, start=1)]


Places = dict[str, dict[str, list[tuple[str, Change]]]]


def sorted_by_kind(found: Iterator[tuple[str, Change]]) -> Places:
    """Return all mutants by package, and there by kind."""
    places: Places = {}
    for file, change in found:
        places.setdefault(package(file), {}).setdefault(change.kind, []).append((file, change))
    return dict(sorted(places.items()))


def found_again(mutant: Mutant, source: bytes) -> Change | None:
    """Return the change where its line stands today, the nearest if there are several; None where it is gone."""
    places = [
        (abs(today.line - mutant.line), abs(today.column - mutant.column), change.begin, change)
        for change in changes(source)
        if (change.kind, change.before, change.after) == (mutant.kind, mutant.before, mutant.after)
        for today in [read_as(mutant.file, source, mutant.number, change)]
        if today.text == mutant.text
    ]
    return min(places, key=lambda place: place[:3])[-1] if places else None


def written(mutants: Sequence[Mutant]) -> str:
    """Return the list as JSON, a mutant a line."""
    rows = ",\n".join(json.dumps(asdict(mutant), ensure_ascii=False) for mutant in mutants)
    return f"[\n{rows}\n]\n"


def kept(file: Path) -> list[Mutant]:
    """Return the mutants of a list."""
    return [Mutant(**row) for row in json.loads(file.read_text("utf-8"))]
