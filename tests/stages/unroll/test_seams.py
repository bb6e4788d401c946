"""Seams on an outline: the edges they take, divided where they begin, and places along them in their own sense."""

import numpy as np
import pytest

from stages.geometry.curves.plane import Segment
from stages.model.pattern import FlatPattern
from stages.model.report import Finding
from stages.model.sewing import SeamSpec
from stages.unroll.seams import Seams, seams
from tests.near import assert_near
from tests.parts import Table, passage, read
from tests.stages.geometry.ruled.test_drill import HALF_TUBE

BOX: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [100, 0], [100, 40], [0, 40], [0, 0]]}}
STRETCH: Table = {"edge": "outline"}
LONG = 40.0 * np.pi
"""Of the half tube's c0 and c1, wound; its rulings are 100 long along x."""


def specs(*tables: Table) -> tuple[SeamSpec, ...]:
    return read(BOX, seam=[{"allowance": 5} | table for table in tables]).seam


def pattern(surface: Table) -> FlatPattern:
    found = passage(surface).pattern
    assert found is not None
    return found


def found(surface: Table, *tables: Table) -> Seams:
    made = seams(pattern(surface), specs(*tables))
    assert isinstance(made, Seams)
    return made


def at(made: Seams, name: str, fraction: float) -> np.ndarray:
    number, t = made.lines[name].places(np.array([fraction]))
    return made.outline[number[0]].at(t)[0]


@pytest.mark.parametrize(
    ("edge", "length", "quarter"),
    [
        ("c0", LONG, [0.0, LONG / 4.0]),
        ("c1", LONG, [100.0, LONG / 4.0]),
        ("start", 100.0, [25.0, 0.0]),
        ("end", 100.0, [25.0, LONG]),
    ],
)
def test_the_sides_of_a_strip_run_with_u_and_v(edge: str, length: float, quarter: list[float]) -> None:
    made = found(HALF_TUBE, {"edge": edge})
    assert_near([made.lines[edge].length_mm], [length], bound=1e-10, why="closed form")
    assert_near(at(made, edge, 0.25), quarter, bound=1e-10, why="a quarter of the way from the beginning")


def test_a_stretch_of_an_outline_divides_it_where_it_begins_and_ends() -> None:
    made = found(BOX, {"edge": "outline", "from": 30, "to": 120})
    assert len(made.outline) == 6, "two of the four edges are in two pieces"
    assert_near([made.lines["outline"].length_mm], [90.0], bound=1e-12, why="from 30 to 120")
    for fraction, place in ((0.0, [30, 0]), (7.0 / 9.0, [100, 0]), (1.0, [100, 20])):
        assert_near(at(made, "outline", fraction), place, bound=1e-10, why="along the box")


def test_a_stretch_may_pass_the_beginning_of_the_outline() -> None:
    made = found(BOX, {"edge": "outline", "from": 260, "to": 10})
    assert_near([made.lines["outline"].length_mm], [30.0], bound=1e-12, why="20 before it and 10 after")
    assert_near(at(made, "outline", 0.5), [0.0, 5.0], bound=1e-10, why="down the last edge")


@pytest.mark.parametrize("off", [-0.009, 0.0, 0.009])
def test_an_end_beside_a_corner_is_the_corner(off: float) -> None:
    made = found(BOX, {"edge": "outline", "from": 100 + off, "to": 140 - off})
    assert len(made.outline) == 4
    assert_near([made.lines["outline"].length_mm], [40.0], bound=1e-12, why="the whole edge")


def test_the_end_of_the_outline_is_its_beginning() -> None:
    made = found(BOX, {"edge": "outline", "from": 240, "to": 280})
    assert made.lines["outline"].numbers == (3,)


def test_a_spot_is_found_again_on_the_divided_outline() -> None:
    whole, made = pattern(BOX).outer.edges, found(BOX, {"edge": "outline", "from": 30, "to": 120})
    for number, edge in enumerate(whole):
        for t in (0.0, 0.2, 0.3, 0.31, 0.9, 1.0):
            piece, inner = made.spot((number, t))
            here, there = edge.at(np.array([t]))[0], made.outline[piece].at(np.array([inner]))[0]
            assert_near(there, here, bound=1e-12, why="one place")
    assert all(isinstance(edge, Segment) for edge in made.outline)


@pytest.mark.parametrize(
    ("tables", "code"),
    [
        ([{"edge": "c0"}], "no-such-edge"),
        ([{"edge": "outline", "from": 0, "to": 300}], "seam-off-edge"),
        (
            [STRETCH | {"name": "a", "from": 0, "to": 50}, STRETCH | {"name": "b", "from": 40, "to": 90}],
            "seams-overlap",
        ),
    ],
)
def test_what_no_seam_can_be_is_a_finding(tables: list[Table], code: str) -> None:
    wrong = seams(pattern(BOX), specs(*tables))
    assert isinstance(wrong, Finding) and wrong.fatal
    assert wrong.code == code


def test_an_edge_without_a_seam_belongs_to_none() -> None:
    made = found(HALF_TUBE, {"edge": "c0"})
    assert [made.of_edge(i) is not None for i in range(len(made.outline))].count(True) == len(made.lines["c0"].numbers)
