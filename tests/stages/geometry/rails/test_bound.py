"""The fold that no strip avoids: against a closed form, a scan of all paths over a lattice, strips that there are."""

from functools import cache
from itertools import pairwise
from math import acos, sqrt

import numpy as np
import pytest

from stages.construct.rails import pieces
from stages.geometry.arrays import Array
from stages.geometry.curves.curves import bezier, exactly
from stages.geometry.rails.graph import Rules
from stages.geometry.rails.strip import Rail, backwards, bounds, closed_bounds, closed_strip, open_strip, turned
from stages.geometry.rails.zeros import Field, Lines, angles, field
from stages.geometry.ruled.joins import join
from tests.near import assert_near

LINES = 48
"""Lattice lines of each rail, and twice as many."""


def chained(points: Array) -> Rail:
    return tuple(bezier([exactly(start), exactly(end)]) for start, end in pairwise(points))


def polygon(corners: int, radius: float, height: float, *, turn: float = 0.0, tilt: float = 0.0) -> Rail:
    """Return a regular polygon about the z axis, its first corner at an angle, then tilted about the x axis, deg."""
    angle = 2.0 * np.pi * np.arange(corners + 1) / corners + np.radians(turn)
    flat = radius * np.stack([np.cos(angle), np.sin(angle), np.zeros(angle.size)], axis=1)
    cosine, sine = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    points = flat @ np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]]) + [0.0, 0.0, height]
    points[-1] = points[0]
    return chained(points)


LOW = polygon(4, 2.0 * sqrt(2.0), 0.0, turn=-45.0)
PAIRS: dict[str, tuple[Rail, Rail]] = {
    "square": (LOW, polygon(4, sqrt(2.0), 3.0, turn=-45.0)),
    "turned": (LOW, polygon(4, sqrt(2.0), 3.0, turn=-25.0)),
    "tilted": (LOW, polygon(4, sqrt(2.0), 3.0, turn=-45.0, tilt=15.0)),
    "turned and tilted": (LOW, polygon(4, sqrt(2.0), 3.0, turn=-25.0, tilt=15.0)),
    "pentagon": (LOW, polygon(5, sqrt(2.0), 3.0, turn=10.0, tilt=-20.0)),
}


@cache
def both(name: str) -> tuple[float, float]:
    coarse, fine = closed_bounds(*PAIRS[name], LINES)
    return coarse.fold_rad, fine.fold_rad


def test_squares_fold_where_a_corner_is_passed_from_the_middle_of_a_side() -> None:
    """Normals (3, 0, 2) and (0, 3, 1) at the ruling from (2, 2, 0) to (0, 1, 3): less than the stump's 84.3 deg."""
    least = acos(2.0 / sqrt(130.0))
    coarse, fine = both("square")
    assert 0.0 < least - fine <= (least - coarse) / 3.0, "the least of the cell around the middle: quadratic"
    place = closed_bounds(*PAIRS["square"], LINES)[1]
    assert place.t == round(place.t), "at a corner of a"
    assert_near(place.s % 1.0, 0.5, bound=1.0 / (2 * LINES / 4), why="in the middle of a side of b, to a line")


@pytest.mark.parametrize("name", PAIRS)
def test_a_scan_of_all_paths_comes_down_to_the_bound_and_never_below(name: str) -> None:
    """What lies between them is of the first order in the width of a line at most: half of it at twice the lattice."""
    a, b = PAIRS[name]
    below = both(name)
    above = [min(scan(field(a, rail, lines)) for rail in (b, backwards(b))) for lines in (LINES, 2 * LINES)]
    assert 0.0 < below[0] <= below[1] <= above[1] <= above[0]
    assert above[1] - below[1] <= (above[0] - below[0]) / 2.0


