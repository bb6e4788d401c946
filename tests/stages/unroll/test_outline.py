"""The outline of any flat map: its edges follow each other, straight rulings are segments, curved ones are not."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from stages.geometry.arrays import norm
from stages.geometry.curves import contours
from stages.geometry.curves.plane import Segment
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import DevelopedEdge, DevelopedRuling, Development
from stages.geometry.flat.relaxed import relaxed
from stages.geometry.paths import arcpath
from stages.unroll import outline
from tests.near import assert_near, assert_relative
from tests.parts import CONE_STRIP, QUINTIC_TANGENT, patches
from tests.warped import CONE_AND_WARPED, POINTED, backwards, saddle

MAPS: dict[str, Callable[[], Development]] = {
    "along rulings": lambda: develop(patches(QUINTIC_TANGENT)),
    "a strip along rulings": lambda: develop(patches(CONE_STRIP)),
    "least strain": lambda: relaxed(saddle(20.0), accuracy=1e-5).development,
    "least strain of a strip": lambda: relaxed(CONE_AND_WARPED, accuracy=1e-5).development,
    "least strain, first ruling a point": lambda: relaxed(backwards(POINTED), accuracy=1e-5).development,
}


@cache
def flattened(name: str) -> Development:
    return MAPS[name]()


@pytest.mark.parametrize("name", MAPS)
def test_edges_run_end_to_end_around_the_pattern(name: str) -> None:
    made = flattened(name)
    edges = outline.edges(made)
    assert len(edges) == 2 + 2 * len(made.pieces)
    ends = [edge.at(np.array([0.0, 1.0])) for edge in edges]
    for (_, end), (start, _) in zip(ends, ends[1:] + ends[:1], strict=True):
        assert_near(end, start, bound=1e-12, why="positions of one place, up to 1 m")
    corners = outline.corners(made)
    count = len(made.pieces)
    found = [ends[0][0], ends[0][1], ends[1 + count][0], ends[1 + count][1]]
    assert_near(np.array(found), corners, bound=1e-12, why="the same corners, joins to rounding")
    assert contours.area(edges) > 0.0


@pytest.mark.parametrize("name", MAPS)
def test_directions_of_edges_are_the_differences_of_their_points(name: str) -> None:
    t, step = np.array([0.1, 0.45, 0.9]), 1e-5
    reach = float(norm(outline.corners(flattened(name))).max())
    for edge in outline.edges(flattened(name)):
        quotient = (edge.at(t + step) - edge.at(t - step)) / (2.0 * step)
        found = edge.derivative(t)
        size = float(norm(found).max())
        bound = 100.0 * step**2 * size + 1e-15 * reach / step
        assert_near(found, quotient, bound=bound, why="a central difference")


def test_straight_rulings_are_segments_and_curved_ones_are_not() -> None:
    along, least = (outline.edges(flattened(name)) for name in ("along rulings", "least strain"))
    assert [type(edge) for edge in along] == [Segment, DevelopedEdge, Segment, DevelopedEdge]
    assert [type(edge) for edge in least] == [DevelopedRuling, DevelopedEdge, DevelopedRuling, DevelopedEdge]
    start = least[0].at(np.linspace(0.0, 1.0, 5))
    assert_near(start[[0, -1], 1], np.zeros(2), bound=1e-14, why="its ends are on the x axis")
    assert np.abs(start[1:-1, 1]).min() > 1e-4


def test_a_ruling_of_no_length_is_a_segment_of_no_length() -> None:
    first = outline.edges(flattened("least strain, first ruling a point"))[0]
    assert isinstance(first, Segment)
    assert_near(first.at(np.array([0.0, 1.0])), np.zeros((2, 2)), bound=1e-14, why="the origin")


def test_a_saddle_is_symmetric_about_its_middle() -> None:
    edges = outline.edges(flattened("least strain"))
    points = [edge.at(np.linspace(0.0, 1.0, 9)) for edge in edges]
    middle = sum(points[i].mean(axis=0) for i in range(4)) / 4.0
    turned = 2.0 * middle - points[2]
    assert_near(points[0], turned, bound=1e-7, why="half a turn about its axis: the same problem, steps to 1e-8")


@pytest.mark.parametrize("name", MAPS)
def test_lines_and_arcs_keep_the_chord_along_curved_rulings(name: str) -> None:
    chord = 1e-3 * float(norm(np.ptp(outline.corners(flattened(name)), axis=0)))
    edges = outline.edges(flattened(name))
    made = outline.contour(edges, chord)
    exact = contours.area(edges)
    assert_relative(
        arcpath.area(made.path), exact, bound=4 * chord * contours.length(edges) / exact, why="within chord"
    )
