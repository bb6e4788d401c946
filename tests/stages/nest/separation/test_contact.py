"""Corners of one shape on corners of another, with edges along each other: only so do parts interlock exactly."""

from math import radians

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from stages.geometry.arrays import EPS
from stages.nest.separation.contacts import ALONG, contact
from stages.nest.separation.problem import tips_of
from stages.nest.separation.separate import seed_all
from stages.nest.separation.state import RECTANGLE
from tests.near import assert_near
from tests.stages.nest.separation.scenes import FREE, centred, ell, kind, moved, oblong, put, scene

SEEDS = st.integers(0, 2**31 - 1)


@given(SEEDS, st.sampled_from([0.0, 30.0, 90.0, 211.0]), st.sampled_from([0.0, 5000.0]))
@settings(max_examples=50, deadline=None)
def test_a_contact_lays_a_corner_on_a_corner_with_edges_along_each_other(seed: int, angle: float, base: float) -> None:
    on = scene([kind(ell(30.0, 10.0)), kind(oblong(20.0, 20.0), FREE)])
    put(on, 0, base, -base, angle)
    put(on, 1, base + 4.0, -base)
    seed_all(seed)
    found, turned, x, y = contact(on.given.shapes, on.given.rules, on.layout, 1, 1, 0, int(on.layout.span[1]), 0.0)
    assert found
    lying = tips_of(moved(on.problem.kinds[0].shape, base, -base, angle))
    meeting = tips_of(moved(on.problem.kinds[1].shape, x, y, float(np.degrees(turned))))
    away = np.hypot(*(lying[:, None, :2] - meeting[None, :, :2]).transpose(2, 0, 1))
    assert_near(float(away.min()), 0.0, bound=64 * EPS * (base + 50.0), why="a corner at a corner, after rounding")
    sines = lying[:, None, 2] * meeting[None, :, 3] - lying[:, None, 3] * meeting[None, :, 2]
    assert np.abs(sines).min() < ALONG


@given(SEEDS)
@settings(max_examples=50, deadline=None)
def test_a_triangle_that_may_be_turned_comes_to_lie_along_an_edge_of_a_hook(seed: int) -> None:
    hook, triangle = ell(30.0, 10.0), centred(Polygon([(0.0, 0.0), (41.0, 0.0), (9.0, 25.0)]))
    on = scene([kind(hook), kind(triangle, FREE)])
    put(on, 0, 0.0, 0.0, 33.0)
    put(on, 1, 4.0, 0.0)
    seed_all(seed)
    _, turned, x, y = contact(on.given.shapes, on.given.rules, on.layout, 1, 1, 0, int(on.layout.span[1]), 0.0)
    there = moved(triangle, x, y, float(np.degrees(turned)))
    shared = moved(hook, 0.0, 0.0, 33.0).boundary.intersection(there.boundary.buffer(1e-7))
    assert shared.length > 10.0 - 1e-3, "the shortest edge of the hook"


@given(SEEDS)
@settings(max_examples=50, deadline=None)
def test_a_contact_keeps_to_the_spans(seed: int) -> None:
    on = scene([kind(ell(30.0, 10.0)), kind(oblong(20.0, 10.0), ((20.0, 40.0),)), kind(oblong(20.0, 10.0))])
    put(on, 0, 0.0, 0.0, 33.0)
    put(on, 1, 4.0, 0.0, 30.0)
    put(on, 2, 4.0, 90.0)
    seed_all(seed)
    found, turned, _, _ = contact(on.given.shapes, on.given.rules, on.layout, 1, 1, 0, int(on.layout.span[1]), 0.5)
    assert not found or radians(20.0) <= turned <= radians(40.0)
    _, fixed, _, _ = contact(on.given.shapes, on.given.rules, on.layout, 2, 2, 0, int(on.layout.span[2]), 0.0)
    assert fixed == 0.0


def test_there_is_no_contact_without_a_neighbour_in_the_bin() -> None:
    on = scene([kind(oblong(9.0, 9.0), regions=(RECTANGLE,) * 2)] * 2, bins=((100.0, 100.0),) * 2)
    put(on, 0, 10.0, 10.0)
    put(on, 1, 10.0, 10.0, bin_=1)
    seed_all(1)
    assert not contact(on.given.shapes, on.given.rules, on.layout, 0, 0, 0, 0, 0.0)[0]
