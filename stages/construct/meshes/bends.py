"""A mesh of bent sheet as one blank: flanges, bends and folds with parallel rulings, in the order of their strip.

    bent_sheet(part, mesh, loops, tol) -> BentSheet | None

The mesh is seen along its rulings (`geometry.mesh.profile`), its profile is divided into legs (`profilelegs`) and one
chain of tangent legs is fitted to all vertices (`profilechain`).  It stands for the mesh only if what the file keeps of
its numbers explains how far each vertex is from it (the rule of `mesh.recognise`, of which noise is no part), if no
facet cuts a corner, and if all facets keep their sense in the plane.  Outlines and holes are refitted in the plane
(`refit`), where they may run across bends, and become the trim.  Bends are exact arcs: the strip is developable.

Two flanges that meet at an angle are folded: the file gives no radius, and none is made up.  Not for conical bends, and
not for bends in several directions (a tray): they make no strip.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos, sin

import numpy as np

from stages.construct.faces.strip import arcs
from stages.construct.joins import join_metrics, join_rows, joins_of
from stages.construct.quintic import combine, scaling, vector
from stages.geometry.arrays import (
    Array,
    ArrayValue,
    Numbers,
    Points2,
    Points3,
    Values,
    Vector2,
    Vector3,
    cross2,
    diagonal,
    norm,
)
from stages.geometry.curves.curves import Circular, Curve, affine, bezier, exactly
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.curves.refit import refitted
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.profile import allowed_mm, profiled
from stages.geometry.mesh.profilechain import Chain, Fitted, Leg, fitted, rounded
from stages.geometry.mesh.profilechart import ChainChart, pulled
from stages.geometry.mesh.profilelegs import CLUSTER, WIDEST_RAD, chain_of, stations, stretches
from stages.geometry.mesh.recognise import SHARE, Deviation, deviation_of
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.material import Part
from stages.model.report import Finding, Metric
from stages.model.surface import RuledSurface, Trim, whole_spans
from stages.model.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class BentSheet:
    """The strip, how far the vertices are from it, and what is told of it."""

    surface: RuledSurface
    deviation: Deviation
    metrics: tuple[Metric, ...]
    findings: tuple[Finding, ...]
    detail: dict[str, object]


@dataclass(frozen=True, slots=True, eq=False)
class Laid(ArrayValue):
    """A mesh laid out by a chain.

    origin, frame: where the chain lies in space; its legs run across the frame's last row, the rulings.
    flat: the vertices, x along the rulings and y along the chain, mm.
    """

    origin: Array
    frame: Array
    chain: Chain
    flat: Points2
    deviation: Deviation
    near_mm: float


def bent_sheet(part: Part, mesh: Mesh, loops: Sequence[Numbers], tol: Tolerances) -> BentSheet | None:
    """Return the strip that a mesh of flanges and bends was made from; None where it is none."""
    laid = laid_out(mesh, tol)
    if laid is None:
        return None
    outline, *holes = (refitted(laid.flat[loop], accuracy=laid.near_mm).edges for loop in loops)
    filled = len(loops) == 1 and _fills(laid, loops[0])
    ends = _middles(laid, loops[0]) if filled else _reach(laid, outline)
    chart, patches, breaks = strip(laid, ends)
    trim = None if filled else Trim(pulled(chart, outline), tuple(pulled(chart, hole) for hole in holes))
    size = diagonal(mesh.vertices)
    joins = joins_of(patches)
    surface = RuledSurface(part, patches, size, whole_spans(len(patches)), trim=trim, tangencies=breaks)
    detail: dict[str, object] = {"recognised": _told(laid), "joins": join_rows(joins, size, tol)}
    counts = (Metric("bends", float(_count(laid, bent=True)), "", "proved"),
              Metric("folds", float(_count(laid, bent=False)), "", "proved"))  # fmt: skip
    return BentSheet(surface, laid.deviation, (*counts, *join_metrics(joins, size, tol)), _folds(laid), detail)


def _count(laid: Laid, *, bent: bool) -> int:
    return sum(leg.turn_rad != 0.0 if bent else leg.folded for leg in laid.chain.legs)


# The mesh in the plane


def laid_out(mesh: Mesh, tol: Tolerances) -> Laid | None:
    """Return a mesh laid out by the chain that explains it; None where none does."""
    seen = profiled(mesh)
    if seen is None:
        return None
    origin = mesh.vertices.mean(axis=0)
    vertices = mesh.vertices - origin
    points, label = stations((vertices @ seen.frame[:2].T)[seen.order], seen.near_mm)
    found = stretches(points, seen.near_mm)
    if found is None:
        return None
    leg_of = np.zeros(len(vertices), dtype=np.int64)
    leg_of[seen.order] = np.searchsorted([leg.last for leg in found[:-1]], label, side="left")
    first = fitted(vertices, leg_of, Fitted(chain_of(points, found), seen.frame))
    leg_of = first.chain.legs_of(vertices @ first.frame[:2].T, leg_of)
    fit = fitted(vertices, leg_of, first)
    given = fitted(vertices, leg_of, Fitted(rounded(fit.chain, seen.near_mm), fit.frame))
    tries = (_laid(mesh, origin, leg_of, each, tol) for each in (given, fit))
    return next((laid for laid in tries if laid is not None), None)


def _laid(mesh: Mesh, origin: Vector3, leg_of: Numbers, fit: Fitted, tol: Tolerances) -> Laid | None:
    """Return the mesh laid out by a chain; None where that does not explain it."""
    vertices = mesh.vertices - origin
    along, left = fit.chain.places(vertices @ fit.frame[:2].T, leg_of)
    widest = max((leg.radius_mm for leg in fit.chain.legs if leg.turn_rad != 0.0), default=0.0)
    deviation = deviation_of(mesh, left, reach_mm=widest)
    near = max(deviation.rounding_mm, allowed_mm(mesh))
    if deviation.most_mm > min(near, SHARE * tol.chord_mm):
        return None
    flat: Points2 = np.column_stack([vertices @ fit.frame[2], along])
    laid = Laid(origin, fit.frame, fit.chain, flat, deviation, near)
    return laid if _stands_for(laid, mesh) else None


def _stands_for(laid: Laid, mesh: Mesh) -> bool:
    """Return whether no facet cuts a corner or is turned over in the plane."""
    a, b, c = (laid.flat[mesh.faces[:, k]] for k in range(3))
    longest = norm(np.stack([b - a, c - b, a - c])).max(axis=0)
    one_way = bool(np.all(cross2(b - a, c - a) >= -CLUSTER * laid.near_mm * longest))
    y = laid.flat[:, 1][mesh.faces]
    low, high = y.min(axis=1) + CLUSTER * laid.near_mm, y.max(axis=1) - CLUSTER * laid.near_mm
    turned = _turning(laid.chain, np.maximum(low, high)) - _turning(laid.chain, low)
    return one_way and bool(turned.max() <= WIDEST_RAD)


def _turning(chain: Chain, y: Values) -> Values:
    """Return by how much a chain turns up to places along it, either way; a fold counts for half a turn."""
    places, turned = [0.0], [0.0]
    for leg in chain.legs:
        places += [places[-1], places[-1] + leg.length_mm]
        turned += [turned[-1] + np.pi * leg.folded, turned[-1] + np.pi * leg.folded + abs(leg.turn_rad)]
    turning: Values = np.interp(y, places, turned)
    return turning


def _fills(laid: Laid, loop: Numbers) -> bool:
    """Return whether neighbours on the boundary lie on one of the four edges of a rectangle."""
    border = laid.flat[loop]
    sides = np.concatenate([(border - border.min(axis=0)).T, (border.max(axis=0) - border).T])
    on = sides <= SPREAD * laid.near_mm
    return bool(np.all((on & np.roll(on, -1, axis=1)).any(axis=0)))


SPREAD = 2.0
"""Both the outermost vertex and the one held against it may be off."""


def _middles(laid: Laid, loop: Numbers) -> tuple[Vector2, Vector2]:
    """Return the ends of the rectangle: the means of the boundary's points there, for their extremes are off."""
    border = laid.flat[loop]
    low, high = border.min(axis=0), border.max(axis=0)
    near = SPREAD * laid.near_mm
    ends = [[float(column[np.abs(column - end) <= near].mean()) for column, end in zip(border.T, side, strict=True)]
            for side in (low, high)]  # fmt: skip
    return np.array(ends[0]), np.array(ends[1])


