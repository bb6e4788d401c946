"""Notches in the outline: V notches cut into the exact contour, slits as lines to be marked.

A V notch takes `width` of the outline, measured along it, half on each side of its place, and puts two straight lines
to a tip in its stead, `depth` into the part, across the edge at the place.  The outline runs counter-clockwise, so the
part lies on its left.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.geometry.arclength import length_between, reached, speed_of
from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Vector2, norm
from stages.geometry.cover import doubled
from stages.geometry.plane import PlaneCurve, Segment, stretch
from stages.geometry.strip import locate
from stages.model.features import NotchSpec
from stages.model.pattern import Contour, Mark
from stages.model.report import Finding
from stages.model.surface import Placed
from stages.unroll import outline

Spot = tuple[int, float]
"""A place on an outline: the number of the edge, and t on it."""


@dataclass(frozen=True, slots=True)
class Notch:
    """A notch on an outline: its spot, and the first and last edge (exclusive) of the side that it has to stay on."""

    name: str
    spec: NotchSpec
    spot: Spot
    side: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Notched:
    """The outline with its notches, the slits, and what forbids them; `places`: name and point of each, mm."""

    outer: Contour
    slits: tuple[Mark, ...] = ()
    findings: tuple[Finding, ...] = ()
    places: tuple[tuple[str, Vector2], ...] = ()


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
    return Notch(placed.name, spec, *spots[spec.edge])


def on_outline(placed: Placed, spec: NotchSpec, edges: Sequence[PlaneCurve]) -> Notch | Finding:
    """Return a notch on the outline of a plate, by its distance from the beginning."""
    spot = reached([speed_of(edge) for edge in edges], float(spec.distance or 0))
    if spot is None:
        return _off(placed.name, f"{float(spec.distance or 0):g} mm is more than the outline is long")
    return Notch(placed.name, spec, spot, (0, len(edges)))


def notched(outer: Contour, notches: Sequence[Notch]) -> Notched:
    """Return the outline with V notches in it and slits beside it; Raises NoSolutionError as `outline.contour` does."""
    if not notches:
        return Notched(outer)
    places = tuple((notch.name, _frame(outer, notch.spot)[0]) for notch in notches)
    slits = tuple(_slit(outer, notch) for notch in notches if notch.spec.kind == "slit")
    cuts = [_cut(outer, notch) for notch in notches if notch.spec.kind == "v"]
    findings = tuple(cut for cut in cuts if isinstance(cut, Finding))
    found = sorted((cut for cut in cuts if isinstance(cut, Cut)), key=lambda cut: cut.low)
    findings += tuple(
        Finding("notches-overlap", f"{b.name} begins before {a.name} has ended", fatal=True, where={"feature": b.name})
        for a, b in pairwise(found)
        if b.low < a.high
    )
    if findings or not found:
        return Notched(outer, slits, findings, places)
    made = outline.contour(_edges(outer.edges, found), outer.chord_mm, outer.name)
    covered = doubled(made.path)
    if covered > made.chord_mm**2:
        message = f"with its notches the outline crosses itself: {covered:.4g} mm2 are covered twice or inside out"
        findings = (Finding("contour-crosses-itself", message, fatal=True),)
    return Notched(made, slits, findings, places)


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A stretch of the outline, from `low` to `high`, that two lines to `tip` take the place of."""

    name: str
    low: Spot
    high: Spot
    tip: Vector2


def _cut(outer: Contour, notch: Notch) -> Cut | Finding:
    """Return what a V notch takes away, or why it cannot."""
    first, last = notch.side
    speeds = [speed_of(edge) for edge in outer.edges[first:last]]
    index, t = notch.spot
    before = sum(length_between(speed, 0.0, 1.0) for speed in speeds[: index - first])
    place = before + length_between(speeds[index - first], 0.0, t)
    half = float(notch.spec.width) / 2.0
    low, high = reached(speeds, place - half), reached(speeds, place + half)
    if low is None or high is None:
        return _off(notch.name, f"{2.0 * half:g} mm wide at {place:.6g} mm, it passes the end of its edge")
    point, inward = _frame(outer, notch.spot)
    tip = point + float(notch.spec.depth) * inward
    return Cut(notch.name, (low[0] + first, low[1]), (high[0] + first, high[1]), tip)


def _off(name: str, message: str) -> Finding:
    return Finding("notch-off-edge", f"{name}: {message}", fatal=True, where={"feature": name})


def _frame(outer: Contour, spot: Spot) -> tuple[Vector2, Vector2]:
    """Return the point of the outline and the unit vector into the part, just inside an end that has no direction."""
    edge, t = outer.edges[spot[0]], spot[1]
    along = edge.derivative(np.clip(np.array([t, t - BESIDE, t + BESIDE]), 0.0, 1.0))
    tangent = along[int(np.argmax(norm(along) > 0.0))]
    inward = np.array([-tangent[1], tangent[0]]) / max(float(norm(tangent)), np.finfo(float).tiny)
    return edge.at(np.array([t]))[0], inward


BESIDE = 1e-6


def _slit(outer: Contour, notch: Notch) -> Mark:
    point, inward = _frame(outer, notch.spot)
    ends = np.stack([point, point + float(notch.spec.depth) * inward])
    return Mark(notch.name, ArcPath(ends, np.zeros(2), closed=False))


def _edges(edges: Sequence[PlaneCurve], cuts: Sequence[Cut]) -> tuple[PlaneCurve, ...]:
    """Return the outline with its cuts, which are in order and apart."""
    made: list[PlaneCurve] = []
    here: Spot = (0, 0.0)
    for cut in cuts:
        made += _between(edges, here, cut.low)
        (start,), (end,) = (edges[index].at(np.array([t])) for index, t in (cut.low, cut.high))
        made += [Segment(start, cut.tip), Segment(cut.tip, end)]
        here = cut.high
    return (*made, *_between(edges, here, (len(edges) - 1, 1.0)))


def _between(edges: Sequence[PlaneCurve], start: Spot, end: Spot) -> list[PlaneCurve]:
    """Return the stretches of the outline from one spot to another."""
    whole = [
        (i, start[1] if i == start[0] else 0.0, end[1] if i == end[0] else 1.0) for i in range(start[0], end[0] + 1)
    ]
    return [stretch(edges[i], low, high) for i, low, high in whole if high > low]
