"""Small problems for the tests of the search, random figures, and where shapely says that they lie."""

from collections.abc import Sequence
from math import cos, radians, sin
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st
from shapely import Polygon, affinity, transform

from stages.geometry.arrays import EPS
from stages.geometry.curves.rigid import Rigid2, apply
from stages.nest.separation.laying import lay, turn_into
from stages.nest.separation.problem import (
    QUARTERS,
    Arrays,
    Item,
    Kind,
    Problem,
    Span,
    arrays,
    empty_layout,
    inner,
    pose_for,
)
from stages.nest.separation.sampling import Area
from stages.nest.separation.state import RECTANGLE, Layout, Pose, Tables, Weights
from stages.nest.separation.tabling import tables_for

UPRIGHT: tuple[Span, ...] = ((0.0, 0.0),)
BY_QUARTERS: tuple[Span, ...] = tuple((angle, angle) for angle in QUARTERS)
FREE: tuple[Span, ...] = ((0.0, 360.0),)
WIDE = ((100_000.0, 100_000.0),)


class Scene(NamedTuple):
    """A problem as the kernels see it, with its tables, a layout and room for a pose."""

    problem: Problem
    given: Arrays
    tables: Tables
    layout: Layout
    pose: Pose


def centred(shape: Polygon) -> Polygon:
    """Return a shape about the middle of its box."""
    low_x, low_y, high_x, high_y = shape.bounds
    return affinity.translate(shape, -(low_x + high_x) / 2.0, -(low_y + high_y) / 2.0)


def oblong(width: float, height: float) -> Polygon:
    """Return a rectangle about the origin."""
    x, y = width / 2.0, height / 2.0
    return Polygon([(-x, -y), (x, -y), (x, y), (-x, y)])


def frame(outer: float, hole: float) -> Polygon:
    """Return a square with a square hole, about the origin."""
    return Polygon(oblong(outer, outer).exterior, [oblong(hole, hole).exterior])


def ell(size: float, thick: float) -> Polygon:
    """Return an L in a square box about the origin."""
    corners = [(0.0, 0.0), (size, 0.0), (size, thick), (thick, thick), (thick, size), (0.0, size)]
    return centred(Polygon(corners))


def kind(shape: Polygon, spans: tuple[Span, ...] = UPRIGHT, regions: Sequence[int] = (RECTANGLE,)) -> Kind:
    """Return a kind with the same spans in each bin."""
    return Kind(shape, (spans,) * len(regions), tuple(regions))


def scene(
    kinds: Sequence[Kind],
    items: Sequence[Item] | None = None,
    bins: tuple[tuple[float, float], ...] = WIDE,
    regions: tuple[Area, ...] = (),
) -> Scene:
    """Return a problem with nothing laid yet; one copy of each kind if no items are given."""
    copies = tuple(Item(number, number) for number in range(len(kinds))) if items is None else tuple(items)
    problem = Problem(tuple(kinds), copies, bins, regions)
    given = arrays(problem)
    return Scene(problem, given, tables_for(problem, given), empty_layout(problem, given), pose_for(given))


def put(
    on: Scene, item: int, x: float, y: float, angle_deg: float = 0.0, *, bin_: int = 0, kind_: int | None = None
) -> None:
    """Lay an item, in the first span of its kind."""
    which = int(on.given.items.kind[item]) if kind_ is None else kind_
    c, s = turn(angle_deg)
    span = int(on.given.rules.turn[which, bin_])
    lay(on.given.shapes, on.layout, on.pose, item, which, bin_, span, radians(angle_deg), c, s, x, y)


def posed(on: Scene, kind_: int, angle_deg: float = 0.0) -> Pose:
    """Return the pose of a scene filled with a kind turned by an angle."""
    turn_into(on.given.shapes, kind_, *turn(angle_deg), on.pose)
    return on.pose


def turn(angle_deg: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, exact for quarter turns."""
    return QUARTERS.get(angle_deg % 360.0) or (cos(radians(angle_deg)), sin(radians(angle_deg)))


def moved(shape: Polygon, x: float, y: float, angle_deg: float = 0.0) -> Polygon:
    """Return a shape after a motion."""
    return transform(shape, lambda points: apply(Rigid2(x, y, angle_deg), points))


def laid(on: Scene, item: int) -> Polygon:
    """Return where an item lies: its shape, a hair inside the true one, turned and moved by shapely."""
    layout = on.layout
    which = int(layout.kind[item])
    angle = float(np.degrees(layout.angle[item]))
    exact = next((one for one in QUARTERS if abs(angle % 360.0 - one) < 360.0 * 8 * EPS), angle)
    return moved(inner(on.problem.kinds[which].shape), float(layout.x[item]), float(layout.y[item]), exact)


def overlaps(shapes: Sequence[Polygon]) -> float:
    """Return the area that two of some shapes share, summed over all pairs, mm2."""
    return sum(float(a.intersection(b).area) for number, a in enumerate(shapes) for b in shapes[:number])


def ones(on: Scene) -> Weights:
    """Return weights of 1 for all items."""
    count = len(on.problem.items)
    return Weights(np.ones((count, count)), np.ones(count))


SIZES = (1.0, 30.0, 1000.0, 10_000.0)


@st.composite
def figures(draw: st.DrawFn, sizes: Sequence[float] = SIZES, *, holes: bool = True) -> Polygon:
    """Return a hollow figure about the middle of its box, every second one with a hole of its own form."""
    count = draw(st.integers(3, 9))
    reach = np.array(draw(st.lists(st.floats(0.3, 1.0), min_size=count, max_size=count)))
    way = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    ring = draw(st.sampled_from(sizes)) * reach[:, None] * np.column_stack([np.cos(way), np.sin(way)])
    hole = [0.5 * ring] if holes and draw(st.booleans()) else []
    return centred(Polygon(ring, hole))


def angles() -> st.SearchStrategy[float]:
    """Return angles in degrees, quarter turns among them."""
    return st.one_of(st.sampled_from(tuple(QUARTERS)), st.floats(0.0, 360.0))


def shares() -> st.SearchStrategy[float]:
    """Return where along a size something lies, round shares among them."""
    return st.one_of(st.sampled_from((-1.0, -0.5, 0.0, 0.5, 1.0)), st.floats(-1.2, 1.2))
