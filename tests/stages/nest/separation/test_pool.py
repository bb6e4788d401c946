"""The pool of layouts that did not work out: the least bad ones are kept, and gone on from more often."""

from collections import Counter

import numpy as np
import pytest

from stages.nest.separation.pool import Pool
from tests.stages.nest.separation.scenes import Scene, kind, oblong, put, scene

TAKEN = 2000


@pytest.fixture(scope="module")
def one() -> Scene:
    return scene([kind(oblong(10.0, 10.0))])


def kept(one: Scene, *lefts: float, most: int = 10) -> Pool:
    """Return a pool of layouts that can be told by where their item lies: at its overlap."""
    pool = Pool(most=most)
    for left in lefts:
        put(one, 0, left, 0.0)
        pool.keep(left, one.layout)
    return pool


def overlaps(pool: Pool) -> list[float]:
    return [left for left, _ in pool.layouts]


def test_the_least_bad_ones_are_kept_in_their_order(one: Scene) -> None:
    pool = kept(one, 5.0, 1.0, 9.0, 3.0, 7.0, most=3)
    assert overlaps(pool) == [1.0, 3.0, 5.0]
    assert [float(layout.x[0]) for _, layout in pool.layouts] == [1.0, 3.0, 5.0]
    assert pool.least == 1.0


def test_an_empty_pool_has_no_least_and_changes_nothing(one: Scene) -> None:
    pool = kept(one, 4.0)
    pool.clear()
    assert pool.least == np.inf
    put(one, 0, 8.0, 0.0)
    pool.take(one.layout, np.random.default_rng(1))
    assert float(one.layout.x[0]) == 8.0


def test_the_less_bad_a_layout_is_the_more_often_it_is_gone_on_from(one: Scene) -> None:
    """The place is the size of a normal number of spread 1/4 of the list: the first tenth is 0.4 of a spread wide."""
    pool, rng = kept(one, *map(float, range(10))), np.random.default_rng(7)
    count: Counter[float] = Counter()
    for _ in range(TAKEN):
        pool.take(one.layout, rng)
        count[float(one.layout.x[0])] += 1
    assert abs(count[0.0] / TAKEN - 0.311) < 4.0 * np.sqrt(0.311 * 0.689 / TAKEN)
    assert abs(count[4.0] / TAKEN - 0.064) < 4.0 * np.sqrt(0.064 * 0.936 / TAKEN)
    assert count[9.0] < 0.01 * TAKEN


def test_a_number_beyond_the_list_takes_the_last(one: Scene) -> None:
    class Far(np.random.Generator):
        def normal(self, *_: object, **__: object) -> float:
            return -3.0

    kept(one, 1.0, 2.0).take(one.layout, Far(np.random.PCG64(1)))
    assert float(one.layout.x[0]) == 2.0
