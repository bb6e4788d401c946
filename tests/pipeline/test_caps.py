"""Job files that hold too much: what is at a cap passes, what is one beyond is refused, and before any work."""

import json
from collections.abc import Callable
from pathlib import Path
from time import process_time

import pytest

from pipeline.jobfile import read
from pipeline.jobrules import alike
from pipeline.layoutfile import SCHEMA, layout_of
from pipeline.parse import DEEPEST, LARGEST_FILE, MOST_VALUES, parse, refuse_huge
from pipeline.units import LARGEST, LEAST, MOST_DIGITS, UnreadableError, quantity
from stages.errors import BadInputError
from stages.model import caps
from stages.model.curves import MOST_TURNS
from stages.model.scalars import Length, Number
from tests.pipeline.jobs import write_job

FILE = Path("job.json")
SOON_S = 20.0
"""Of the processor, for what takes a fraction of a second, and minutes where it grows with the square."""
Job = dict[str, object]


def job(surface: object = None, **keys: object) -> Job:
    """Return a job of one plate, with other keys."""
    flat = surface or {"kind": "flat", "outline": {"circle": {"center": [0, 0], "radius": 9}}}
    return {"schema": 1, "part": [{"name": "p", "surface": flat}]} | keys


def part(**keys: object) -> Job:
    """Return a job of one plate with other keys of its part."""
    made = job()
    made["part"][0] |= keys  # type: ignore[index]
    return made


def wrong(count: int) -> list[int]:
    """Return items of which each is wrong: at the cap they are complained about, not their number."""
    return [0] * count


def steps(count: int) -> list[list[int]]:
    """Return points that are all different from the ones before."""
    return [[i % 7, i] for i in range(count)]


def plate(outline: object) -> Job:
    return job({"kind": "flat", "outline": outline})


def spline(count: int) -> object:
    return {"bspline": {"degree": 1, "knots": wrong(9), "points": wrong(count)}}


CIRCLE = {"circle": {"center": [0, 0], "radius": 1}}
PLANE = {"kind": "cylinder", "directrix": {"line": [[0, 0, 0], [9, 0, 0]]}, "direction": [0, 0, 1], "length": 5}
STOCK = {"id": "s", "width": 9, "height": 9}
CAPS: dict[str, tuple[int, Callable[[int], Job]]] = {
    "parts": (caps.MOST_PARTS, lambda n: job(part=wrong(n))),
    "copies": (caps.MOST_COPIES, lambda n: part(quantity=n)),
    "stock": (caps.MOST_STOCK, lambda n: job(stock=wrong(n))),
    "defects": (caps.MOST_PLACES, lambda n: job(stock=[STOCK | {"defects": wrong(n)}])),
    "holes": (caps.MOST_FEATURES, lambda n: job({"kind": "flat", "outline": CIRCLE, "holes": wrong(n)})),
    "marks": (caps.MOST_FEATURES, lambda n: part(mark=wrong(n))),
    "points": (caps.MOST_POINTS, lambda n: plate({"polyline": wrong(n)})),
    "points of a spline": (caps.MOST_POINTS, lambda n: plate({"points": wrong(n)})),
    "control points": (caps.MOST_POINTS, lambda n: plate(spline(n))),
    "a chain": (caps.MOST_PIECES, lambda n: plate({"chain": wrong(n)})),
    "a strip": (caps.MOST_PIECES, lambda n: job({"kind": "strip", "pieces": wrong(n)})),
    "angles": (caps.MOST_ANGLES, lambda n: part(rotations=[None] * n)),
    "rows": (caps.MOST_ROWS, lambda n: job(material={"k_factor": wrong(n)})),
    "the degree of a Bezier curve": (16, lambda n: plate({"bezier": steps(n)})),
    "the degree of a B-spline": (15, lambda n: plate({"bspline": {"degree": n, "knots": [], "points": steps(2)}})),
    "gores": (100, lambda n: job({"kind": "elbow", "diameter": 9, "angle": 90, "gores": n, "bend_radius": 50})),
    "turns": (
        MOST_TURNS,
        lambda n: job(
            {"kind": "tangent", "edge": {"helix": {"radius": 9, "pitch": 1, "turns": n}}, "from": 1, "to": 2}
        ),
    ),
    "a length": (caps.LARGEST_MM, lambda n: job(PLANE | {"length": n})),
    "a coordinate": (caps.LARGEST_MM, lambda n: job(PLANE | {"directrix": {"line": [[0, 0, 0], [-n, 0, 0]]}})),
}
BEYOND = ("is needed)", "at most", "nothing that is cut is larger")


def complaints(folder: Path, table: Job) -> list[str]:
    """Return what is complained about in a job that may be wrong for many reasons."""
    file = write_job(folder, json.dumps(table), "job.json")
    try:
        read(file)
    except BadInputError as error:
        return [str(problem) for problem in error.problems]
    return []


@pytest.mark.parametrize("name", CAPS)
def test_at_a_cap_nothing_is_said_of_it_and_one_beyond_is_refused_at_once(tmp_path: Path, name: str) -> None:
    most, made = CAPS[name]
    before = process_time()
    beyond = complaints(tmp_path, made(most + 1))
    assert process_time() - before < SOON_S
    assert any(words in text for words in BEYOND for text in beyond), beyond[:3]
    new = {*beyond} - {*complaints(tmp_path, made(most))}
    assert new, "one beyond is refused for what it has more"


