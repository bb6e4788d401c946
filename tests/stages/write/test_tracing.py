"""Contours of a pattern file: which vertices are turn points, and how near chords and finer curves lie."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import norm
from stages.geometry.curves.plane import CircularArc
from stages.geometry.flat.sampling import resolved
from stages.geometry.paths.arcpath import ArcPath, area, length
from stages.geometry.paths.hausdorff import hausdorff
from stages.model.pattern import Contour
from stages.write.tracing import CORNER_RAD, FINER, as_pattern, chorded_line, drill_of, traced, turn_places
from tests.near import assert_near
from tests.stages.write.patterns import CHORD_MM, contour, drop, hole, plate, polygon_edges, sector, strip
from tests.stages.write.pieces import NOTCH_ON_ARC, flap


def turns(one: Contour) -> np.ndarray:
    assert one.traced is not None
    return one.path.vertices[np.array(one.traced.turns)]


@pytest.mark.parametrize(
    ("one", "count"),
    [(plate().outer, 4), (sector().outer, 4), (strip().outer, 4), (drop().outer, 0), (hole(0.0, 0.0, 5.0), 0)],
)
def test_turn_points_are_the_corners_of_the_exact_outline(one: Contour, count: int) -> None:
    found = turns(traced(one))
    corners = np.array([edge.at(np.array([0.0]))[0] for edge in one.edges])
    assert len(found) == count
    if count:
        assert max(norm(corners - corner).min() for corner in found) < 1e-9


def test_where_a_straight_edge_joins_an_arc_smoothly_is_a_turn_point() -> None:
    """The flap: two corners on the left, and both ends of the half circle."""
    found = as_pattern(flap().replace(notches=())).outer
    assert sorted(map(tuple, turns(found).round(6).tolist())) == [
        (0.0, -40.0),
        (0.0, 40.0),
        (80.0, -40.0),
        (80.0, 40.0),
    ]


@pytest.mark.parametrize("angle", [CORNER_RAD * 0.9, CORNER_RAD * 1.1])
def test_arcs_that_meet_in_a_corner_make_a_turn_point_and_smooth_ones_do_not(angle: float) -> None:
    """An arc and its image in the point where it ends, turned by an angle more or less than a corner's."""
    quarter = float(np.tan(pi / 8.0))
    start = np.array([-10.0, -10.0])
    second = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ -start
    path = ArcPath(np.array([start, [0.0, 0.0], second]), np.array([quarter, -quarter, 0.0]), closed=False)
    places = turn_places(path).tolist()
    assert ([0.0, 0.0] in places) == (angle > CORNER_RAD)
    assert [start.tolist(), second.tolist()] == [places[0], places[-1]]


@pytest.mark.parametrize("one", [sector().outer, strip().outer, drop().outer, hole(3.0, 4.0, 5.0)])
def test_chords_keep_the_tolerance_both_ways_and_the_finer_curve_a_quarter_of_it(one: Contour) -> None:
    found = traced(one)
    assert found.traced is not None
    edges = [resolved(edge, accuracy=1e-3 * CHORD_MM) for edge in one.edges]
    assert hausdorff(edges, found.path, accuracy=CHORD_MM).bound_mm <= CHORD_MM
    assert hausdorff(edges, found.traced.finer, accuracy=FINER * CHORD_MM).bound_mm <= FINER * CHORD_MM
    assert not found.path.bulges.any()
    # the number of chords grows with the root of the accuracy; evenly laid ones are twice as many at most
    assert found.traced.finer.bulges.size <= 2 * 2 * found.path.bulges.size


def test_a_straight_outline_stays_as_it_is() -> None:
    found = traced(plate().outer)
    assert found.path is plate().outer.path or (found.path.vertices == plate().outer.path.vertices).all()
    assert found.traced is not None
    assert found.traced.finer is found.path


@settings(max_examples=25, deadline=None)
@given(st.floats(0.5, 50.0), st.floats(5.0, 170.0), st.booleans())
def test_the_chords_of_a_mark_begin_and_end_where_it_does(radius: float, sweep: float, closed: bool) -> None:
    arc = CircularArc(np.zeros(2), radius, 0.0, radians(sweep))
    ends = arc.at(np.array([0.0, 1.0]))
    bulge = float(np.tan(arc.sweep_rad / 4.0))
    path = ArcPath(ends, np.array([bulge, bulge if closed else 0.0]), closed)
    line, said = chorded_line(path, CHORD_MM)
    assert len(said.turns) == line.bulges.size
    assert (line.vertices[0] == ends[0]).all()
    assert abs(length(line) - length(path)) <= 0.1 * length(path)
    if not closed:
        assert said.turns[0]
        assert said.turns[-1]
        assert not any(said.turns[1:-1])


def test_a_notch_is_a_vertex_on_the_exact_outline() -> None:
    made = as_pattern(flap())
    for notch in flap().notches:
        assert_near(norm(made.outer.path.vertices - notch.at).min(), 0.0, bound=1e-12, why="the place itself")
    on_arc = int(norm(made.outer.path.vertices - NOTCH_ON_ARC).argmin())
    assert made.outer.traced is not None
    assert not made.outer.traced.turns[on_arc]
    assert len(made.outer.traced.turns) == made.outer.path.bulges.size
    bare = as_pattern(flap().replace(notches=()))
    assert made.outer.path.bulges.size == bare.outer.path.bulges.size + 3
    assert area(made.outer.path) >= area(bare.outer.path)


def test_the_outline_is_the_one_before_notches_were_cut_into_it() -> None:
    cut = contour(polygon_edges((0.0, 0.0), (40.0, 0.0), (50.0, 5.0), (60.0, 0.0), (100.0, 0.0), (100.0, 60.0)))
    part = plate().replace(outer=cut, boundary=plate().outer)
    assert (as_pattern(part).outer.path.vertices == plate().outer.path.vertices).all()
    assert as_pattern(part).boundary is None


def test_round_stitch_and_drill_holes_are_points_and_no_contours() -> None:
    made = as_pattern(flap())
    assert [(drill.diameter_mm, drill.at.tolist()) for drill in made.drills] == [(1.0, [10.0, 30.0])]
    assert len(made.inner) == 1
    assert drill_of(hole(0.0, 0.0, 5.0)) is None
    slot = contour(polygon_edges((0.0, 0.0), (0.0, 5.0), (9.0, 5.0)))
    assert drill_of(Contour(slot.edges, slot.path, CHORD_MM, purpose="drill")) is None


def test_lines_that_only_show_a_notch_are_left_to_its_point() -> None:
    assert [mark.name for mark in as_pattern(flap()).marks] == ["ruling", "sew", "slit"]


def test_a_pattern_that_is_one_already_stays_as_it_is() -> None:
    once = as_pattern(flap())
    assert as_pattern(once) is once
