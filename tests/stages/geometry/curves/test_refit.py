"""Outlines that are known by points only, against the curves that the points were taken from."""

from math import pi, radians

import numpy as np
import pytest

from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.curves.planecorners import corners
from stages.geometry.curves.planespline import Spline, spline
from stages.geometry.curves.refit import Refitted, refitted
from tests.near import assert_near

SEEDS = range(5)


def uneven(count: int, seed: int) -> np.ndarray:
    """Parameters in [0, 1) at distances that differ by up to 1 : 9."""
    steps = np.random.default_rng(seed).uniform(0.2, 1.8, count)
    return np.concatenate([[0.0], np.cumsum(steps)[:-1]]) / steps.sum()


def side(start: tuple[float, float], end: tuple[float, float], count: int, seed: int) -> np.ndarray:
    at = uneven(count, seed)
    return np.outer(1.0 - at, start) + np.outer(at, end)


def ring(count: int, seed: int, radius: float = 1.0) -> np.ndarray:
    angle = 2.0 * pi * uneven(count, seed)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def rectangle(width: float, height: float, seed: int) -> np.ndarray:
    at = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    return np.concatenate([side(at[i], at[(i + 1) % 4], n, seed + i) for i, n in enumerate((20, 9, 15, 4))])


def kinds(found: Refitted) -> list[type]:
    return [type(edge) for edge in found.edges]


