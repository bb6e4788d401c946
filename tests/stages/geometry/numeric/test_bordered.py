"""Banded equations with a border, and the numbering that makes them."""

import numpy as np
import pytest

from stages.geometry.numeric.bordered import assembled, gathered, solved, spread
from stages.geometry.numeric.elements import Degrees
from stages.geometry.numeric.numbering import HELD, Numbering, Shape, number, one_point
from tests.near import assert_near

DEGREES = Degrees(2, 3)
NODES = 12


def flat(columns: int) -> np.ndarray:
    """Nodes on a plain grid: v upwards, u to the right."""
    u, v = np.meshgrid(np.arange(3.0), np.arange(float(columns)))
    return np.stack([u, v], axis=2)


def numbered(shape: Shape) -> Numbering:
    return number(shape, DEGREES, flat(3 * sum(shape.counts) + 1))


PLAIN = Shape((2, 1), (False,) * 3, (False,) * 2, (False,) * 2)
APEX = Shape((2, 1), (False,) * 3, (True, False), (False, True))
POINTED = Shape((1, 1), (True, False, False), (False,) * 2, (False,) * 2)
LENS = Shape((1, 1), (True, False, True), (False,) * 2, (False,) * 2)
PINCHED = Shape((1, 1), (False, True, False), (False,) * 2, (False,) * 2)
SHAPES = {"plain": PLAIN, "apex": APEX, "pointed": POINTED, "lens": LENS, "pinched": PINCHED}


@pytest.mark.parametrize("name", SHAPES)
def test_unknowns_are_counted_without_gaps(name: str) -> None:
    made = numbered(SHAPES[name])
    assert sorted(set(made.unknowns.ravel().tolist()) - {HELD}) == list(range(made.count))


def test_a_plain_strip_is_held_by_three_unknowns() -> None:
    made = numbered(PLAIN)
    assert (made.count, made.border) == (2 * 3 * 10 - 3, 0)
    first = made.unknowns[0].reshape(4, 3, 2)
    assert (first[0, 0] == HELD).all()
    assert first[0, 2, 1] == HELD != first[0, 2, 0]
    assert (made.unknowns[0].reshape(4, 3, 2)[-1] == made.unknowns[1].reshape(4, 3, 2)[0]).all()


def test_an_apex_is_one_point_of_the_border() -> None:
    made = numbered(APEX)
    points = one_point(APEX, DEGREES)
    assert (points[:7, 0] == points[0, 0]).all()
    assert (points[6:, 2] == points[6, 2]).all()
    # c0(0) is the first apex and held, c1 of the last patch the second
    assert made.border == 2
    assert (made.unknowns[2].reshape(4, 3, 2)[:, 2] == [made.count - 2, made.count - 1]).all()


def test_a_ruling_without_length_is_one_point_and_the_last_one_keeps_its_direction() -> None:
    made = numbered(POINTED)
    first, last = made.unknowns[0].reshape(4, 3, 2), made.unknowns[1].reshape(4, 3, 2)
    assert (first[0] == HELD).all()
    assert last[-1, 0, 1] == last[-1, 2, 1] != HELD


def test_what_is_behind_a_pinch_keeps_its_direction_from_there() -> None:
    held = (numbered(PINCHED).unknowns[1].reshape(4, 3, 2) == HELD).sum()
    assert held == 1
    # the far corner (2, 6) from the pinch at (0, 3): its x turns it most
    assert numbered(PINCHED).unknowns[1].reshape(4, 3, 2)[-1, 0, 0] == HELD


@pytest.mark.parametrize("name", SHAPES)
def test_the_solution_is_that_of_the_full_matrix(name: str) -> None:
    made = numbered(SHAPES[name])
    source = np.random.default_rng(8)
    half = source.uniform(-1.0, 1.0, (len(made.unknowns), 2 * NODES, 2 * NODES))
    blocks = half @ np.swapaxes(half, 1, 2) + np.eye(2 * NODES)
    vectors = source.uniform(-1.0, 1.0, made.unknowns.shape)
    full, right = np.zeros((made.count, made.count)), np.zeros(made.count)
    for block, vector, unknowns in zip(blocks, vectors, made.unknowns.reshape(len(blocks), -1), strict=True):
        for i, row in enumerate(unknowns):
            if row != HELD:
                right[row] += vector.ravel()[i]
                for j, column in enumerate(unknowns):
                    if column != HELD:
                        full[row, column] += block[i, j]
    assert_near(gathered(vectors, made), right, bound=1e-14, why="sums in another order")
    found = solved(assembled(blocks, made), right)
    assert found is not None
    assert_near(found, np.linalg.solve(full, right), bound=1e-12, why="1e-16 times the condition, below 1e3")
    assert_near(spread(found, made)[made.unknowns == HELD], 0.0 * found[: (made.unknowns == HELD).sum()], bound=0.0,
                why="what is held does not move")  # fmt: skip


@pytest.mark.parametrize("name", ["plain", "apex"])
def test_a_matrix_that_is_not_positive_definite_is_refused(name: str) -> None:
    made = numbered(SHAPES[name])
    blocks = np.tile(np.eye(2 * NODES), (len(made.unknowns), 1, 1))
    assert solved(assembled(blocks, made), np.ones(made.count)) is not None
    blocks[-1, 2 * NODES - 2, 2 * NODES - 2] = -5.0
    assert solved(assembled(blocks, made), np.ones(made.count)) is None
