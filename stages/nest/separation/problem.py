"""What is to be laid where, as polygons, and the flat arrays that the kernels take.

Discs inscribed in shapes and distances to the edges of regions are those of `sampling`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np
import shapely
from shapely import Polygon

from stages.nest.separation.sampling import Area, field, poles
from stages.nest.separation.state import (
    NOWHERE,
    RECTANGLE,
    Bins,
    Floats,
    Items,
    Layout,
    Pose,
    Regions,
    Rules,
    Shapes,
    Whole,
)

HAIR_MM = 1e-7
"""Edges of a shape lie this far inside the true ones: parts that touch do not overlap."""

FULL_DEG = 360.0
ANY = ((0.0, FULL_DEG),)
"""The spans of what may be turned anyhow."""

FEW = (16, 8, 4)
"""So many angles stand for any, where their tables are no more than `MOST_FEW`: a second of filling on two cores."""

MOST_FEW = 2048

MOST_TABLES = 4096
"""Tables of one problem: about 10 kB each, and as much again for segments."""

QUARTERS = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}

EDGE_OF_NO_LENGTH = np.array([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [0.0] * 4, [0.0] * 4])
DISC_OF_NO_RADIUS = np.diag([1.0, 1.0, 0.0])
"""What an edge and a disc are multiplied by to leave nothing of them but where they begin, or their middle."""

Span = tuple[float, float]
Ring = Sequence[tuple[float, float]]


@dataclass(frozen=True, slots=True, eq=False)
class Kind:
    """One shape about the middle of its box, and for each bin the spans of its angles (deg) and its region.

    regions: the number of a region, RECTANGLE or NOWHERE, for each bin.
    """

    shape: Polygon
    spans: tuple[tuple[Span, ...], ...]
    regions: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """One copy: its kind, the kind it has when turned over (the same: it is not), and whether it stays where it is."""

    kind: int
    other: int
    fixed: bool = False


@dataclass(frozen=True, slots=True)
class Spot:
    """Where an item lies: bin, kind, angle in degrees, middle of its box in the bin."""

    bin: int
    kind: int
    angle_deg: float
    x: float
    y: float


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Kinds, copies, bins (width, height) and the regions in them."""

    kinds: tuple[Kind, ...]
    items: tuple[Item, ...]
    bins: tuple[tuple[float, float], ...]
    regions: tuple[Area, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """A problem as the kernels take it.

    rough: the rules with a few single angles for what may be turned anyhow, so that tables tell of most overlaps; the
        rules themselves where there is no such kind, or there would be too many tables.
    """

    shapes: Shapes
    rules: Rules
    regions: Regions
    items: Items
    bins: Bins
    rough: Rules

    @property
    def has_rough(self) -> bool:
        """Return whether the rough rules differ."""
        return bool((self.rough.turn != self.rules.turn).any())

    @property
    def roughly(self) -> "Arrays":
        """The same with the rough rules."""
        return replace(self, rules=self.rough)


def arrays(problem: Problem, hair_mm: float = HAIR_MM) -> Arrays:
    """Return a problem as flat arrays; hair_mm: how far edges lie inside the true shapes."""
    items = Items(
        np.array([item.kind for item in problem.items], dtype=np.int64),
        np.array([item.other for item in problem.items], dtype=np.int64),
        np.array([item.fixed for item in problem.items], dtype=np.bool_),
    )
    bins = Bins(np.array(problem.bins, dtype=np.float64).reshape(-1, 2))
    rules, rough = _rules(problem)
    return Arrays(_shapes(problem, hair_mm), rules, _regions(problem.regions), items, bins, rough)


def empty_layout(problem: Problem, given: Arrays) -> Layout:
    """Return room for a layout; every item has yet to be laid."""
    count = len(problem.items)
    edges = np.diff(given.shapes.first)[given.items.kind]
    poles = np.diff(given.shapes.pole)[given.items.kind]
    first = np.concatenate([[0], np.cumsum(edges)]).astype(np.int64)
    pole = np.concatenate([[0], np.cumsum(poles)]).astype(np.int64)
    zero = np.zeros(count)
    return Layout(
        zero.copy(), zero.copy(), zero.copy(), zero + 1.0, zero.copy(),
        np.zeros(count, dtype=np.int64), given.items.kind.copy(), np.zeros(count, dtype=np.int64),
        np.zeros((int(first[-1]), 4)), first, np.zeros((3, int(pole[-1]))), pole, np.zeros((count, 4)),
    )  # fmt: skip


def pose_for(given: Arrays) -> Pose:
    """Return room for any shape in one angle."""
    edges, poles = int(np.diff(given.shapes.first).max()), int(np.diff(given.shapes.pole).max())
    most = max(len(given.regions.edges), edges)
    return Pose(
        np.zeros((edges, 4)),
        np.zeros((3, poles)),
        np.zeros(4),
        np.zeros((4, most)),
        np.zeros(2),
        np.zeros(1, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


def _shapes(problem: Problem, hair_mm: float) -> Shapes:
    kinds, items = problem.kinds, problem.items
    smaller = [inner(kind.shape, hair_mm) for kind in kinds]
    edges = _as_many([edges_of(one) for one in smaller], items, EDGE_OF_NO_LENGTH)
    tips = [tips_of(kind.shape) for kind in kinds]
    discs = _as_many([poles(one) for one in smaller], items, DISC_OF_NO_RADIUS)
    hulls = [kind.shape.convex_hull for kind in kinds]
    size = [float(np.ptp(np.asarray(hull.exterior.coords), axis=0).max()) for hull in hulls]
    return Shapes(
        np.concatenate(edges), _starts(edges), np.concatenate(tips), _starts(tips),
        np.ascontiguousarray(np.concatenate(discs).T), _starts(discs), np.sqrt([hull.area for hull in hulls]),
        np.array(size), np.array([float(np.linalg.norm(rows[:, :2], axis=1).max()) for rows in tips]),
    )  # fmt: skip


def _as_many(rows: Sequence[Floats], items: Sequence[Item], blank: Floats) -> list[Floats]:
    """Return the rows of each kind, those of two kinds that one copy may have made equally many.

    A layout has room for one number of them.  What is added changes nothing: the first row, made blank.
    """
    count = [len(one) for one in rows]
    for item in items:
        count[item.kind] = count[item.other] = max(count[item.kind], count[item.other])
    return [
        np.concatenate([one, np.repeat(one[:1] @ blank, most - len(one), axis=0)])
        for one, most in zip(rows, count, strict=True)
    ]


def _starts(rows: Sequence[Floats]) -> Whole:
    return np.concatenate([[0], np.cumsum([len(one) for one in rows])]).astype(np.int64)


def inner(shape: Polygon, hair_mm: float = HAIR_MM) -> Polygon:
    """Return a shape a hair smaller, with as many rings; itself if it is too thin for that."""
    smaller = shape.buffer(-hair_mm, join_style="mitre")
    if isinstance(smaller, Polygon) and len(smaller.interiors) == len(shape.interiors) and not smaller.is_empty:
        return smaller
    return shape


def edges_of(area: Area) -> Floats:
    """Return the edges of all rings, (n, 4)."""
    rings = [np.asarray(ring.coords)[:, :2] for part in polygons(area) for ring in (part.exterior, *part.interiors)]
    return np.concatenate([np.hstack([ring[:-1], ring[1:]]) for ring in rings])


def polygons(area: Area) -> list[Polygon]:
    """Return the polygons of an area."""
    return [one for one in getattr(area, "geoms", [area]) if isinstance(one, Polygon) and not one.is_empty]


def tips_of(shape: Polygon) -> Floats:
    """Return the corners of the outline, counter-clockwise, with the direction of the edge that leaves each."""
    ring = shapely.remove_repeated_points(shapely.normalize(shape).exterior, HAIR_MM)
    points = np.asarray(ring.coords)[:, :2]
    if not ring.is_ccw:
        points = points[::-1]
    way = np.diff(points, axis=0)
    return np.hstack([points[:-1], way / np.linalg.norm(way, axis=1)[:, None]])


def _rules(problem: Problem) -> tuple[Rules, Rules]:
    """Return the spans and regions of each kind in each bin; and the same with single angles for any."""
    count = (len(problem.kinds), len(problem.bins))
    ends = np.zeros((4, *count), dtype=np.int64)
    spans = list[tuple[float, float, float, float]]()
    known: dict[tuple[Span, ...], tuple[int, int, int, int]] = {}
    few = few_angles(problem)
    for k, kind in enumerate(problem.kinds):
        for b in range(len(problem.bins)):
            own = kind.spans[b]
            if own not in known:
                instead = few if own == ANY else ()
                start, middle = len(spans), len(spans) + len(instead)
                spans += [_span(span) for span in (*instead, *own)]
                known[own] = (middle, len(spans), start, middle if instead else len(spans))
            ends[:, k, b] = known[own]
    region = np.array([kind.regions for kind in problem.kinds], dtype=np.int64).reshape(count)
    rows = np.array(spans, dtype=np.float64).reshape(-1, 4)
    return Rules(region, ends[0], ends[1], rows), Rules(region, ends[2], ends[3], rows)


def few_angles(problem: Problem) -> tuple[Span, ...]:
    """Return the single angles that stand for any, as many as there may be tables; none if nothing is turned so.

    Only a rectangle is made narrower, which is what they are for.
    """
    there = [
        problem.kinds[kind] for kind in sorted({kind for item in problem.items for kind in (item.kind, item.other)})
    ]
    if not any(ANY in kind.spans and RECTANGLE in kind.regions for kind in there):
        return ()
    simple = sum(not kind.shape.interiors for kind in there)
    pairs = simple * (simple + 1) // 2
    count = next((few for few in FEW if few * pairs <= MOST_FEW), 0)
    return tuple((k * FULL_DEG / count, k * FULL_DEG / count) for k in range(count))


def _span(span: Span) -> tuple[float, float, float, float]:
    low, high = span
    c, s = QUARTERS.get(low % 360.0) or (cos(radians(low)), sin(radians(low)))
    return radians(low), radians(high), c, s


def _regions(regions: Sequence[Area]) -> Regions:
    """Return edges, points of rings and fields of distance of all regions."""
    if not regions:
        none, zero = np.zeros((0, 4)), np.zeros(1, dtype=np.int64)
        return Regions(
            none, zero, np.zeros((0, 2)), zero, np.zeros(0), np.zeros(0, dtype=np.int64),
            np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2)), np.zeros(0),
        )  # fmt: skip
    edges = [edges_of(region) for region in regions]
    points = [_ring_points(region) for region in regions]
    fields = [field(region) for region in regions]
    start = np.concatenate([[0], np.cumsum([field.size for field, _, _ in fields])[:-1]]).astype(np.int64)
    return Regions(
        np.concatenate(edges), _starts(edges), np.concatenate(points), _starts(points),
        np.concatenate([field.ravel() for field, _, _ in fields]), start,
        np.array([field.shape for field, _, _ in fields], dtype=np.int64),
        np.array([origin for _, origin, _ in fields]), np.array([cell for _, _, cell in fields]),
    )  # fmt: skip


def _ring_points(region: Area) -> Floats:
    """Return a point of each ring: a shape whose edges cross none is inside if it holds none of them, or outside."""
    rings = [ring for part in polygons(region) for ring in (part.exterior, *part.interiors)]
    return np.array([ring.coords[0][:2] for ring in rings], dtype=np.float64).reshape(-1, 2)


__all__ = ["NOWHERE", "RECTANGLE", "Arrays", "Item", "Kind", "Problem", "Spot", "arrays", "empty_layout", "pose_for"]