def _reach(laid: Laid, outline: Sequence[PlaneCurve]) -> tuple[Vector2, Vector2]:
    """Return the range of the plane that holds the outline, with what swells beyond the vertices."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    every = np.concatenate([laid.flat, *(edge.at(t) for edge in outline)])
    low, high = laid.flat.min(axis=0), laid.flat.max(axis=0)
    return low - GROWN * (low - every.min(axis=0)), high + GROWN * (every.max(axis=0) - high)


SAMPLES, GROWN = 257, 2.0
"""Places on each edge, and how much farther than they the range reaches beyond the vertices."""


# The strip


def strip(laid: Laid, ends: tuple[Vector2, Vector2]) -> tuple[ChainChart, tuple[RuledPatch, ...], tuple[float, ...]]:
    """Return the chart over a range of the plane, its patches, and the v at which smooth legs meet."""
    low, high = ends
    legs = laid.chain.legs
    begins = laid.chain.begins()
    knots, halves, breaks = [float(low[1])], list[float](), list[float]()
    curves: list[Curve] = []
    for i, leg in enumerate(legs):
        start = float(low[1]) if i == 0 else float(begins[i, 3])
        end = float(high[1]) if i == len(legs) - 1 else float(begins[i + 1, 3])
        made = _curves(laid, i, (start, end), float(low[0]))
        if i and not leg.folded:
            breaks.append(float(len(curves)))
        curves += made
        knots += np.linspace(start, end, len(made) + 1)[1:].tolist()
        halves += [abs(leg.turn_rad) / leg.length_mm * (end - start) / len(made) / 2.0] * len(made)
    rise = combine((Fraction(float(high[0] - low[0])), vector(exactly(laid.frame[2]))))
    patches = tuple(between(c0, affine(c0, scaling(Fraction(1)), rise)) for c0 in curves)
    return ChainChart(np.array([low[0], high[0]]), np.array(knots), np.array(halves)), patches, tuple(breaks)


def _curves(laid: Laid, i: int, ends: tuple[float, float], height: float) -> tuple[Curve, ...]:
    """Return the exact curves of one leg between two places along the chain, at a height along the rulings."""
    x, y, heading, far = laid.chain.begins()[i]
    leg = laid.chain.legs[i]
    forward, left = (np.array([cos(heading), sin(heading)]), np.array([-sin(heading), cos(heading)]))
    if leg.turn_rad == 0.0:
        points = np.array([[x, y] + (end - far) * forward for end in ends])
        return (bezier([exactly(point) for point in _in_space(laid, points, height)]),)
    radius, side = leg.radius_mm, float(np.sign(leg.turn_rad))
    (centre,) = _in_space(laid, np.array([[x, y] + side * radius * left]), height)
    axes = laid.frame[:2].T
    ring = Circular(centre, -side * radius * (axes @ left), radius * (axes @ forward), np.zeros(3), 0.0, 1.0)
    return arcs(ring, (ends[0] - far) / radius, (ends[1] - far) / radius)


def _in_space(laid: Laid, points: Points2, height: float) -> Points3:
    space: Points3 = laid.origin + points @ laid.frame[:2] + height * laid.frame[2]
    return space


# What is told


def _told(laid: Laid) -> dict[str, object]:
    """Return what was recognised, with its numbers."""
    return {
        "kind": "bent sheet",
        "direction": laid.frame[2].tolist(),
        "legs": [_row(leg) for leg in laid.chain.legs],
        "rounding_mm": laid.deviation.rounding_mm,
    }


def _row(leg: Leg) -> dict[str, object]:
    fold: dict[str, object] = {"fold_deg": float(np.degrees(leg.fold_rad))} if leg.folded else {}
    if leg.turn_rad == 0.0:
        return fold | {"kind": "plane", "width_mm": leg.length_mm}
    return fold | {"kind": "cylinder", "radius_mm": leg.radius_mm, "angle_deg": float(np.degrees(leg.turn_rad))}


def _folds(laid: Laid) -> tuple[Finding, ...]:
    """Say that sharp folds have no bend radius."""
    angles = [float(np.degrees(leg.fold_rad)) for leg in laid.chain.legs if leg.folded]
    if not angles:
        return ()
    plural = "s" * (len(angles) > 1)
    message = (
        f"the mesh has {len(angles)} sharp fold{plural}, of {', '.join(f'{abs(angle):.4g}' for angle in angles)} deg: "
        "bend lines without a bend allowance, for it gives no bend radius; model the bends with theirs"
    )
    return (Finding("fold", message, False, {"folds": len(angles)}),)