def test_copies_of_all_parts_are_counted_together(tmp_path: Path) -> None:
    two = job()
    first = two["part"][0]  # type: ignore[index]
    two["part"] = [first | {"name": "a", "quantity": caps.MOST_COPIES - 1}, first | {"name": "b", "quantity": 1}]
    assert complaints(tmp_path, two) == []
    two["part"][1]["quantity"] = 2
    (told,) = complaints(tmp_path, two)
    assert told.endswith("part[1].quantity: 100001 copies in all (at most 100000 in one job: divide it)")


def nested(depth: int) -> object:
    value: object = 1
    for _ in range(depth):
        value = [value]
    return value


def test_tables_are_as_deep_as_they_may_be_and_no_deeper() -> None:
    refuse_huge(nested(DEEPEST - 1), FILE)
    with pytest.raises(BadInputError, match=f"nested too deeply .at most {DEEPEST}"):
        refuse_huge(nested(DEEPEST), FILE)


def test_a_file_holds_as_many_values_as_it_may_and_no_more() -> None:
    refuse_huge([0] * (MOST_VALUES - 1), FILE)
    with pytest.raises(BadInputError, match=f"more than {MOST_VALUES} values"):
        refuse_huge([0] * MOST_VALUES, FILE)


def test_a_layout_of_as_many_copies_as_a_job_may_have_is_read(tmp_path: Path) -> None:
    row = {"part": "p", "copy": 1, "x": 1.5, "y": -2.25, "angle": 90.0, "mirrored": False}
    sheet = {"stock": "s", "index": 1, "placements": [row] * caps.MOST_COPIES}
    layout = layout_of(json.dumps({"schema": SCHEMA, "sheets": [sheet]}).encode(), tmp_path / "layout.json")
    assert [len(rows.rows) for rows in layout.sheets] == [caps.MOST_COPIES]
    assert layout.complaints == ()


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"a":' * 100_000, "a=" + "[" * 100_000, "a=" + "{a=" * 100_000, "[" + "a." * 20_000 + "a]"]
)
@pytest.mark.parametrize("name", ["job.json", "job.toml"])
def test_depth_that_no_parser_takes_is_a_problem_of_the_file_and_told_in_time(text: str, name: str) -> None:
    before = process_time()
    with pytest.raises(BadInputError):
        refuse_huge(parse(text, Path(name)), Path(name))
    assert process_time() - before < SOON_S


def test_numbers_are_as_long_and_as_large_as_they_may_be_and_no_more() -> None:
    assert quantity(Length, LARGEST) == LARGEST
    assert quantity(Number, f"1.{'0' * (MOST_DIGITS - 1)}") == 1
    assert quantity(Number, float(LEAST)) > 0
    for beyond in (
        LARGEST + 1,
        f"1.{'0' * MOST_DIGITS}",
        "1e-21",
        5e-324,
        1e308,
        float("nan"),
        float("inf"),
        -float("inf"),
    ):
        with pytest.raises(UnreadableError):
            quantity(Number, beyond)


@pytest.mark.parametrize("text", ["a" * 10**6, "a." * 10**6, '"' * 10**6, "'a'." * 10**6, "a " * 10**6])
def test_looking_for_long_names_takes_no_longer_than_the_text_is_long(text: str) -> None:
    before = process_time()
    with pytest.raises(BadInputError):
        parse(f"x = 1\n{text}", Path("job.toml"))
    assert process_time() - before < SOON_S


def test_a_dotted_name_is_as_long_as_it_may_be_and_no_longer() -> None:
    deep = parse("a." * (DEEPEST - 1) + "a = 1", Path("job.toml"))
    assert list(deep) == ["a"]
    with pytest.raises(BadInputError, match=r"job.toml:2: tables or arrays are nested too deeply"):
        parse("b = 1\n" + "a." * DEEPEST + "a = 1", Path("job.toml"))


@pytest.mark.parametrize("digits", [4299, 4301, 100_000])
@pytest.mark.parametrize("name", ["job.json", "job.toml"])
def test_a_number_of_thousands_of_digits_is_refused_in_time(tmp_path: Path, digits: int, name: str) -> None:
    number = "9" * digits
    text = f'{{"schema": {number}}}' if name.endswith("json") else f"schema = {number}"
    before = process_time()
    with pytest.raises(BadInputError):
        read(write_job(tmp_path, text, name))
    assert process_time() - before < SOON_S


def test_a_job_file_is_cut_off_at_its_largest_size(tmp_path: Path) -> None:
    file = tmp_path / "job.toml"
    with file.open("wb") as stream:
        stream.truncate(LARGEST_FILE + 1)
    with pytest.raises(BadInputError, match="larger than 20 MB"):
        read(file)


def test_names_that_look_alike_are_one_name(tmp_path: Path) -> None:
    assert len({alike(name) for name in ("É", "é", "e\u0301", "E\u0301")}) == 1
    assert len({alike(name) for name in ("e", "é", "ss")}) == 3
    assert alike("ß") == alike("SS")
    two = job()
    first = two["part"][0]  # type: ignore[index]
    two["part"] = [first | {"name": "é"}, first | {"name": "E\u0301"}]
    (told,) = complaints(tmp_path, two)
    assert "is taken" in told
