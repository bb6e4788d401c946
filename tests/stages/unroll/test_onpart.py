"""Marks cut off where the part ends: at the outline, at notches and at holes, to closed forms."""

from math import acos, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.paths.arcpath import ArcPath, length
from stages.model.pattern import Contour, Mark
from stages.unroll.onpart import CLIP_MM, left_off, on_part
from stages.unroll.outline import contour
from tests.near import assert_near, assert_relative
from tests.parts import MITRED_CYLINDER, RIGHT_FRUSTUM, Table, passage

CHORD = 0.05
WIDE, HIGH = 100.0, 60.0


def plate(*corners: tuple[float, float]) -> Contour:
    points = np.array(corners or ((0.0, 0.0), (WIDE, 0.0), (WIDE, HIGH), (0.0, HIGH)))
    edges = tuple(Segment(a, b) for a, b in zip(points, np.roll(points, -1, axis=0), strict=True))
    return contour(edges, CHORD, "plate")


def hole(x: float, y: float, radius: float) -> Contour:
    return contour((CircularArc(np.array([x, y], dtype=np.float64), float(radius), 0.0, -2.0 * pi),), CHORD, "hole")


def line(*points: tuple[float, float], closed: bool = False) -> Mark:
    return Mark("line", ArcPath(np.array(points), np.zeros(len(points)), closed=closed))


def ends(marks: tuple[Mark, ...]) -> list[list[float]]:
    return [[*mark.path.vertices[0], *mark.path.vertices[-1]] for mark in marks]


def test_a_line_ends_at_a_hole_and_goes_on_behind_it() -> None:
    made = on_part([line((0.0, 30.0), (100.0, 30.0))], plate(), [hole(50.0, 30.0, 10.0)])
    assert [mark.name for mark in made] == ["line", "line"]
    assert_near(ends(made), [[0, 30, 40, 30], [60, 30, 100, 30]], bound=CLIP_MM, why="the polygon of the circle")


@given(st.floats(-40.0, 40.0), st.floats(-9.0, 9.0), st.floats(1.0, 10.0))
def test_what_is_left_of_a_line_is_its_length_without_the_chord_of_the_hole(x: float, y: float, radius: float) -> None:
    made = on_part([line((0.0, 30.0), (100.0, 30.0))], plate(), [hole(50.0 + x * 0.9, 30.0 + y, radius)])
    half = np.sqrt(max(radius**2 - y**2, 0.0))
    left = sum(length(mark.path) for mark in made)
    # radially the polygon is off by the clip, and what lies in the hole by twice the chord at most stays
    least, most = (max(radius - r, 0.0) ** 2 - y**2 for r in (-CLIP_MM, 2.0 * CHORD + 3.0 * CLIP_MM))
    assert left >= WIDE - 2.0 * np.sqrt(max(least, 0.0)) - 1e-9
    assert left <= WIDE - 2.0 * np.sqrt(max(most, 0.0)) + 1e-9 + 2.0 * (half if most <= 0.0 else 0.0)


def test_a_line_that_ends_within_the_chord_of_the_outline_is_left_as_it_is() -> None:
    given_ = [line((-0.09, 30.0), (100.04, 30.0)), line((0.0, 60.0), (100.0, 60.0)), line((0.0, -0.05), (100.0, 0.05))]
    made = on_part(given_, plate(), [hole(50.0, 30.0, 10.0)][:0])
    assert [a.path is b.path for a, b in zip(made, given_, strict=True)] == [True, True, True]


def test_a_line_beyond_the_outline_ends_on_it() -> None:
    made = on_part([line((-5.0, -5.0), (50.0, 50.0), (50.0, 90.0))], plate(), [])
    assert_near(made[0].path.vertices, [[0, 0], [50, 50], [50, 60]], bound=1e-12, why="straight sides")
    assert on_part([line((-5.0, 3.0), (-1.0, 3.0))], plate(), []) == ()


def test_arcs_stay_arcs_and_a_closed_path_goes_on_over_its_beginning() -> None:
    """A circle of radius 20 about the middle of the left side: its right half is left, in one piece."""
    ring = Mark("ring", ArcPath(np.array([[20.0, 30.0], [-20.0, 30.0]]), np.array([1.0, 1.0]), closed=True))
    (made,) = on_part([ring], plate(), [])
    assert_relative(length(made.path), 20.0 * pi, bound=1e-3, why="ends within the clip")
    assert_near(np.sort(made.path.vertices[[0, -1], 1]), [10.0, 50.0], bound=CLIP_MM, why="where it meets the side")
    assert np.abs(made.path.bulges).max() > 0.3
    (found,) = left_off([ring], [made])
    assert (found.code, found.fatal) == ("mark-clipped", False)
    assert "62.83 mm of 125.7 mm" in found.message
    assert left_off([ring], [ring]) == ()


