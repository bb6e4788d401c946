"""Where the holes, marks and notches of a part lie on its surface: places and curves in space become (u, v).

A place or curve given in u and v is taken as it is, one in space is pulled back to the nearest place of the surface
(`geometry.ruled.pullback`), as it is given: whatever face of the sheet that is.  Refused are places beyond the
surface, places with two nearest ones (a seam, the axis of a cylinder), and curves that jump or leave the surface.

That a curve stays on the surface, and how far it is from it, is measured at `SAMPLES` of its points.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.construct.curves import chain
from stages.construct.plain import plane_edges
from stages.geometry.arrays import Array, Points2, Points3, Values, Vector2, Vector3, floats, norm
from stages.geometry.curves.arclength import Speed, reached
from stages.geometry.curves.curves import Curve
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.tabled import tabled
from stages.geometry.ruled.nearest import nearest, rivals
from stages.geometry.ruled.pullback import PulledBack, pulled_back
from stages.geometry.ruled.ruled import RuledPatch
from stages.geometry.ruled.strip import Strip, jet, points, size
from stages.model.curves import CurveSpec, PlanePoint, in_numbers, is_flat
from stages.model.features import CurveHole, CurveMark, Feature, NotchSpec, RulingMarks, name_of
from stages.model.part import Flat, PartSpec
from stages.model.report import Finding, Metric
from stages.model.surface import Placed
from stages.model.tolerances import Tolerances

SAMPLES = 256
"""Points of a curve at which it is held against the surface."""
ON_EDGE = 1e-9
"""How far beyond 0 and 1 a u or v may be that is meant to be the edge."""
JUMP = 10.0
"""A nearest place that moves so many times as fast as the point it belongs to has jumped."""


@dataclass(frozen=True, slots=True)
class Placement:
    """All features of a part that could be placed, and what was found out about them."""

    features: tuple[Placed, ...]
    findings: tuple[Finding, ...]

    @property
    def metrics(self) -> tuple[Metric, ...]:
        """How far from the surface the features were given that were given in space."""
        off = [(f.distance_mm, f.name) for f in self.features if f.distance_mm is not None]
        worst = max(off, default=None)
        return () if worst is None else (Metric("feature_distance_mm", worst[0], "mm", where={"feature": worst[1]}),)


def named(spec: PartSpec) -> list[tuple[str, Feature]]:
    """Return the features that have a place, with their names; rulings are marked where the flat pattern is made."""
    # the holes of a plate's surface are numbered first
    first = 1 + (len(spec.surface.holes) if isinstance(spec.surface, Flat) else 0)
    features: list[tuple[str, Feature]] = [(name_of(hole, i), hole) for i, hole in enumerate(spec.hole, first)]
    features += [(name_of(mark, i), mark) for i, mark in enumerate(spec.mark, 1) if not isinstance(mark, RulingMarks)]
    # notches in seams have their places along the flat pattern
    edged = [(name_of(notch, i), notch) for i, notch in enumerate(spec.notch, 1) if notch.edge is not None]
    return [*features, *edged]


def placed(spec: PartSpec, patches: tuple[RuledPatch, ...], tol: Tolerances) -> Placement:
    """Return the features of a part on its patches; a fatal finding for each that has no place there."""
    if not patches or not named(spec):
        return Placement((), ())
    strip = Strip(patches, np.arange(len(patches) + 1.0))
    return placement(spec, lambda name, feature: _placed(strip, name, feature), tol)


def placement(spec: PartSpec, place: Callable[[str, Feature], Placed], tol: Tolerances) -> Placement:
    """Return the features of a part, each put in its place; where that fails, a fatal finding says why."""
    found: list[Placed] = []
    findings: list[Finding] = []
    for name, feature in named(spec):
        try:
            one = place(name, feature)
        except NoPlaceError as error:
            findings.append(Finding(error.code, f"{name}: {error}", fatal=True, where={"feature": name}))
            continue
        found.append(one)
        findings += _far(one, tol)
    return Placement(tuple(found), tuple(findings))


class NoPlaceError(Exception):
    """A feature that has no place on the surface: a code, and why."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code


