"""Pieces that were cut from one another are put together again; others are left alone."""

from collections.abc import Sequence
from time import monotonic

import pytest
from shapely import Polygon, affinity, box

from stages.nest.separation.interlock import assembled, interlocked, interlocking
from stages.nest.separation.problem import RECTANGLE, Item, Kind, Problem, Spot
from stages.nest.separation.sharing import Shared, Wish, bench_for, same_again, spots_of
from tests.bench.nest.jigsaw import cut, turned

QUARTERS = tuple((angle, angle) for angle in (0.0, 90.0, 180.0, 270.0))
LONG_S = 600.0
"""It ends by itself; kernels may have to be compiled first."""

PIECES, WIDE, HIGH = 6, 600.0, 300.0


def centred(shape: Polygon) -> Polygon:
    low_x, low_y, high_x, high_y = shape.bounds
    return affinity.translate(shape, -(low_x + high_x) / 2.0, -(low_y + high_y) / 2.0)


def strip(shapes: Sequence[Polygon], width: float, height: float) -> Problem:
    kinds = tuple(Kind(centred(shape), (QUARTERS,), (RECTANGLE,)) for shape in shapes)
    return Problem(kinds, tuple(Item(k, k) for k in range(len(kinds))), ((width, height),))


def jigsaw(seed: int, digits: int) -> Problem:
    """Six pieces of 600 x 300 mm, their corners rounded, in a strip three times as long and a little higher."""
    pieces = [[(round(x, digits), round(y, digits)) for x, y in turned(piece)] for piece in cut(seed, PIECES)]
    return strip([Polygon(piece) for piece in pieces], 3.0 * WIDE, HIGH * 1.0001)


def laid(problem: Problem, spots: Sequence[Spot]) -> list[Polygon]:
    return [
        affinity.translate(affinity.rotate(problem.kinds[one.kind].shape, one.angle_deg, origin=(0, 0)), one.x, one.y)
        for one in spots
    ]


def overlap(shapes: Sequence[Polygon]) -> float:
    return max(a.intersection(b).area for i, a in enumerate(shapes) for b in shapes[:i])


@pytest.mark.parametrize("seed", range(4))
def test_a_jigsaw_is_put_together_again(seed: int) -> None:
    problem = jigsaw(seed, digits=4)
    spots = assembled(problem, seed, lambda: False)
    assert spots is not None
    shapes = laid(problem, spots)
    assert max(shape.bounds[2] for shape in shapes) == pytest.approx(WIDE, abs=0.01)
    assert overlap(shapes) < 1e-3 * WIDE, "the rounding of corners along an edge"


def test_rounded_corners_are_moved_apart_until_nothing_overlaps() -> None:
    problem = jigsaw(1, digits=3)
    bench = bench_for(problem, 0, 0)
    wish = Wish(0.0, True, 1, 0, (1.0,), (3.0 * WIDE * HIGH,), (True,))
    told: list[list[Spot]] = []
    shared = Shared(same_again(bench.layout), (0,), wish, lambda found: told.append(spots_of(found)))
    interlocked(bench, problem, shared, wish, monotonic() + LONG_S)
    shapes = laid(problem, told[-1])
    assert overlap(shapes) < 1e-9, "but for rounding"
    assert max(shape.bounds[2] for shape in shapes) < 1.002 * WIDE


def test_there_is_no_time_without_time() -> None:
    assert assembled(jigsaw(0, digits=4), 0, lambda: True) is None


def test_only_pieces_whose_edges_match_count_as_a_jigsaw() -> None:
    problem = jigsaw(2, digits=4)
    assert interlocking(problem)
    assert not interlocking(strip([box(0, 0, 10 + k, 31 + k * k) for k in range(5)], 500.0, 100.0))
    assert not interlocking(Problem(problem.kinds, problem.items, problem.bins * 2)), "for one bin only"