def assert_closed(found: Refitted, size: float) -> None:
    ends = [edge.at(np.array([0.0, 1.0])) for edge in found.edges]
    for (_, end), (start, _) in zip(ends, ends[1:] + ends[:1], strict=True):
        assert_near(end, start, bound=1e-13 * size, why="edges run end to end")


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("size", [1.0, 10_000.0])
def test_a_rectangle_has_four_straight_edges(seed: int, size: float) -> None:
    found = refitted(rectangle(size, 0.4 * size, seed), accuracy=1e-9 * size)
    assert kinds(found) == [Segment] * 4
    assert found.at == (0, 20, 29, 44)
    assert (found.sagitta_mm, found.uncertainty_mm) == (0.0, 0.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_circle_is_one_circle_however_unevenly_it_is_divided(seed: int) -> None:
    found = refitted(ring(40, seed, 25.0) + np.array([3.0, 4.0]), accuracy=1e-9)
    (edge,) = found.edges
    assert isinstance(edge, CircularArc)
    assert_near(edge.radius, 25.0, bound=1e-12, why="least squares on points of a circle")
    assert_near(edge.centre, [3.0, 4.0], bound=1e-12, why="least squares on points of a circle")
    assert_near(abs(edge.sweep_rad), 2.0 * pi, bound=0.0, why="a full turn")


def test_a_finely_divided_arc_between_corners_is_one_arc() -> None:
    angle = np.linspace(0.0, 1.0, 200)
    points = np.concatenate([80.0 * np.column_stack([np.cos(angle), np.sin(angle)]), [[0.0, 0.0]]])
    assert kinds(refitted(points, accuracy=1e-9)) == [CircularArc, Segment, Segment]


def test_a_circle_with_noise_within_the_accuracy_is_a_circle() -> None:
    noise = np.random.default_rng(4).normal(scale=1e-4, size=(200, 2))
    assert kinds(refitted(ring(200, 2, 25.0) + noise, accuracy=5e-4)) == [CircularArc]


def test_a_clockwise_hole_stays_clockwise() -> None:
    found = refitted(ring(16, 3)[::-1], accuracy=1e-9)
    (edge,) = found.edges
    assert isinstance(edge, CircularArc)
    assert edge.sweep_rad < 0.0


def test_the_sagitta_is_how_far_a_circle_leaves_its_polygon() -> None:
    angle = 2.0 * pi * np.arange(24) / 24
    found = refitted(50.0 * np.column_stack([np.cos(angle), np.sin(angle)]), accuracy=1e-9)
    assert_near(found.sagitta_mm, 50.0 * (1.0 - np.cos(pi / 24)), bound=1e-12, why="closed form")


def test_a_polygon_of_few_sides_stays_a_polygon_and_one_of_many_does_not() -> None:
    for count, expected in ((3, 3), (4, 4), (8, 8), (9, 0), (16, 0)):
        angle = 2.0 * pi * np.arange(count) / count
        assert corners(np.column_stack([np.cos(angle), np.sin(angle)])).size == expected, count


@pytest.mark.parametrize("seed", SEEDS)
def test_an_ellipse_comes_back_with_the_fourth_power_of_the_spacing(seed: int) -> None:
    """The error between the points is at most what is told, and falls about sixteenfold when points double."""
    errors, told = [], []
    for count in (100, 200, 400):
        points = ring(count, seed) * (100.0, 60.0)
        found = refitted(points, accuracy=1e-9)
        (edge,) = found.edges
        assert isinstance(edge, Spline)
        dense = edge.at(np.linspace(0.0, 1.0, 5001))
        errors.append(float(np.abs(np.hypot(dense[:, 0] / 100.0, dense[:, 1] / 60.0) - 1.0).max()) * 60.0)
        told.append(found.uncertainty_mm)
    assert all(error <= said for error, said in zip(errors, told, strict=True)), (errors, told)
    assert errors[2] <= errors[0] / 60.0, errors


@pytest.mark.parametrize("seed", SEEDS)
def test_a_slot_is_two_straight_edges_and_two_arcs(seed: int) -> None:
    half = pi * uneven(21, seed) * 21 / 20
    half = half[half <= pi]
    right = 10.0 * np.column_stack([np.sin(half), -np.cos(half)]) + (50.0, 0.0)
    left = 10.0 * np.column_stack([-np.sin(half), np.cos(half)])
    points = np.concatenate(
        [side((0, -10), (50, -10), 7, seed), right, [(50.0, 10.0)], side((50, 10), (0, 10), 6, seed)[1:], left]
    )
    points = points[np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9]
    found = refitted(points, accuracy=1e-9)
    assert sorted(kind.__name__ for kind in kinds(found)) == ["CircularArc", "CircularArc", "Segment", "Segment"]
    assert_closed(found, 70.0)
    arcs = [edge for edge in found.edges if isinstance(edge, CircularArc)]
    for arc in arcs:
        assert_near(arc.radius, 10.0, bound=1e-9, why="least squares on points of a circle")


def test_curved_sides_between_corners_and_a_motion_of_them() -> None:
    x = np.concatenate([uneven(60, 2), [1.0]]) * 100.0
    below = np.column_stack([x, -20.0 + 8.0 * np.cos(x / 33.0)])
    above = np.column_stack([x, 30.0 + 5.0 * np.sin(x / 17.0)])
    points = np.concatenate([below, above[::-1]])
    found = refitted(points, accuracy=1e-9)
    assert kinds(found) == [Spline, Segment, Spline, Segment]
    dense = found.edges[0].at(np.linspace(0.0, 1.0, 2001))
    off = np.abs(dense[:, 1] + 20.0 - 8.0 * np.cos(dense[:, 0] / 33.0)).max()
    assert off <= found.uncertainty_mm
    turn, move = radians(33.0), np.array([1e3, -2e3])
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    moved = refitted(points @ matrix.T + move, accuracy=1e-9)
    assert moved.at == found.at
    assert_near(moved.edges[2].at(x / 100), found.edges[2].at(x / 100) @ matrix.T + move, bound=1e-9, why="rounding")


@pytest.mark.parametrize("degrees", [14.0, 30.0, 80.0, 170.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_corner_between_two_arcs_is_found_and_nothing_beside_it(seed: int, degrees: float) -> None:
    """A lens: two arcs of 20 deg each and a corner, in a closed outline of smooth size elsewhere."""
    first = radians(20.0) * np.concatenate([uneven(15, seed), [1.0]])
    one = 100.0 * np.column_stack([np.sin(first), np.cos(first) - 1.0])
    end, heading = one[-1], -radians(20.0) + radians(degrees)
    second = radians(20.0) * np.concatenate([uneven(15, seed + 7), [1.0]])
    two = end + 100.0 * np.column_stack(
        [np.sin(second - heading) + np.sin(heading), np.cos(second - heading) - np.cos(heading)]
    )
    chain = np.concatenate([one, two[1:]])
    points = np.concatenate([chain, [chain[-1] + (0.0, -500.0), chain[0] + (0.0, -500.0)]])
    assert [i for i in corners(points) if 0 < i < 30] == [15]


def test_noise_within_the_accuracy_does_not_break_straight_edges() -> None:
    rng = np.random.default_rng(5)
    points = rectangle(100.0, 40.0, 1) + rng.normal(scale=1e-5, size=(48, 2))
    assert kinds(refitted(points, accuracy=1e-4)) == [Segment] * 4
    assert Spline in kinds(refitted(points, accuracy=1e-9))


def test_a_spline_keeps_the_directions_asked_for() -> None:
    points = np.array([[0.0, 0.0], [3.0, 1.0], [5.0, 0.5], [9.0, 2.0]])
    directions = np.array([0.0, 1.0]), np.array([0.6, 0.8])
    edge = spline(points, directions)
    rates = edge.derivative(np.array([0.0, 1.0]))
    for rate, wanted in zip(rates, directions, strict=True):
        assert_near(rate / np.linalg.norm(rate), wanted, bound=1e-14, why="end condition")
    assert_near(edge.at(np.array([0.0, 1.0])), points[[0, -1]], bound=1e-14, why="interpolation")


def test_a_point_moved_off_the_circle_is_no_circle_any_more() -> None:
    points = ring(40, 1, 25.0)
    points[7] *= 1.0 + 1e-6
    assert kinds(refitted(points, accuracy=1e-9)) != [CircularArc]
    assert kinds(refitted(points, accuracy=1e-4)) == [CircularArc]
