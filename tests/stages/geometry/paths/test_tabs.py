"""Gaps of tabs: as many as asked for, even, on lines first, clear of corners and of what is to be avoided."""

from math import pi

import numpy as np
import pytest

from stages.geometry.paths.arcpath import ArcPath, length, lengths, split
from stages.geometry.paths.overlap import QUARTER_BULGE
from stages.geometry.paths.tabs import Wish, gaps, opened
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import CIRCLE, SQUARE
from tests.stages.write.patterns import strip

NOWHERE = np.zeros((0, 2))
OPEN = Wish(4, 0.5, 2.0, 0.1)


def test_on_a_square_there_is_one_on_each_side_and_none_near_a_corner() -> None:
    found = gaps(SQUARE, OPEN, NOWHERE)
    middles = np.sort(found.middles)
    assert (found.missing, found.uneven_mm) == (0, 0.0)
    assert_near(np.diff(middles), [10.0, 10.0, 10.0], bound=1e-12, why="a quarter of the length")
    assert np.all((middles % 10.0 >= 2.25) & (middles % 10.0 <= 7.75))


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_what_is_left_is_the_path_less_the_gaps(count: int) -> None:
    path = strip().outer.path
    found = gaps(path, Wish(count, 0.5, 2.0, 0.1), NOWHERE)
    rests = opened(path, found, 0.5)
    assert (len(rests), found.missing) == (count, 0)
    assert_near(sum(map(length, rests)), length(path) - 0.5 * count, bound=1e-9, why="gaps of 0.5 mm of a path of 2 m")


def test_lines_go_before_arcs() -> None:
    slot = ArcPath(np.array([[0.0, 0], [30, 0], [30, 20], [0, 20]]), np.array([0.0, 1.0, 0.0, 1.0]), closed=True)
    found = gaps(slot, Wish(2, 0.5, 2.0, 0.1), NOWHERE)
    ends = np.cumsum(lengths(slot))
    assert all(middle < ends[0] or ends[1] < middle < ends[2] for middle in found.middles)


def test_a_circle_has_them_on_its_arc() -> None:
    found = gaps(split(CIRCLE, max_bulge=QUARTER_BULGE), Wish(3, 0.5, 2.0, 0.1), NOWHERE)
    assert (found.missing, len(found.middles)) == (0, 3)
    assert_near(np.diff(np.sort(found.middles)), [10.0 * pi / 3.0] * 2, bound=0.7, why="0.35 off a joint, each")


def test_what_is_to_be_avoided_is() -> None:
    bend = np.array([[5.0, 0.0], [5.0, 10.0]])
    free, clear = (gaps(SQUARE, Wish(2, 0.5, 2.0, 0.1), avoid) for avoid in (NOWHERE, bend))
    assert clear.missing == 0
    for middle in clear.middles:
        on_bent_side = middle % 20.0 < 10.0
        assert not on_bent_side or abs(middle % 10.0 - 5.0) >= 2.25 - 1e-12
    assert len(free.middles) == 2


def test_where_there_is_no_room_they_are_missing() -> None:
    found = gaps(SQUARE, Wish(4, 8.0, 2.0, 0.1), NOWHERE)
    assert (found.missing, found.middles) == (4, ())
    assert opened(SQUARE, found, 8.0) == [SQUARE]


def test_two_never_share_a_place() -> None:
    """More than fit on the only stretch that is allowed."""
    long = ArcPath(np.array([[0.0, 0], [6, 0], [6, 1], [0, 1]]), np.zeros(4), closed=True)
    found = gaps(long, Wish(8, 0.5, 2.0, 0.1), NOWHERE)
    middles = np.sort(found.middles)
    assert found.missing + middles.size == 8
    assert np.diff(middles).min() >= 0.6 - 1e-12


def test_a_gap_keeps_from_its_neighbours_across_the_end_of_the_path() -> None:
    """On a square of 10 every place is free but corners: gaps of 1 mm lie 0.1 mm apart at least, once round."""
    found = gaps(SQUARE, Wish(30, 1.0, 0.0, 0.1), NOWHERE)
    middles = np.sort(found.middles)
    apart = np.diff(middles, append=middles[0] + float(lengths(SQUARE).sum()))
    assert middles.size > 20
    assert apart.min() >= 1.1 - 1e-12
