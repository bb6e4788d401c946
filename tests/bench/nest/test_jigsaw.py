"""Jigsaws: the pieces fill the rectangle and do not overlap, whatever the seed."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, STRtree
from shapely.ops import unary_union

from tests.bench.nest.instances import instance
from tests.bench.nest.jigsaw import CELL_MM, SEEDS, SLACK, Piece, cut, grid, jigsaw, turned
from tests.bench.nest.layouts import net_area
from tests.near import assert_near

ROUNDING = 1e-6
"""Area lost to rounding, mm2: 8 corners of 20 pieces, each off by 1e-13 mm, along edges of 250 mm, leave 1e-8."""

seeds, counts = st.integers(0, 10**6), st.sampled_from([1, 2, 4, 6, 7, 12, 20])


def polygons(pieces: list[Piece]) -> list[Polygon]:
    return [Polygon(piece.corners) for piece in pieces]


def size(pieces: int) -> tuple[float, float]:
    columns, rows = grid(pieces)
    return columns * CELL_MM[0], rows * CELL_MM[1]


@settings(max_examples=40)
@given(seeds, counts)
def test_the_pieces_reassemble_to_the_rectangle_without_overlap(seed: int, count: int) -> None:
    shapes, (width, height) = polygons(cut(seed, count)), size(count)
    assert all(one.is_valid and one.exterior.is_ccw for one in shapes)
    first, second = STRtree(shapes).query(shapes, predicate="intersects")
    common = [shapes[i].intersection(shapes[j]).area for i, j in zip(first, second, strict=True) if i < j]
    assert_near(sum(common), 0.0, bound=ROUNDING, why="corners are shared")
    whole = unary_union(shapes)
    assert_near(whole.bounds, (0.0, 0.0, width, height), bound=0.0, why="sides are not moved")
    assert_near(whole.area, width * height, bound=ROUNDING, why="no gap is left")


@settings(max_examples=40)
@given(seeds, counts)
def test_the_areas_of_the_instance_are_that_of_the_rectangle(seed: int, count: int) -> None:
    made, (width, height) = instance("jigsaw", jigsaw(seed, count)), size(count)
    total = sum(map(net_area, made.patterns))
    assert made.parts == count
    assert_near(total, width * height, bound=ROUNDING, why="a turn and a move keep areas")
    assert_near(made.stock[0].height_mm, height * SLACK, bound=1e-4, why="rounded to 1e-4 mm")


@settings(max_examples=40)
@given(seeds)
def test_every_piece_handed_out_is_a_cut_one_turned_and_moved(seed: int) -> None:
    for piece, item in zip(cut(seed), jigsaw(seed).items, strict=True):
        handed = np.array(item.shape.data)
        assert_near(handed.min(axis=0), (0.0, 0.0), bound=0.0, why="its box begins at the origin")
        away = handed - np.array(turned(piece))
        assert_near(np.ptp(away, axis=0), (0.0, 0.0), bound=1e-9, why="multiples of 1e-4 less one another")


def test_a_seed_gives_one_jigsaw_and_two_seeds_give_two() -> None:
    made = [jigsaw(seed) for seed in SEEDS]
    assert made == [jigsaw(seed) for seed in SEEDS]
    assert len({str(one) for one in made}) == len(SEEDS) == 5


def test_pieces_interlock_and_are_handed_out_turned_and_shuffled() -> None:
    pieces = cut(1)
    hollow = [1.0 - one.area / one.convex_hull.area for one in polygons(pieces)]
    assert np.mean(hollow) > 0.05, "the stored jigsaw has 0.068"
    assert len({piece.quarters for piece in pieces}) == 4
    centres = [one.centroid.coords[0] for one in polygons(pieces)]
    assert centres != sorted(centres)


def test_two_pieces_exchanged_are_seen_as_overlap() -> None:
    a, b, *_ = polygons(sorted(cut(1), key=lambda piece: piece.corners))
    moved = Polygon(np.array(a.exterior.coords) + np.array(b.centroid.coords[0]) - np.array(a.centroid.coords[0]))
    assert moved.intersection(a).area + moved.symmetric_difference(b).area > 1e3
