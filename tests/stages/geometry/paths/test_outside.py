"""Paths that enclose all that exact edges enclose."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon, contains, dwithin, points, prepare

from stages.errors import NoSolutionError
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.flat.sampling import resolved
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.biarc import traced
from stages.geometry.paths.inscribed import chorded
from stages.geometry.paths.outside import Trace, beyond, outside
from tests.near import assert_near
from tests.stages.geometry.plane_curves import CONE, ELLIPSE, SINE, TAU, Formula, stroked, wave

ACCURACY = 0.02
TRACES = [traced, chorded]


def segment(a: object, b: object) -> Segment:
    return Segment(np.array(a, dtype=np.float64), np.array(b, dtype=np.float64))


def closed_below(curve: Formula, depth: float = 100.0) -> list[PlaneCurve]:
    """Return a contour, counter-clockwise, with a graph from left to right as its upper edge, reversed."""
    (x0, y0), (x1, y1) = curve.at(np.array([0.0, 1.0]))
    back = Formula(lambda t: curve.place(1.0 - t), lambda t: -curve.slope(1.0 - t))
    low = min(y0, y1) - depth
    return [segment((x0, low), (x1, low)), segment((x1, low), (x1, y1)), back, segment((x0, y0), (x0, low))]


def cone() -> list[PlaneCurve]:
    """Return the development of the cone with its apex."""
    ends = CONE.at(np.array([0.0, 1.0]))
    return [CONE, segment(ends[1], (0.0, 0.0)), segment((0.0, 0.0), ends[0])]


def lost(edges: list[PlaneCurve], path: ArcPath, sense: float = 1.0) -> float:
    """Return how much of what the edges enclose the path does not (of a hole: the other way round), mm2, by polygons.

    The path's polygon is on its inner side by less than 1e-4 mm: that much of its length is taken off.
    """
    region, exact = Polygon(corners(path)), Polygon(dense(edges))
    off = exact.difference(region) if sense > 0.0 else region.difference(exact)
    return max(off.area - 1e-4 * region.length, 0.0)


def corners(path: ArcPath) -> np.ndarray:
    """Return the corners of a polygon along a path, less than 1e-4 mm off arcs that turn by 0.3 rad about 100 mm."""
    return stroked(path, 120) if path.bulges.any() else path.vertices


def dense(edges: list[PlaneCurve]) -> np.ndarray:
    return np.concatenate([edge.at(np.linspace(0.0, 1.0, 2001))[:-1] for edge in edges])


def within(edges: list[PlaneCurve], path: ArcPath, accuracy: float) -> bool:
    """Return whether path and edges are within the accuracy of each other, by polygons 1e-4 mm off them alone."""
    one, other = dense(edges), corners(path)
    lines = LineString(np.vstack([one, one[:1]])), LineString(np.vstack([other, other[:1]]))
    for line in lines:
        prepare(line)
    near = dwithin(points(other), lines[0], accuracy).all() and dwithin(points(one), lines[1], accuracy).all()
    return bool(near)


@pytest.mark.parametrize("trace", TRACES)
@pytest.mark.parametrize("edges", [closed_below(SINE), cone()])
def test_every_point_of_a_curved_edge_is_strictly_within(edges: list[PlaneCurve], trace: Trace) -> None:
    path = outside(edges, trace, accuracy=ACCURACY)
    curve = next(edge for edge in edges if not isinstance(edge, Segment))
    region = Polygon(corners(path))
    prepare(region)
    # less than 1/50 of its length from a corner a curve is as near to the path as to the corner
    places = points(curve.at(np.linspace(0.02, 0.98, 501)))
    assert contains(region, places).all()
    assert not dwithin(places, region.exterior, 1e-5).any()
    assert within(edges, path, ACCURACY)


@pytest.mark.parametrize("trace", TRACES)
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_outline_only_grows_and_a_hole_only_shrinks(trace: Trace, sense: float) -> None:
    curve = Formula(lambda t: ELLIPSE.place(sense * t), lambda t: sense * ELLIPSE.slope(sense * t))
    path = outside([curve], trace, accuracy=ACCURACY)
    size = sense * arcpath.area(path) - 5000.0 * pi
    assert 0.0 < sense * size <= ACCURACY * arcpath.length(path)
    assert lost([curve], path, sense) == 0.0
    assert within([curve], path, ACCURACY)


def test_lines_and_arcs_stay_as_they_are_exactly() -> None:
    arc = CircularArc(np.array([10.0, 5.0]), 5.0, -pi / 2.0, pi)
    edges = [segment((0, 0), (10, 0)), arc, segment((10, 10), (0, 10)), segment((0, 10), (0, 0))]
    path = outside(edges, traced, accuracy=ACCURACY)
    assert_near(path.vertices, [[0, 0], [10, 0], [10, 10], [0, 10]], bound=1e-13, why="nothing moves")
    assert_near(path.bulges, [0.0, 1.0, 0.0, 0.0], bound=1e-13, why="nothing moves")


def test_straight_edges_beside_a_curve_stay_on_their_lines() -> None:
    path = outside(closed_below(SINE), traced, accuracy=ACCURACY)
    xs, ys = path.vertices.T
    width = 100.0 * TAU
    assert np.count_nonzero(np.abs(ys + 100.0) < 1e-12) == 2
    assert np.count_nonzero(np.abs(xs) < 1e-12) == 2
    assert np.count_nonzero(np.abs(xs - width) < 1e-12) == 2


@pytest.mark.parametrize("angle_deg", [60.0, 20.0, 5.0])
def test_a_sharp_corner_is_kept_within_the_accuracy(angle_deg: float) -> None:
    path = outside(tip(angle_deg), traced, accuracy=ACCURACY)
    assert within(tip(angle_deg), path, ACCURACY)
    assert beyond([resolved(edge, accuracy=1e-4) for edge in tip(angle_deg)], path, accuracy=ACCURACY) <= 1e-12


def tip(angle_deg: float) -> list[PlaneCurve]:
    """Return a gore: two parabolas that meet at both ends at an angle."""
    rise = 100.0 * np.tan(radians(angle_deg / 2.0))
    upper = Formula(
        lambda t: 100.0 * (1.0 - 2.0 * t) + 2j * rise * t * (1.0 - t), lambda t: -200.0 + 2j * rise * (1.0 - 2.0 * t)
    )
    lower = Formula(
        lambda t: 100.0 * (2.0 * t - 1.0) - 2j * rise * t * (1.0 - t), lambda t: 200.0 - 2j * rise * (1.0 - 2.0 * t)
    )
    return [lower, upper]


def test_a_needle_is_an_error_with_both_numbers() -> None:
    with pytest.raises(NoSolutionError, match="sharp corner"):
        outside(needle(), traced, accuracy=ACCURACY)


def needle() -> list[PlaneCurve]:
    """Return two flat sines that meet at 0.2 degrees: no arc follows them exactly."""

    def side(sense: float) -> Formula:
        return Formula(
            lambda t: sense * (200.0 * t - 0.11j * np.sin(pi * t)),
            lambda t: sense * (200.0 - 0.11j * pi * np.cos(pi * t)),
        )

    back = side(-1.0)
    return [side(1.0), Formula(lambda t: 200.0 + back.place(t), back.slope)]


@settings(max_examples=12, deadline=None)
@given(
    st.lists(st.floats(-8.0, 8.0), min_size=3, max_size=3),
    st.lists(st.floats(0.0, 6.0), min_size=3, max_size=3),
    st.sampled_from(TRACES),
    st.sampled_from([0.1, 0.02]),
)
def test_no_wavy_part_is_ever_smaller(
    amplitudes: list[float], phases: list[float], trace: Trace, accuracy: float
) -> None:
    edges = closed_below(wave(amplitudes, phases), depth=60.0)
    path = outside(edges, trace, accuracy=accuracy)
    assert lost(edges, path) == 0.0
    assert within(edges, path, accuracy)
    assert beyond([resolved(edge, accuracy=1e-4) for edge in edges], path, accuracy=accuracy) <= 1e-11


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_what_is_cut_away_is_measured(sense: float) -> None:
    """A circle of radius 50 beside the exact one of radius 50.01, and of a hole the other way round."""
    exact = CircularArc(np.zeros(2), 50.0 + sense * 0.01, 0.0, sense * TAU)
    path = ArcPath(np.array([[50.0, 0.0], [-50.0, 0.0]]), np.full(2, sense), closed=True)
    found = beyond([resolved(exact, accuracy=1e-5)], path, accuracy=ACCURACY)
    assert_near(found, 0.01, bound=1e-12, why="closed form")
