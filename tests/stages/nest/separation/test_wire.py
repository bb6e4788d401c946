"""Requests and layouts as lines of JSON: what is read is what was written, to the last digit."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPolygon, Polygon, affinity, box

from stages.nest.separation.problem import NOWHERE, RECTANGLE, Item, Kind, Problem, Spot
from stages.nest.separation.wire import Request, as_request, as_spot, request_line, spot_rows
from tests.stages.nest.separation.scenes import FREE, UPRIGHT, ell, figures, frame

FINITE = st.floats(allow_nan=False, allow_infinity=False)
SPOTS = st.builds(Spot, st.integers(-1, 50), st.integers(0, 50), FINITE, FINITE, FINITE)
HOLED = affinity.translate(frame(100.0, 30.0), 1.0 / 3.0, 7e-7)


def request(shape: Polygon, spots: tuple[Spot, ...] = (), seconds: float = 0.1) -> Request:
    kinds = (
        Kind(shape, (UPRIGHT, ((0.1, 1.0 / 3.0), (90.0, 90.0))), (RECTANGLE, 1)),
        Kind(ell(30.0, 10.0), (FREE, ()), (0, NOWHERE)),
    )
    regions = (HOLED, MultiPolygon([HOLED, box(200, 0, 300, 1.0 / 7.0)]))
    problem = Problem(kinds, (Item(0, 1, fixed=True), Item(1, 1)), ((1.0 / 3.0, 1e-300), (2.5, 1e9)), regions)
    return Request(problem, spots, True, seconds, 2, 7, (0.0, 1.0 / 3.0), (0.3, 1e12), (True, False))


def as_written(one: Request) -> list[object]:
    """A request as plain numbers."""
    kinds, regions = one.problem.kinds, one.problem.regions
    shapes = [[np.asarray(ring.coords).tolist() for ring in (k.shape.exterior, *k.shape.interiors)] for k in kinds]
    rest = [one.start, one.settled, one.seconds, one.threads, one.seed, one.cost, one.area, one.rectangle]
    items = [(item.kind, item.other, item.fixed) for item in one.problem.items]
    rules = [(kind.spans, kind.regions) for kind in kinds]
    return [shapes, rules, items, one.problem.bins, [region.wkb_hex for region in regions], *rest]


@given(figures(), st.tuples(SPOTS, SPOTS), st.floats(0.0, 1e6))
@settings(max_examples=50, deadline=None)
def test_a_request_is_read_as_it_was_written(shape: Polygon, spots: tuple[Spot, ...], seconds: float) -> None:
    one = request(shape, spots, seconds)
    line = request_line(one)
    assert line.count(b"\n") == 1
    assert line.endswith(b"\n")
    assert as_written(as_request(line)) == as_written(one)
    assert as_written(as_request(line.decode())) == as_written(one)


@given(st.lists(SPOTS))
def test_spots_are_read_as_they_were_written(spots: list[Spot]) -> None:
    assert [as_spot(row) for row in json.loads(json.dumps(spot_rows(spots)))] == spots


NO_SPOTS = [
    [0, 0, 0.0, 0.0],
    [0, 0, 0.0, 0.0, 0.0, 0.0],
    [0, 0, float("nan"), 0.0, 0.0],
    [0, 0, 0.0, float("inf"), 0.0],
    [float("nan"), 0, 0.0, 0.0, 0.0],
    [float("inf"), 0, 0.0, 0.0, 0.0],
    [0, float("-inf"), 0.0, 0.0, 0.0],
    [0, 0, None, 0.0, 0.0],
    ["a", "b", "c", "d", "e"],
    "abcde",
    {},
    None,
    3,
]


@pytest.mark.parametrize("row", NO_SPOTS)
def test_what_is_no_spot_is_refused(row: object) -> None:
    with pytest.raises((ValueError, TypeError)):
        as_spot(row)


@pytest.mark.parametrize("line", ["", "hello", "[]", "{}", '{"kinds": []}', "3", b"\xff\xfe"])
def test_what_is_no_request_is_refused(line: str | bytes) -> None:
    with pytest.raises((ValueError, TypeError, KeyError)):
        as_request(line)
