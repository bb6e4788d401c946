"""What is drawn: a valid job, up to four changes to its values, keys and structure, and the text of it, spoiled or not.

Most changes leave a job that is read in full, so that the stages see numbers that no one means; some break the file.
Time limits of the nest are not changed: a job may ask for as much time as it likes.
"""

from collections.abc import Callable, Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass

from hypothesis import strategies as st

from tests.fuzz.rendering import Raw, as_json, as_toml
from tests.fuzz.seeds import OFTEN, RARE, SEEDS

Path = tuple[str | int, ...]
Change = Callable[[st.DrawFn, dict[str, object], Path], None]

SIZES = (
    "0", "-0", "1e-390", "4.9e-324", "1e-204", "1e-21", "1e-20", "6.1e-17", "1e-13", "1e-9", "1e-6", "1e-3", "1e-2",
    "1e2", "1e4", "1e6", "1e9", "1e10", "1e308", "1e309", "1e999999999", "nan", "inf", "NaN", "Infinity", "1" * 101,
    "9" * 5000, "0x7fffffffffffffff", "9223372036854775808", "1_0", "0b1", "1.", "07", "2020-01-01", "12:30:00",
)  # fmt: skip
FACTORS = (-1, 0, 1e-6, 1e-3, 0.1, 0.5, 0.9, 1.0001, 1.5, 2, 10, 1e3, 1e6)
TEXTS = (
    "", " ", "../../x", "/etc/passwd", "/dev/zero", "sample:../x.stl", "CON", "nul.txt", "a\0b", "x" * 300, "é",
    "e\u0301", "<script>alert(1)</script>", "=cmd()", '"quotes" & \'more\'', "0\r\nEOF\r\n", "\u202e\u2028",
    "{job}", "{0.__class__}", "%s%n", "$(id)", "1/0", "1/3", "12 in", "1e5 mm", "3 deg", "0.1 rad", "free", "any",
    "part.1", "x.y", "\x7f", "漢字",
)  # fmt: skip
RAW_TEXTS = ('"\\ud800"', '"\\uDFFF"', '"\\u0000"', "null", "true", "[]", "{}", "[[]]", "''", '"\\x"', "\x00")
JSON_SHARE = 3


@dataclass(frozen=True, slots=True)
class Drawn:
    """A job file: its name and its bytes."""

    name: str
    content: bytes


def paths(value: object, path: Path = ()) -> Iterator[Path]:
    """Yield the ways to everything in a table, but to the time limit."""
    for key, item in _items(value):
        if key != "time_limit":
            yield (*path, key)
            yield from paths(item, (*path, key))


def _items(value: object) -> Iterable[tuple[str | int, object]]:
    if isinstance(value, dict):
        return value.items()
    return enumerate(value) if isinstance(value, list) else ()


KNOWN = sorted({str(way[-1]) for table in SEEDS.values() for way in paths(table)})
"""The names that job files have for things, and some numbers."""


def at(value: object, path: Path) -> object:
    """Return what lies there."""
    for step in path:
        value = value[step]  # type: ignore[index]
    return value


def put(table: object, path: Path, value: object) -> None:
    """Set what lies there."""
    at(table, path[:-1])[path[-1]] = value  # type: ignore[index]


def _extreme(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    put(table, path, Raw(draw(st.sampled_from(("", "-"))) + draw(st.sampled_from(SIZES))))


def _scaled(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    value = at(table, path)
    factor = draw(st.sampled_from(FACTORS))
    put(table, path, value * factor if isinstance(value, int | float) and not isinstance(value, bool) else factor)


def _text(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    text = draw(st.sampled_from(TEXTS) | st.sampled_from(RAW_TEXTS).map(Raw) | st.text(max_size=20))
    put(table, path, text)


def _deleted(_draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    del at(table, path[:-1])[path[-1]]  # type: ignore[attr-defined]


def _renamed(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    owner = at(table, path[:-1])
    if isinstance(owner, dict):
        owner[draw(st.sampled_from(KNOWN) | st.sampled_from(TEXTS))] = owner.pop(path[-1])


def _grafted(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    other = SEEDS[draw(st.sampled_from(sorted(SEEDS)))]
    alike = [way for way in paths(other) if way[-1] == path[-1]] or list(paths(other))
    put(table, path, deepcopy(at(other, draw(st.sampled_from(alike)))))


def _repeated(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    owner = at(table, path[:-1])
    if isinstance(owner, list) and isinstance(path[-1], int):
        owner[path[-1] : path[-1]] = [deepcopy(owner[path[-1]]) for _ in range(draw(st.integers(1, 12)))]


def _wrapped(draw: st.DrawFn, table: dict[str, object], path: Path) -> None:
    deep = draw(st.sampled_from((1, 2, 40)))
    value = deepcopy(at(table, path))
    for _ in range(deep):
        value = [value] if draw(st.booleans()) else {"chain": [value]}
    put(table, path, value)


CHANGES: tuple[Change, ...] = (
    _extreme, _extreme, _scaled, _scaled, _scaled, _text, _deleted, _renamed, _grafted, _grafted, _repeated, _wrapped,
)  # fmt: skip
NUMERIC = (_extreme, _scaled)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


@st.composite
def tables(draw: st.DrawFn) -> dict[str, object]:
    """Return a job with up to four changes."""
    names = RARE if draw(st.integers(0, 11)) == 0 else OFTEN
    table = deepcopy(SEEDS[draw(st.sampled_from(names))])
    for _ in range(draw(st.integers(1, 4))):
        change = draw(st.sampled_from(CHANGES))
        ways = [way for way in paths(table) if change not in NUMERIC or _is_number(at(table, way))]
        if ways:
            change(draw, table, draw(st.sampled_from(ways)))
    return table


@st.composite
def job_files(draw: st.DrawFn) -> Drawn:
    """Return a job file; one in twenty is spoiled as a text too."""
    table = draw(tables())
    in_json = draw(st.integers(0, JSON_SHARE)) == 0
    text = as_json(table) if in_json else as_toml(table)
    content = text.encode("utf-8", "surrogatepass")
    if draw(st.integers(0, 19)) == 0:
        place = draw(st.integers(0, len(content)))
        content = content[:place] + draw(st.binary(max_size=8)) + content[place + draw(st.integers(0, 20)) :]
    return Drawn("job.json" if in_json else "job.toml", content)
