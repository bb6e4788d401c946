from math import pi

import numpy as np
import pytest

from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from tests.near import assert_near, assert_relative
from tests.parts import QUINTIC_TANGENT, RIGHT_FRUSTUM, Passage, Table, passage
from tests.stages.geometry.ruled.test_drill import HALF_TUBE
from tests.stages.unroll.test_features import PLATE, rows

AREA = 100.0 * 40.0 * pi
"""Of the half tube, flat: 100 along x, 40 pi along y."""


def notched(*notches: Table, surface: Table = HALF_TUBE) -> Passage:
    found = passage(surface, notch=list(notches))
    assert found.pattern is not None, found.reports
    return found


@pytest.mark.parametrize(
    ("notch", "tip"),
    [
        ({"edge": "c0", "at": "0.5"}, [3.0, 20.0 * pi]),
        ({"edge": "c1", "at": "0.25"}, [97.0, 10.0 * pi]),
        ({"edge": "start", "at": "0.3"}, [30.0, 3.0]),
        ({"edge": "end", "distance": 30}, [30.0, 40.0 * pi - 3.0]),
        ({"edge": "c1", "distance": 25}, [97.0, 25.0]),
    ],
)
def test_a_v_notch_takes_its_triangle_and_points_into_the_part(notch: Table, tip: list[float]) -> None:
    outer = notched(notch).pattern.outer  # type: ignore[union-attr]
    assert_near([contours.area(outer.edges)], [AREA - 4.5], bound=1e-9, why="a triangle 3 wide and 3 deep")
    assert_near([arcpath.area(outer.path)], [AREA - 4.5], bound=1e-9, why="all edges are straight here")
    nearest = outer.path.vertices[np.argmin(np.abs(outer.path.vertices - tip).sum(axis=1))]
    assert_near(nearest, tip, bound=1e-11, why="closed form")


def test_on_a_curved_edge_the_notch_is_as_wide_along_the_edge_as_asked() -> None:
    found = notched({"edge": "c0", "at": "0.5", "width": 4, "depth": 5}, surface=QUINTIC_TANGENT)
    plain = notched(surface=QUINTIC_TANGENT)
    edges, before = found.pattern.outer.edges, plain.pattern.outer.edges  # type: ignore[union-attr]
    sides = [edge for edge in edges if arcpath_length(edge) < 10.0]
    rest = contours.length(edges) - sum(arcpath_length(edge) for edge in sides)
    assert len(sides) == 2
    assert_near([rest], [contours.length(before) - 4.0], bound=1e-9, why="what was taken of the outline")
    assert_relative(
        [arcpath_length(edge) for edge in sides], [np.hypot(2, 5)] * 2, bound=1e-2, why="hardly curved there"
    )


def arcpath_length(edge: object) -> float:
    return contours.length([edge])  # type: ignore[list-item]


def test_a_slit_is_a_line_on_mark_and_leaves_the_outline_alone() -> None:
    found = notched({"edge": "c0", "at": "0.5", "kind": "slit", "depth": 4})
    assert found.pattern is not None
    (mark,) = found.pattern.marks
    assert mark.layer == "MARK"
    assert_near(mark.path.vertices, [[0.0, 20.0 * pi], [4.0, 20.0 * pi]], bound=1e-11, why="closed form")
    assert_near([contours.area(found.pattern.outer.edges)], [AREA], bound=1e-9, why="nothing is cut")


def test_many_notches_take_their_triangles_each() -> None:
    many = [{"edge": edge, "at": f"0.{k}"} for edge in ("c0", "c1", "start", "end") for k in (2, 4, 6, 8)]
    found = notched(*many)
    assert found.pattern is not None
    assert_near([contours.area(found.pattern.outer.edges)], [AREA - 16 * 4.5], bound=1e-9, why="closed form")
    assert len(rows(found, "marks")) == 16