def _far(one: Placed, tol: Tolerances) -> Iterator[Finding]:
    if one.distance_mm is not None and one.distance_mm > tol.chord_mm:
        far = f"{one.distance_mm:.4g} mm from the surface, more than the chord of {tol.chord_mm:g} mm"
        message = f"{one.name} is given {far}; the nearest place counts"
        yield Finding("off-surface", message, where={"feature": one.name})


def _placed(strip: Strip, name: str, spec: Feature) -> Placed:
    if isinstance(spec, CurveHole | CurveMark):
        edges, distance = _curve(strip, spec.curve)
        if isinstance(spec, CurveHole) and not is_closed(strip, edges):
            raise NoPlaceError("open-contour", "the curve does not close; on a seam it has no closed image")
        return Placed(name, spec, None, edges, distance)
    if isinstance(spec, NotchSpec):
        # the outline of a trimmed part is known where it is flat
        return Placed(name, spec, None if spec.edge == "outline" else _on_edge(strip, spec))
    if isinstance(spec, RulingMarks):
        raise ValueError("marked rulings have no place of their own")
    place, distance = _place(strip, spec.at)
    return Placed(name, spec, place, (), distance)


def _place(strip: Strip, at: PlanePoint) -> tuple[Vector2, float | None]:
    """Return u, v of a place, and its distance from the surface in mm if it was given in space."""
    if len(at) == len("uv"):
        place = np.array([float(x.plain or 0) for x in at])
        _refuse_beyond(strip, place[None, :])
        return place, None
    point: Vector3 = floats(at)
    found = nearest(strip, point)
    others = rivals(strip, found)
    if len(others):
        (u, v), (u2, v2) = found.place, others[0]
        text = f"(u, v) = ({u:.6g}, {v:.6g}) and ({u2:.6g}, {v2:.6g}) are equally near, {found.distance_mm:.4g} mm"
        raise NoPlaceError("ambiguous-place", f"{text}: give u and v instead")
    return found.place, found.distance_mm


def _refuse_beyond(strip: Strip, places: Points2) -> None:
    """Refuse u outside [0, 1] and v outside the strip."""
    low, high = np.array([0.0, strip.knots[0]]), np.array([1.0, strip.knots[-1]])
    off = np.maximum(low - places, places - high)
    worst = int(np.argmax(off.max(axis=1)))
    if off[worst].max() > ON_EDGE:
        u, v = places[worst]
        text = f"(u, v) = ({u:.6g}, {v:.6g}) is not on the surface: u from 0 to 1, v from 0 to {high[1]:g}"
        raise NoPlaceError("place-outside", text)


def _curve(strip: Strip, spec: CurveSpec) -> tuple[tuple[PlaneCurve, ...], float | None]:
    """Return a curve in u and v, and the largest distance in mm of one that was given in space."""
    if is_flat(spec):
        edges = plane_edges(chain(in_numbers(spec)), np.zeros(3), np.eye(3)[:2])
        for edge in edges:
            _refuse_beyond(strip, edge.at(np.linspace(0.0, 1.0, SAMPLES + 1)))
        _refuse_gaps(strip, edges)
        return edges, None
    pulled = [pulled_back(strip, curve, SAMPLES) for curve in chain(spec).curves]
    distance = max(checked(strip, edge) for edge in pulled)
    _refuse_gaps(strip, tuple(pulled))
    return tuple(tabled(edge, strip) for edge in pulled), distance


def checked(strip: Strip, edge: PulledBack) -> float:
    """Return the largest distance of a curve from the surface, mm; refuse one that leaves it or jumps on it."""
    every = edge.curve.jet(np.linspace(0.0, 1.0, len(edge.table)), 0)[0]
    found = jet(strip, edge.table[:, 0], edge.table[:, 1])
    off = every - found.s
    _refuse_jumps(strip, edge.table, every, found.s)
    along = tangential(off, found.s_u, found.s_v)
    worst = int(np.argmax(along))
    if along[worst] > ON_EDGE * size(strip):
        u, v = edge.table[worst]
        text = f"the curve runs {along[worst]:.4g} mm beyond the edge of the surface at (u, v) = ({u:.6g}, {v:.6g})"
        raise NoPlaceError("place-outside", text)
    return float(norm(off).max())


