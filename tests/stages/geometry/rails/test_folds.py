"""The least single fold between rails: against a dense scan, and whatever way round the rails are given."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from stages.construct.rails import pieces
from stages.geometry.arrays import Array
from stages.geometry.curves.curves import Bezier, bezier, exactly
from stages.geometry.rails import folds
from stages.geometry.rails.folds import folded_way
from stages.geometry.rails.graph import ANGLE, FOLD, SMOOTH, Rules
from stages.geometry.rails.strip import LINES, backwards, open_strip
from stages.geometry.rails.zeros import Flags, field, lines
from stages.geometry.ruled.joins import join
from tests.near import assert_near

SLIDING = [0, 18]
"""Seeds of rails whose fold has its place by a cone that leaves an arc of F = 0 somewhere inside it."""
RIGID = [22]
"""Seeds of rails whose fold lies on the one cone that leads on."""


@cache
def random_rails(seed: int) -> tuple[Bezier, Bezier]:
    """Return two cubics over 6 of length, 2.5 apart."""
    rng = np.random.default_rng(seed)
    x, made = np.linspace(0.0, 6.0, 4), []
    for level in (0.0, 2.5):
        points = np.stack([x, *(y + rng.normal(0.0, 0.5, 4) for y in (0.0, level))], axis=1)
        made.append(bezier([exactly(point) for point in points]))
    return made[0], made[1]


def fold(a: tuple[Bezier, ...], b: tuple[Bezier, ...]) -> float:
    """Return the one fold of the best strip, rad."""
    strip = open_strip(a, b, Rules(float(np.pi)))
    assert strip is not None
    patches = [piece.patch for piece in pieces(strip)]
    angles = [join(p, q).normal_rad for p, q in pairwise(patches)]
    (angle,) = (angle for angle in angles if angle > SMOOTH)
    return angle


def scanned(a: Bezier, b: Bezier, count: int) -> tuple[float, float]:
    """Return the least warp at which a path over a lattice may fold, and the largest change from line to line, rad.

    A path may turn smoothly at both ends of every edge on which F changes its sign, normals looking one way.
    """
    found = field((a,), (b,), count)
    open_, sign = found.warp < np.pi / 2.0, found.F >= 0.0
    smooth = np.zeros(sign.shape, dtype=bool)
    for axis in (0, 1):
        low, high = (np.take(np.arange(count + 1), range(k, count + k), axis=0) for k in (0, 1))
        before, after = (np.take(sign, k, axis) for k in (low, high))
        both = (before != after) & np.take(open_, low, axis) & np.take(open_, high, axis)
        pad = [(0, 0), (0, 0)]
        for side in ((0, 1), (1, 0)):
            pad[axis] = side
            smooth |= np.pad(both, pad)
    before, after = reached(smooth), [flags[::-1, ::-1] for flags in reached(smooth[::-1, ::-1])]
    may = (before[0] & after[1]) | (before[1] & after[0])
    change = max(float(np.abs(np.diff(found.warp, axis=axis))[_near(may, axis)].max()) for axis in (0, 1))
    return float(found.warp[may].min()), change


def _near(may: Flags, axis: int) -> Flags:
    """Return the edges at the corners at which a path may fold."""
    low, high = ([slice(None), slice(None)] for _ in (0, 1))
    low[axis], high[axis] = slice(None, -1), slice(1, None)
    return np.asarray(may[tuple(low)] | may[tuple(high)])


def reached(smooth: Flags) -> tuple[Flags, Flags]:
    """Return the corners that a path without folds reaches while t rises, and while s rises, from the first."""
    on_a, on_b = np.zeros_like(smooth), np.zeros_like(smooth)
    for i in range(len(smooth)):
        for j in range(len(smooth)):
            first = i == j == 0
            on_a[i, j] = first or (i > 0 and on_a[i - 1, j])
            on_b[i, j] = first or (j > 0 and on_b[i, j - 1])
            if smooth[i, j]:
                on_a[i, j] = on_b[i, j] = on_a[i, j] or on_b[i, j]
    return on_a, on_b


@pytest.mark.parametrize("seed", [*SLIDING, *RIGID])
def test_the_fold_is_the_least_that_a_dense_scan_finds(seed: int) -> None:
    """Each of the two cones that meet in the fold may be off its place by one line."""
    a, b = random_rails(seed)
    least, change = scanned(a, b, 240)
    assert_near(fold((a,), (b,)), least, bound=2.0 * change, why="one line each way")


def test_the_fold_is_the_same_with_the_rails_exchanged_and_run_backwards() -> None:
    a, b = random_rails(SLIDING[0])
    angle = fold((a,), (b,))
    assert_near(fold((b,), (a,)), angle, bound=1e-7, why="the search ends at 1e-6 deg")
    assert_near(fold(backwards((a,)), backwards((b,))), angle, bound=1e-7, why="the search ends at 1e-6 deg")


def test_a_search_that_ends_before_its_folds_settle_says_by_how_much_they_changed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of one round the whole change: from the lattice that it began with to the one after."""
    a, b = random_rails(SLIDING[0])
    rules, angles = Rules(float(np.pi)), []
    for rounds in (0, 1):
        monkeypatch.setattr(folds, "ROUNDS", rounds)
        way, change = folded_way((a,), (b,), rules, LINES)
        angles.append(np.radians((way.cost - FOLD) / ANGLE))
    assert_near(change, abs(angles[1] - angles[0]), bound=1e-12, why="all but the fold stays; rounding of 1e6")
    assert change > 1e-6
    strip = open_strip((a,), (b,), rules)
    assert strip is not None and strip.unsettled_rad == change
    monkeypatch.undo()
    settled = open_strip((a,), (b,), rules)
    assert settled is not None and settled.unsettled_rad == 0.0


def test_a_way_without_folds_has_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = random_rails(2)
    monkeypatch.setattr(folds, "ROUNDS", 1)
    way, change = folded_way((a,), (b,), Rules(float(np.pi)), LINES)
    assert not any(stop.fold for stop in way.stops)
    assert change == 0.0


def test_extra_lines_lie_between_the_even_ones() -> None:
    a, _ = random_rails(0)
    extra: Array = np.array([0.3, 0.3 + 1e-13, 0.5, 1.0, 1.7])
    made = lines((a, a), 16, extra)
    assert made.value.size == 2 * 9 + 2, "0.3 once and 1.7; 0.5 and 1 are there already"
    assert_near(made.value[made.even], np.append(np.linspace(0, 1, 9), np.linspace(1, 2, 9)), bound=0.0, why="even")