@pytest.mark.parametrize(
    ("notches", "code"),
    [
        ([{"edge": "c0", "at": "0.001"}], "notch-off-edge"),
        ([{"edge": "c0", "at": "0.5"}, {"edge": "c0", "at": "0.51"}], "notches-overlap"),
        ([{"edge": "start", "at": "0.5", "depth": 130}], "contour-crosses-itself"),
    ],
)
def test_a_notch_that_cannot_be_cut_is_refused(notches: list[Table], code: str) -> None:
    found = passage(HALF_TUBE, notch=notches)
    assert found.codes("unroll", fatal=True) == [code]


def test_a_distance_beyond_the_edge_is_refused() -> None:
    assert passage(HALF_TUBE, notch=[{"edge": "c0", "distance": 126}]).codes("construct") == ["place-outside"]
    assert passage(HALF_TUBE, notch=[{"edge": "start", "distance": 101}]).codes("construct") == ["place-outside"]
    assert passage(PLATE, notch=[{"edge": "outline", "distance": 321}]).codes("unroll") == ["notch-off-edge"]


def test_a_plate_is_notched_by_the_length_of_its_outline() -> None:
    found = notched({"edge": "outline", "distance": 130}, surface=PLATE)
    (row,) = rows(found, "marks")
    assert_near([row["x"], row["y"]], [100.0, 30.0], bound=1e-12, why="100 along the first side, 30 up the second")
    assert_near([found.side("flat")["area"]], [6000.0 - 4.5], bound=1e-10, why="closed form")


def test_the_seam_of_a_frustum_can_be_notched_on_both_sides() -> None:
    found = notched({"edge": "start", "at": "0.5", "width": "0.3", "depth": "0.2"},
                    {"edge": "end", "at": "0.5", "width": "0.3", "depth": "0.2"}, surface=RIGHT_FRUSTUM)  # fmt: skip
    plain = notched(surface=RIGHT_FRUSTUM)
    areas = [contours.area(one.pattern.outer.edges) for one in (plain, found)]  # type: ignore[union-attr]
    assert_near([areas[0] - areas[1]], [0.06], bound=1e-12, why="two triangles of 0.03")


ROUND: Table = {"kind": "flat", "outline": {"circle": {"center": [0, 0, 0], "radius": 50, "normal": [0, 0, 1]}}}


@pytest.mark.parametrize("kind", ["v", "castle", "u"])
@pytest.mark.parametrize("distance", [0, 1, 314])
def test_a_round_plate_may_be_notched_where_its_outline_begins(kind: str, distance: int) -> None:
    there, across = (
        notched({"edge": "outline", "distance": at, "kind": kind}, surface=ROUND).pattern for at in (100, distance)
    )
    areas = [contours.area(one.outer.edges) for one in (there, across)]  # type: ignore[union-attr]
    assert_near([areas[1]], [areas[0]], bound=1e-9, why="a circle is alike everywhere")
    assert_near([arcpath.area(across.outer.path)], [areas[0]], bound=1e-9, why="lines and arcs")  # type: ignore[union-attr]


def test_a_notch_may_run_across_the_corner_where_the_outline_begins() -> None:
    found = notched({"edge": "outline", "distance": 1}, surface=PLATE)
    assert_near([found.side("flat")["area"]], [6000.0 - 4.0], bound=1e-10, why="(0, .5), (0, 0), (2.5, 0), (1, 3)")
    both = notched(*({"edge": "outline", "distance": at} for at in (1, 50, 310)), surface=PLATE)
    assert_near([both.side("flat")["area"]], [6000.0 - 4.0 - 9.0], bound=1e-10, why="and two triangles")


@pytest.mark.parametrize("distances", [(1, "318.5"), (0, 2), ("319.5", 317)])
def test_notches_that_meet_across_the_beginning_are_refused(distances: tuple[object, object]) -> None:
    found = passage(PLATE, notch=[{"edge": "outline", "distance": at} for at in distances])
    assert found.codes("unroll", fatal=True) == ["notches-overlap"]


def test_a_notch_as_wide_as_the_outline_is_refused() -> None:
    found = passage(ROUND, notch=[{"edge": "outline", "distance": 10, "width": 315}])
    assert found.codes("unroll", fatal=True) == ["notches-overlap"]
