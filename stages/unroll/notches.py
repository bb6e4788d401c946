"""Notches in the outline: V, castle and U cut into the exact contour; slits and T as lines to be marked or cut.

A notch that encloses an area takes `width` of the outline, measured along it, half on each side of its place, and puts
its own sides there in its stead (`notchshapes`), `depth` into the part, across the edge at the place.  The outline
runs counter-clockwise, so the part lies on its left.  It has a beginning, and no end: edges are counted on beyond the
last one, into the next round, and back from the first into the one before.

A part with seams is cut along its allowances: its notches are placed here and cut there (`sewing`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Vector2, norm
from stages.geometry.curves.arclength import length_between, reached, speed_of
from stages.geometry.curves.plane import PlaneCurve, stretch
from stages.geometry.paths.cover import doubled
from stages.geometry.ruled.strip import locate
from stages.model.features import OUTLINED, NotchSpec
from stages.model.material import Part
from stages.model.pattern import Contour, Mark, MarkLayer, NotchPlace, Spot
from stages.model.report import Finding
from stages.model.surface import Placed
from stages.unroll import outline
from stages.unroll.marks import traced
from stages.unroll.notchshapes import Opening, lines, sides


@dataclass(frozen=True, slots=True)
class Notch:
    """A notch on an outline: its spot, and the first and last edge (exclusive) of the side that it has to stay on.

    The side may begin in the round before, or end in the next.
    """

    name: str
    spec: NotchSpec
    spot: Spot
    side: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Notched:
    """The outline with its notches and as it was without, the lines of those beside it, and what forbids any."""

    outer: Contour
    lines: tuple[Mark, ...] = ()
    findings: tuple[Finding, ...] = ()
    places: tuple[NotchPlace, ...] = ()
    boundary: Contour | None = None


def on_strip(placed: Placed, spec: NotchSpec, knots: np.ndarray) -> Notch:
    """Return a notch on the outline of a strip: first ruling, c1, last ruling, c0 back (as `outline.edges` runs)."""
    if placed.at is None:
        raise ValueError(f"the notch {placed.name} was not placed")
    u = float(placed.at[0])
    pieces = knots.size - 1
    index, local, _ = locate(knots, placed.at[1:])
    piece, t = int(index[0]), float(local[0])
    spots: dict[str, tuple[Spot, tuple[int, int]]] = {
        "start": ((0, u), (0, 1)),
        "c1": ((1 + piece, t), (1, 1 + pieces)),
        "end": ((1 + pieces, 1.0 - u), (1 + pieces, 2 + pieces)),
        "c0": ((1 + 2 * pieces - piece, 1.0 - t), (2 + pieces, 2 + 2 * pieces)),
    }
    return Notch(placed.name, spec, *spots[str(spec.edge)])


def on_outline(placed: Placed, spec: NotchSpec, edges: Sequence[PlaneCurve]) -> Notch | Finding:
    """Return a notch on the outline of a plate, by its distance from the beginning."""
    spot = reached([speed_of(edge) for edge in edges], float(spec.distance or 0))
    if spot is None:
        return _off(placed.name, f"{float(spec.distance or 0):g} mm is more than the outline is long")
    return Notch(placed.name, spec, spot, (0, len(edges)))


def notched(part: Part, outer: Contour, notches: Sequence[Notch]) -> Notched:
    """Return the outline with notches; that of a part with seams as it is, its notches only placed.

    Raises NoSolutionError as `outline.contour` does.
    """
    if part.spec.seam:
        return Notched(outer, places=tuple(_place(outer, notch) for notch in notches))
    return cut_into(outer, notches)


def cut_into(outer: Contour, notches: Sequence[Notch]) -> Notched:
    """Return an outline with its notches cut into it, or drawn beside it; Raises NoSolutionError as `notched` does."""
    if not notches:
        return Notched(outer)
    places = tuple(_place(outer, notch) for notch in notches)
    opened = [(notch, _opened(outer, notch)) for notch in notches]
    findings = tuple(opening for _, opening in opened if isinstance(opening, Finding))
    known = [(notch, opening) for notch, opening in opened if isinstance(opening, Opened)]
    lines = tuple(line for notch, opening in known for line in _lines(notch, opening, outer.chord_mm))
    cuts = [
        Cut(notch.name, one.low, one.high, sides(notch.spec, one.opening)) for notch, one in known if _is_edge(notch)
    ]
    found = sorted(cuts, key=lambda cut: cut.low)
    findings += tuple(
        Finding("notches-overlap", f"{b.name} begins before {a.name} has ended", fatal=True, where={"feature": b.name})
        for a, b in pairwise([*found, *(next_round(one, len(outer.edges)) for one in found[:1])])
        if b.low < a.high
    )
    if findings or not found:
        return Notched(outer, lines, findings, places)
    made = outline.contour(_edges(outer.edges, found), outer.chord_mm, outer.name)
    covered = doubled(made.path)
    if covered > made.chord_mm**2:
        message = f"with its notches the outline crosses itself: {covered:.4g} mm2 are covered twice or inside out"
        findings = (Finding("contour-crosses-itself", message, fatal=True),)
    return Notched(made, lines, findings, places, outer)


def _is_edge(notch: Notch) -> bool:
    """Return whether the shape of a notch is part of the outline."""
    return notch.spec.kind in OUTLINED and notch.spec.is_cut


def _place(outer: Contour, notch: Notch) -> NotchPlace:
    point, inward = frame(outer.edges, notch.spot)
    spec = notch.spec
    sizes = float(spec.depth), float(spec.width)
    return NotchPlace(notch.name, spec.kind, point, inward, *sizes, _is_edge(notch), notch.spot, spec.is_cut)


@dataclass(frozen=True, slots=True)
class Cut:
    """A stretch of the outline, from `low` to `high`, that the sides of a notch take the place of.

    It begins in the first round; across the beginning of the outline it ends in the next.
    """

    name: str
    low: Spot
    high: Spot
    sides: tuple[PlaneCurve, ...]


def next_round(cut: Cut, edges: int) -> Cut:
    """Return the same stretch in the next round of an outline of so many edges."""
    low, high = ((number + edges, t) for number, t in (cut.low, cut.high))
    return replace(cut, low=low, high=high)


@dataclass(frozen=True, slots=True)
class Opened:
    """The stretch of the outline that a notch takes, and its opening."""

    low: Spot
    high: Spot
    opening: Opening


def _opened(outer: Contour, notch: Notch) -> Opened | Finding:
    """Return what a notch takes of the outline, nothing for a slit or a T, or why it cannot."""
    point, inward = frame(outer.edges, notch.spot)
    if notch.spec.kind not in OUTLINED:
        return Opened(notch.spot, notch.spot, Opening(point, inward, point, point))
    count, (first, last) = len(outer.edges), notch.side
    half = float(notch.spec.width) / 2.0
    rounds = [0, -count, count] if last - first == count else [0]
    tried = (_ends(outer.edges, notch.spot, (min(first, first + by), max(last, last + by)), half) for by in rounds)
    ends = next((one for one in tried if one is not None), None)
    if ends is None:
        return _off(notch.name, f"{2.0 * half:g} mm wide, it passes an end of its edge")
    start, end = (outer.edges[edge % count].at(np.array([at]))[0] for edge, at in ends)
    (low, t), (high, s) = ends
    begin = low % count
    return Opened((begin, t), (high - low + begin, s), Opening(point, inward, start, end))


def _ends(edges: Sequence[PlaneCurve], spot: Spot, side: tuple[int, int], half: float) -> tuple[Spot, Spot] | None:
    """Return what lies `half` mm along a side of the outline before a spot, and behind it; None beyond its ends."""
    first, last = side
    speeds = [speed_of(edges[number % len(edges)]) for number in range(first, last)]
    index, t = spot
    before = sum(length_between(speed, 0.0, 1.0) for speed in speeds[: index - first])
    place = before + length_between(speeds[index - first], 0.0, t)
    low, high = reached(speeds, place - half), reached(speeds, place + half)
    return None if low is None or high is None else ((low[0] + first, low[1]), (high[0] + first, high[1]))


def _lines(notch: Notch, opened: Opened, chord_mm: float) -> list[Mark]:
    """Return the lines of a notch that is no part of the outline."""
    layer: MarkLayer = "CUT_SLIT" if notch.spec.is_cut else "MARK"
    if notch.spec.kind not in OUTLINED:
        return [Mark(notch.name, path, layer) for path in lines(notch.spec, opened.opening)]
    if notch.spec.is_cut:
        return []
    return [Mark(notch.name, traced(sides(notch.spec, opened.opening), chord_mm), layer)]


def _off(name: str, message: str) -> Finding:
    return Finding("notch-off-edge", f"{name}: {message}", fatal=True, where={"feature": name})


def frame(edges: Sequence[PlaneCurve], spot: Spot) -> tuple[Vector2, Vector2]:
    """Return the point of the outline and the unit vector into the part, just inside an end that has no direction."""
    edge, t = edges[spot[0]], spot[1]
    along = edge.derivative(np.clip(np.array([t, t - BESIDE, t + BESIDE]), 0.0, 1.0))
    tangent = along[int(np.argmax(norm(along) > 0.0))]
    inward = np.array([-tangent[1], tangent[0]]) / max(float(norm(tangent)), np.finfo(float).tiny)
    return edge.at(np.array([t]))[0], inward


BESIDE = 1e-6
"""How far in t beside an end without a direction its edge has one: a micrometre per metre."""


def _edges(edges: Sequence[PlaneCurve], cuts: Sequence[Cut]) -> tuple[PlaneCurve, ...]:
    """Return the outline with its cuts, which are in order and apart; it begins behind one across its beginning."""
    made: list[PlaneCurve] = []
    over, t = cuts[-1].high
    across = over >= len(edges)
    here: Spot = (over - len(edges), t) if across else (0, 0.0)
    for cut in cuts:
        made += _between(edges, here, cut.low)
        made += cut.sides
        here = cut.high
    return tuple(made) if across else (*made, *_between(edges, here, (len(edges) - 1, 1.0)))


def _between(edges: Sequence[PlaneCurve], start: Spot, end: Spot) -> list[PlaneCurve]:
    """Return the stretches of the outline from one spot to another."""
    whole = [
        (i, start[1] if i == start[0] else 0.0, end[1] if i == end[0] else 1.0) for i in range(start[0], end[0] + 1)
    ]
    return [stretch(edges[i], low, high) for i, low, high in whole if high > low]
