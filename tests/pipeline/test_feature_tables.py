import copy
import pickle
from fractions import Fraction
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from stages.errors import BadInputError
from stages.model.curves import in_numbers
from stages.model.features import CircleHole, CurveHole
from stages.model.scalars import coordinate
from tests.near import assert_near
from tests.parts import passage

TUBE = """
[[part]]
name = "tube"
[part.surface]
kind = "cylinder"
directrix = { arc = { center = [0, 0, 0], radius = 2, start = 0, end = 180 } }
direction = [0, 0, 1]
length = 4
"""
PLATE = """
[[part]]
name = "plate"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]] }
"""


def problems(folder: Path, text: str, units: str = "mm") -> list[str]:
    file = folder / "job.toml"
    file.write_text(f'schema = 1\nunits = "{units}"\n{text}', "utf-8")
    with pytest.raises(BadInputError) as caught:
        read(file)
    return [f"{problem.path}: {problem.message}" for problem in caught.value.problems]


def job(folder: Path, text: str, units: str = "mm") -> object:
    file = folder / "job.toml"
    file.write_text(f'schema = 1\nunits = "{units}"\n{text}', "utf-8")
    return job_of(read(file))


@pytest.mark.parametrize("units", ["mm", "in", "m"])
def test_u_and_v_are_pure_numbers_in_every_unit(tmp_path: Path, units: str) -> None:
    curve = '[[part.hole]]\nkind = "curve"\ncurve = { circle = { center = [0.5, 0.5], radius = 0.25 } }\n'
    text = f'{TUBE}[[part.hole]]\nkind = "circle"\nat = [0.5, "1/3"]\ndiameter = 0.5\n{curve}'
    made = job(tmp_path, text, units)
    hole, window = made.parts[0].spec.hole  # type: ignore[attr-defined]
    assert isinstance(hole, CircleHole) and isinstance(window, CurveHole)
    assert [str(x.plain) for x in hole.at] == ["1/2", "1/3"]
    circle = in_numbers(window.curve).circle
    assert circle is not None
    assert_near([float(x) for x in (*circle.center, circle.radius)], [0.5, 0.5, 0.25], bound=0.0, why="as typed")


def test_on_a_plate_and_in_space_coordinates_are_lengths(tmp_path: Path) -> None:
    text = f'{PLATE}[[part.hole]]\nkind = "circle"\nat = [2, "10 mm"]\ndiameter = 0.5\n'
    (hole,) = job(tmp_path, text, "in").parts[0].spec.hole  # type: ignore[attr-defined]
    assert_near([float(x) for x in hole.at], [50.8, 10.0], bound=0.0, why="exact fractions, rounded once")
    text = f'{TUBE}[[part.mark]]\nkind = "point"\nat = [0, 2, 1]\n'
    (mark,) = job(tmp_path, text, "in").parts[0].spec.mark  # type: ignore[attr-defined]
    assert_near([float(x) for x in mark.at], [0.0, 50.8, 25.4], bound=0.0, why="exact fractions, rounded once")


def test_a_coordinate_keeps_what_was_typed_through_copies() -> None:
    inch = coordinate(Fraction(127, 10), Fraction(1, 2))
    for other in (copy.copy(inch), copy.deepcopy(inch), pickle.loads(pickle.dumps(inch))):
        assert (other, other.plain) == (inch, inch.plain)
    assert pickle.loads(pickle.dumps(coordinate(inch, None))).plain is None


HOLE = '[[part.hole]]\nkind = "circle"\ndiameter = 1\n'
MARK = '[[part.mark]]\nkind = "point"\n'
BAD = {
    "u off the surface": (f"{TUBE}{HOLE}at = [1.5, 0.5]\n", ["part[0].hole[0].at[0]: u = 1.5"]),
    "v before the surface": (f"{TUBE}{MARK}at = [0.5, -0.5]\n", ["part[0].mark[0].at[1]: v = -0.5"]),
    "u with a unit": (f'{TUBE}{HOLE}at = ["1 mm", 0.5]\n', ["part[0].hole[0].at: u and v with a unit"]),
    "a curve with a unit": (
        f'{TUBE}[[part.hole]]\nkind = "curve"\ncurve = {{ circle = {{ center = [0.5, 0.5], radius = "1 mm" }} }}\n',
        ["part[0].hole[0].curve: u and v with a unit"],
    ),
    "two and three coordinates": (
        f'{TUBE}[[part.mark]]\nkind = "curve"\ncurve = {{ line = [[0, 0], [1, 1, 1]] }}\n',
        ["part[0].mark[0].curve: points of two and of three coordinates"],
    ),
    "one coordinate": (f"{TUBE}{HOLE}at = [0.5]\n", ["part[0].hole[0].at: an array of 1"]),
    "no diameter": (f"{TUBE}{HOLE.replace('1', '0')}at = [0.5, 0.5]\n", ["part[0].hole[0].diameter: 0"]),
    "a kind that is none": (f'{TUBE}[[part.hole]]\nkind = "slot"\n', ['part[0].hole[0].kind: unknown kind "slot"']),
    "rulings of a plate": (
        f'{PLATE}[[part.mark]]\nkind = "rulings"\ncount = 3\n',
        ["part[0].mark[0].kind: a plate has no rulings"],
    ),
    "a notch without a place": (
        f'{TUBE}[[part.notch]]\nedge = "c0"\n',
        ["part[0].notch[0].at: exactly one of at and distance"],
    ),
    "an edge of a plate": (
        f'{PLATE}[[part.notch]]\nedge = "c0"\ndistance = 1\n',
        ['part[0].notch[0].edge: no edge "c0" on this kind'],
    ),
    "letters beyond ASCII": (
        f'{TUBE}[[part.mark]]\nkind = "text"\nat = [0.5, 0.5]\nheight = 1\ntext = "Größe"\n',
        ["part[0].mark[0].text: letters that are not ASCII"],
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_wrong_feature_is_told_with_its_key(tmp_path: Path, name: str) -> None:
    text, wanted = BAD[name]
    assert problems(tmp_path, text) == wanted


def test_the_same_part_in_inches_has_the_same_pattern() -> None:
    """In inches the lengths grow by 25.4 and u and v do not."""
    tube = {"kind": "cylinder", "direction": [0, 0, 1], "length": "101.6",
            "directrix": {"arc": {"center": [0, 0, 0], "radius": "50.8", "start": 0, "end": 180}}}  # fmt: skip
    found = passage(tube, hole=[{"kind": "circle", "at": ["0.5", "0.5"], "diameter": "12.7"}])
    (hole,) = found.side("flat")["holes"]  # type: ignore[misc]
    assert_near([hole["x"], hole["y"]], [50.8, 25.4 * 3.141592653589793], bound=1e-11, why="closed form")