def test_a_notch_cuts_a_line_off() -> None:
    notched = plate((0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (55.0, 60.0), (50.0, 50.0), (45.0, 60.0), (0.0, 60.0))
    (made,) = on_part([line((50.0, 0.0), (50.0, 60.0))], notched, [])
    assert_near(made.path.vertices, [[50, 0], [50, 50]], bound=1e-12, why="the tip of the notch")


# Whole parts

WINDOW: Table = {
    "kind": "curve", "name": "window",
    "curve": {"polyline": [[0.3, 0.42], [0.3, 0.58], [0.7, 0.58], [0.7, 0.42], [0.3, 0.42]]},
}  # fmt: skip
FRUSTUM: Table = RIGHT_FRUSTUM | {"radius0": 300, "radius1": 150, "height": 400, "sweep": 180}
SLANT = float(np.hypot(150.0, 400.0))


def test_ruling_marks_end_at_a_window() -> None:
    found = passage(FRUSTUM, hole=[WINDOW], mark=[{"kind": "rulings", "count": 3, "name": "roll"}])
    assert found.pattern is not None
    marks = found.pattern.marks
    assert [mark.name for mark in marks] == ["roll-1", "roll-2", "roll-2", "roll-3"]
    wanted = [SLANT, 0.3 * SLANT, 0.3 * SLANT, SLANT]
    assert_near([length(mark.path) for mark in marks], wanted, bound=2.0 * CLIP_MM, why="u runs along the slant")
    assert found.codes("unroll") == []


def test_bend_lines_keep_their_rulings_in_the_table_and_end_at_a_window_in_the_drawing() -> None:
    found = passage(FRUSTUM, hole=[WINDOW], bend=[{"max_angle": 60}])
    rows = found.reports["unroll"].detail["bends"]
    assert isinstance(rows, list)
    assert found.pattern is not None
    assert [len(row["pieces"]) for row in rows] == [1, 2, 1]
    for row in rows:
        assert_near(np.linalg.norm(np.subtract(row["to"], row["from"])), SLANT, bound=1e-9, why="the whole ruling")
        drawn = [mark.path.vertices.tolist() for mark in found.pattern.marks if mark.name == row["name"]]
        assert drawn == row["pieces"]
    assert_near(
        [np.linalg.norm(np.subtract(b, a)) for a, b in rows[1]["pieces"]],
        [0.3 * SLANT, 0.3 * SLANT],
        bound=2.0 * CLIP_MM,
        why="u of the window",
    )


def test_a_marked_curve_ends_at_a_hole_and_what_is_left_off_is_told() -> None:
    curve = {"kind": "curve", "name": "seam", "curve": {"polyline": [["0.5", "0.1"], ["0.5", "0.9"]]}}
    found = passage(FRUSTUM, hole=[WINDOW], mark=[curve])
    assert found.pattern is not None
    whole = 225.0 * pi * 0.8
    pieces = [length(mark.path) for mark in found.pattern.marks]
    assert_near(pieces, [whole * 0.4, whole * 0.4], bound=2.0 * CLIP_MM + 0.05, why="v of the window")
    assert found.codes("unroll") == ["mark-clipped"]


def test_a_cross_in_a_hole_is_told() -> None:
    found = passage(FRUSTUM, hole=[WINDOW], mark=[{"kind": "point", "at": ["0.5", "0.5"]}])
    assert found.pattern is not None
    assert found.pattern.marks == ()
    assert found.codes("unroll") == ["mark-clipped"]


@pytest.mark.parametrize("table", [MITRED_CYLINDER, FRUSTUM])
def test_without_holes_rulings_keep_their_exact_ends(table: Table) -> None:
    found = passage(table, mark=[{"kind": "rulings", "count": 5}], bend=[{"max_angle": 60}])
    assert found.pattern is not None
    rows = found.reports["unroll"].detail["bends"]
    assert isinstance(rows, list)
    assert all(row["pieces"] == [[row["from"], row["to"]]] for row in rows)
    assert len(found.pattern.marks) == 5 + len(rows)


def test_the_angle_of_a_ring_is_left_as_it_is_on_a_disc() -> None:
    """An arc that leaves a disc of radius 30 at a distance 40 from its middle: closed form by the law of cosines."""
    disc = contour((CircularArc(np.zeros(2), 30.0, 0.0, 2.0 * pi),), CHORD, "disc")
    ring = ArcPath(np.array([[20.0, 0.0], [60.0, 0.0]]), np.array([1.0, 1.0]), closed=True)
    (made,) = on_part([Mark("ring", ring)], disc, [])
    half = acos((20.0**2 + 40.0**2 - 30.0**2) / (2.0 * 20.0 * 40.0))
    assert_near(length(made.path), 2.0 * half * 20.0, bound=4.0 * CLIP_MM, why="both ends at an angle to the disc")
