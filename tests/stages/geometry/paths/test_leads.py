"""Leads: where they come from, their lengths, on the waste side, and what is in their way."""

from math import pi

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, along, backwards, directions, length, transform
from stages.geometry.paths.clearance import pieces
from stages.geometry.paths.enclosed import inside
from stages.geometry.paths.leads import Obstacles, off, round_in, straight
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import CIRCLE, SQUARE

EXACT = 1e-12
ORIGIN = np.zeros(2)


@pytest.mark.parametrize("angle", [pi / 6.0, pi / 2.0])
def test_a_straight_one_arrives_from_the_right_at_its_angle(angle: float) -> None:
    way = straight(ORIGIN, 0.0, 3.0, angle)
    assert_near(length(way), 3.0, bound=EXACT, why="as asked for")
    assert_near(directions(way)[1], [angle], bound=EXACT, why="to the direction of the path")
    assert way.vertices[0, 1] < 0.0


def test_an_arc_touches_the_path_and_leaves_its_mirror_image() -> None:
    way = round_in(ORIGIN, 0.0, 2.0, pi / 2.0)
    away = off(way, ORIGIN, 0.0)
    assert_near(way.vertices, [[-2.0, -2.0], [0.0, 0.0]], bound=EXACT, why="a quarter circle")
    assert_near(away.vertices, [[0.0, 0.0], [2.0, -2.0]], bound=EXACT, why="a quarter circle")
    assert_near([directions(way)[1][0], directions(away)[0][0]], [0.0, 0.0], bound=EXACT, why="along the path")
    assert_near([length(way), length(away)], [pi, pi], bound=EXACT, why="a quarter of 4 pi")


def test_of_an_outline_it_is_outside_and_of_a_hole_inside() -> None:
    for contour, held in ((SQUARE, False), (backwards(SQUARE), True)):
        first, _ = directions(contour)
        middle = (contour.vertices[0] + contour.vertices[1]) / 2.0
        way = straight(middle, float(first[0]), 2.0, pi / 4.0)
        assert bool(inside(way.vertices[:1], pieces(contour))[0]) is held


def test_what_is_in_the_way_is_seen_by_its_distance() -> None:
    way = straight(np.array([5.0, 0.0]), 0.0, 3.0, pi / 2.0)
    below = transform(CIRCLE, Rigid2(5.0, -9.0))
    obstacles = Obstacles([SQUARE, below])
    own, within = np.array([0]), np.array([5.0])
    assert_near(obstacles.rooms([way], own, within), [1.0], bound=EXACT, why="9 less 5 less 3")
    assert obstacles.are_free([way, way], 0.99).tolist() == [True, True]
    assert obstacles.are_free([way], 1.01).tolist() == [False]
    assert Obstacles([SQUARE]).rooms([way], own, within).tolist() == [np.inf]
    assert Obstacles([]).rooms([], own[:0], within[:0]).tolist() == Obstacles([]).are_free([], 1.0).tolist() == []


def test_a_way_through_its_own_contour_is_seen() -> None:
    narrow = ArcPath(np.array([[0.0, 0], [10, 0], [10, 1], [0, 1]]), np.zeros(4), closed=True)
    for length_mm, free in ((0.5, True), (1.5, False)):
        way = straight(np.array([5.0, 1.0]), 0.0, length_mm, pi / 2.0)
        hole = backwards(narrow)
        assert Obstacles([hole]).leave([way], np.array([0])).tolist() == [free]
        assert Obstacles([hole]).are_free([way], 0.1).tolist() == [free]


def test_a_way_through_the_part_into_the_corner_of_a_hole_is_seen() -> None:
    """Round ones arrive along the side: in a hole's corner from beyond it, through the part; from amid it they fit."""
    hole = backwards(SQUARE)
    direction = float(directions(hole)[0][0])
    corner, ahead = hole.vertices[0], np.array([np.cos(direction), np.sin(direction)])
    for at, free in ((corner, False), (corner + 4.0 * ahead, True)):
        way = round_in(at, direction, 2.0, pi / 2.0)
        assert Obstacles([hole]).leave([way], np.array([0])).tolist() == [free]
        assert Obstacles([hole]).are_free([way], 0.1).tolist() == [free]


def test_ways_judged_together_are_judged_like_each_by_itself() -> None:
    rng = np.random.default_rng(7)
    obstacles = Obstacles([SQUARE, *(transform(CIRCLE, Rigid2(*at)) for at in rng.uniform(-30.0, 40.0, (30, 2)))])
    makers, at = (straight, round_in), rng.uniform(0.0, 10.0, 40)
    ways = [makers[k % 2](np.array([x, 0.0]), 0.0, 2.0 + x, 1.0) for k, x in enumerate(at)]
    ways += [polyline(way) for way in ways[1::2]]
    own, within = np.zeros(len(ways), dtype=np.int64), np.linspace(0.5, 8.0, len(ways))
    alone = [obstacles.rooms([way], own[:1], within[k : k + 1])[0] for k, way in enumerate(ways)]
    assert obstacles.rooms(ways, own, within).tolist() == alone
    free = [bool(obstacles.are_free([way], 0.5)[0]) for way in ways]
    assert obstacles.are_free(ways, 0.5).tolist() == free
    assert 0 < sum(free) < len(free)


def polyline(way: ArcPath) -> ArcPath:
    """Return the chords of an arc in four parts."""
    points = np.vstack([along(way, np.zeros(4, dtype=np.int64), np.arange(4) / 4.0), way.vertices[-1:]])
    return ArcPath(points, np.zeros(5), closed=False)