def tangential(off: Points3, s_u: Points3, s_v: Points3) -> Values:
    """Return the length of each vector's part in the tangent plane, mm; 0 where there is none (an apex)."""
    normal = np.cross(s_u, s_v)
    length = norm(normal)
    unit: Array = np.divide(normal, length[:, None], out=np.zeros_like(normal), where=length[:, None] > 0.0)
    rest = off - np.einsum("ij,ij->i", off, unit)[:, None] * unit
    return np.where(length > 0.0, norm(rest), 0.0)


def _refuse_jumps(strip: Strip, table: Points2, every: Points3, on_surface: Points3) -> None:
    """Refuse a curve whose nearest place jumps, in space or from one end of the strip to the other."""
    steps, moved = norm(np.diff(every, axis=0)), norm(np.diff(on_surface, axis=0))
    across = np.abs(np.diff(table[:, 1])) > (strip.knots[-1] - strip.knots[0]) / 2.0
    jumps = (moved > JUMP * steps + ON_EDGE * size(strip)) | (across & (moved <= JUMP * steps))
    if jumps.any():
        (u, v), (u2, v2) = table[int(np.argmax(jumps))], table[int(np.argmax(jumps)) + 1]
        text = f"the nearest place jumps from (u, v) = ({u:.6g}, {v:.6g}) to ({u2:.6g}, {v2:.6g})"
        raise NoPlaceError("ambiguous-curve", f"{text}: keep clear of seams and axes, or give u and v")


def _refuse_gaps(strip: Strip, edges: tuple[PlaneCurve, ...]) -> None:
    """Refuse a curve whose pieces do not meet."""
    worst = max((gap(strip, a, b) for a, b in pairwise(edges)), default=0.0)
    if worst > MEETS * size(strip):
        raise NoPlaceError("open-contour", f"the pieces of the curve leave a gap of {worst:.4g} mm on the surface")


MEETS = 1e-6
"""Pieces of a curve that end farther apart than this share of the size do not meet."""


def gap(strip: Strip, a: PlaneCurve, b: PlaneCurve) -> float:
    """Return the distance on the surface between the end of one curve and the beginning of another, mm.

    Across a seam they do not meet, however near: the length of the way round in u and v counts.
    """
    end, start = a.at(np.array([1.0])), b.at(np.array([0.0]))
    between = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    way = (1.0 - between) * end + between * start
    return float(norm(np.diff(points(strip, way[:, 0], way[:, 1]), axis=0)).sum())


def is_closed(strip: Strip, edges: tuple[PlaneCurve, ...]) -> bool:
    """Return whether the last curve ends where the first begins."""
    return gap(strip, edges[-1], edges[0]) <= MEETS * size(strip)


def _on_edge(strip: Strip, notch: NotchSpec) -> Vector2:
    """Return u, v of a notch on its edge, one of c0, c1, start and end."""
    along_v = notch.edge in ("c0", "c1")
    fixed = {"c0": 0.0, "c1": 1.0, "start": strip.knots[0], "end": strip.knots[-1]}[str(notch.edge)]
    place = float(notch.at) if notch.at is not None else _at_length(strip, notch, along_v=along_v)
    found = np.array([fixed, place] if along_v else [place, fixed])
    _refuse_beyond(strip, found[None, :])
    return found


def _speed(curve: Curve) -> Speed:
    return lambda t: norm(curve.jet(t, 1)[1])


def _at_length(strip: Strip, notch: NotchSpec, *, along_v: bool) -> float:
    """Return v (or u) at a length along an edge of the surface as given."""
    length = float(notch.distance or 0)
    if along_v:
        edges = [patch.c0 if notch.edge == "c0" else patch.c1 for patch in strip.patches]
        found = reached([_speed(edge) for edge in edges], length)
        if found is not None:
            return found[0] + found[1]
        raise NoPlaceError("place-outside", f"{length:g} mm is beyond the end of the edge {notch.edge}")
    v = strip.knots[:1] if notch.edge == "start" else strip.knots[-1:]
    whole = float(norm(jet(strip, np.zeros(1), v).s_u)[0])
    if length > whole:
        raise NoPlaceError("place-outside", f"the edge {notch.edge} is {whole:.6g} mm long, {length:g} mm asked for")
    return length / whole