def scan(found: Field) -> float:
    """Return the least, over all paths round the corners of a lattice, of the largest fold passed.

    States: a cone along a, one along b.  A break has no width: it is stepped over at no cost by a path that runs along
    the other rail.  Paths begin on the first line of a at every line of b, all at once, in either state.
    """
    turn_a, free_a = _around(found.turn_a, found.a, found.b)
    turn_b, free_b = (made.T for made in _around(found.turn_b.T, found.b, found.a))
    count = turn_b.shape[1]
    best = np.inf
    for state in (0, 1):
        before = np.full((2, count, count + 1), np.inf)
        for i in range(turn_a.shape[0] + 1):
            row = np.full((2, count, count + 1), np.inf)
            for k in range(count + 1):
                j = (np.arange(count) + k) % count
                if i == k == 0:
                    row[state, :, 0] = 0.0
                if i:
                    row[0, :, k] = np.maximum(before[0, :, k], turn_a[i - 1, j])
                    row[1, :, k] = np.maximum(before[1, :, k], free_a[i - 1, j])
                if k:
                    line = i % turn_a.shape[0]
                    row[1, :, k] = np.fmin(row[1, :, k], np.maximum(row[1, :, k - 1], turn_b[line, j - 1]))
                    row[0, :, k] = np.fmin(row[0, :, k], np.maximum(row[0, :, k - 1], free_b[line, j - 1]))
                warp = found.warp[i % turn_a.shape[0], j]
                row[:, :, k] = np.minimum(row[:, :, k], np.maximum(row[::-1, :, k], warp))
            before = row
        best = min(best, float(before[state, :, -1].min()))
    return best


def _around(turns: Array, of: Lines, other: Lines) -> tuple[Array, Array]:
    """Return the folds over the breaks of a closed rail (0 inside pieces), and what stepping over them at rest costs.

    Only over a break is a path at rest on a rail carried to the next line of it: elsewhere it would have to move.
    """
    p = other.point - of.point[0]
    closing = angles(np.cross(p, of.slope[-1]), np.cross(p, of.slope[0]))
    inside = np.append(of.inside, False)[:, None]
    made = np.where(inside, 0.0, np.vstack([turns, closing]))
    return made, np.where(np.broadcast_to(inside, made.shape), np.inf, 0.0)


def largest_fold(a: Rail, b: Rail, *, closed: bool) -> float:
    """Return the largest fold of the best strip, that of its seam among them."""
    strip = (closed_strip if closed else open_strip)(a, b, Rules(float(np.pi)))
    assert strip is not None
    patches = [piece.patch for piece in pieces(strip)]
    following = [*patches[1:], *patches[:closed]]
    return max(join(p, q).normal_rad for p, q in zip(patches, following, strict=False))


@pytest.mark.parametrize("name", PAIRS)
def test_the_bound_is_no_more_than_the_best_strip_folds_and_does_not_fall(name: str) -> None:
    coarse, fine = both(name)
    assert 0.0 < coarse <= fine <= largest_fold(*PAIRS[name], closed=True)


def random_closed(seed: int) -> tuple[Rail, Rail]:
    """Return two closed polygons of 3 to 6 corners, none in a plane."""
    rng = np.random.default_rng(seed)
    made = []
    for radius, height in ((2.0, 0.0), (1.2, 3.0)):
        count = int(rng.integers(3, 7))
        angle = (np.arange(count) + rng.uniform(-0.25, 0.25, count)) * 2.0 * np.pi / count
        flat = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height)], axis=1)
        points = flat + rng.normal(0.0, 0.15, (count, 3))
        made.append(chained(np.vstack([points, points[:1]])))
    return made[0], made[1]


@pytest.mark.parametrize("seed", range(3))
def test_random_polygons_fold_by_the_bound_at_least(seed: int) -> None:
    a, b = random_closed(seed)
    coarse, fine = (bound.fold_rad for bound in closed_bounds(a, b, LINES))
    assert 0.0 < coarse <= fine <= largest_fold(a, b, closed=True)


def test_the_bound_is_the_same_wherever_the_rails_begin_and_whichever_runs_backwards() -> None:
    a, b = PAIRS["turned and tilted"]
    _, least = both("turned and tilted")
    for rails in ((turned(a, 1.0), turned(b, 2.0)), (a, backwards(b)), (backwards(a), b)):
        assert_near(closed_bounds(*rails, LINES)[1].fold_rad, least, bound=1e-12, why="the same cells")


ANGLE = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]])


@pytest.mark.parametrize("rise", [[1.0, -1.0, 3.0], [0.5, -1.0, 0.4], [3.0, -2.0, 5.0]])
def test_open_rails_with_kinks_have_a_bound_too(rise: list[float]) -> None:
    """A bent line and the same moved along: two parallelograms with one fold are a strip."""
    a, b = chained(ANGLE), chained(ANGLE + rise)
    fold = float(angles(np.cross(rise, ANGLE[1] - ANGLE[0]), np.cross(rise, ANGLE[2] - ANGLE[1])))
    coarse, fine = (bound.fold_rad for bound in bounds(a, b))
    assert 0.0 < coarse <= fine <= fold
    assert fine <= largest_fold(a, b, closed=False) + 1e-12
