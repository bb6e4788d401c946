"""How large a formed part is along the axes of its description, in mm; whether that is proved or sampled.

A ruled surface is linear along its rulings, so that it reaches furthest on its edges: the directrices of its patches,
the outer loop of a trimmed face.  A polynomial, rational or circular directrix does so at an end or where a derivative
vanishes: a root of a polynomial, or an angle in closed form.  With these, and of a mesh, which is its vertices, the
size is `proved`, to rounding.  Any other edge is sampled at `SAMPLES` places and, where it may reach further than all
that is known, searched (`extremum`): `sampled`, good to 1e-9 of the size for extremes wider than 1/48 of the edge.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import comb

import numpy as np
from numpy.polynomial import polynomial

from stages.geometry.arrays import EPS, Array, Points3, Values, Vector3
from stages.geometry.curves.curves import Bezier, Circular, Curve, RationalBezier
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.numeric.extremum import maxima
from stages.geometry.ruled.strip import Strip, points
from stages.model.surface import BranchedSurface, MeshSurface, RuledSurface, Surface

Document = dict[str, object]
Run = Callable[[Values], Points3]
"""The points of an edge at places from 0 to 1, mm."""

SAMPLES = 33
ROUNDING = 1e-12
"""Share of the size by which an edge that reaches no further may seem to: rounding of points far from the origin."""


def formed_entry(surface: Surface) -> Document | None:
    """Return the size of a formed part for a report; nothing of a plate, and where nothing was constructed."""
    found = formed_size(surface)
    if found is None:
        return None
    size, proved = found
    return {"size_mm": size.tolist(), "evidence": "proved" if proved else "sampled"}


def formed_size(surface: Surface) -> tuple[Vector3, bool] | None:
    """Return the size along x, y and z, mm, and whether that is proved; None of a plate, and of what is not finite."""
    edges = list(_edges(surface))
    runs = [edge for edge in edges if not isinstance(edge, np.ndarray)]
    places = np.linspace(0.0, 1.0, SAMPLES)
    samples = [run(places) for run in runs]
    known = [*(edge for edge in edges if isinstance(edge, np.ndarray)), *samples]
    if not known or not all(np.isfinite(some).all() for some in known):
        return None
    both_ways = _both_ways(np.concatenate(known)).max(axis=0)
    for run, some in zip(runs, samples, strict=True):
        if _may_exceed(some, both_ways):
            both_ways = np.maximum(both_ways, _furthest(run))
    return both_ways[:3] + both_ways[3:], not runs


def _both_ways(places: Points3) -> Array:
    """Return how far places lie along x, y, z and against them, shape (n, 6)."""
    return np.hstack([places, -places])


def _may_exceed(samples: Points3, both_ways: Array) -> bool:
    """Return whether an edge may reach further than what is known.

    Between samples a smooth curve rises by 1/8 of their second difference; all of it leaves room.
    """
    room = np.abs(np.diff(samples, 2, axis=0)).max(axis=0)
    beyond = _both_ways(samples).max(axis=0) + np.tile(room, 2) - both_ways
    return bool((beyond > ROUNDING * np.abs(both_ways).max()).any())


def _furthest(run: Run) -> Array:
    """Return how far an edge reaches both ways."""
    return np.array([value for value, _ in maxima(lambda v: _both_ways(run(v)))])


def _edges(surface: Surface) -> Iterator[Points3 | Run]:
    """Yield points among which are those that are furthest apart, or edges on which those lie."""
    if isinstance(surface, MeshSurface):
        yield surface.mesh.vertices
    elif isinstance(surface, BranchedSurface):
        for face in surface.faces:
            yield from _edges(face)
    elif isinstance(surface, RuledSurface) and surface.trim is not None:
        from pipeline.report.pictures.branched import strip_of

        strip = strip_of(surface)
        yield from (partial(_on_strip, strip, curve) for curve in surface.trim.outer)
    elif isinstance(surface, RuledSurface):
        yield from (_rail(curve) for patch in surface.patches for curve in (patch.c0, patch.c1))


def _on_strip(strip: Strip, curve: PlaneCurve, t: Values) -> Points3:
    return points(strip, *curve.at(t).T)


def _at(curve: Curve, v: Values) -> Points3:
    return np.asarray(curve.jet(v, 0)[0])


def _rail(curve: Curve) -> Points3 | Run:
    """Return the points of a directrix that reach furthest, or all of it where these are not known."""
    if isinstance(curve, Bezier):
        return _at(curve, _turns(curve.points - curve.points[0], np.ones(len(curve.points))))
    if isinstance(curve, RationalBezier):
        return _at(curve, _turns(curve.near, curve.weights))
    return _at(curve, _turns_of_circle(curve)) if isinstance(curve, Circular) else partial(_at, curve)


def _turns(rows: Points3, weights: Values) -> Values:
    """Return the ends, and where one of the coordinates q / w has no slope: the zeros of q' w - q w'."""
    w = _powers(weights)
    found = [np.array([0.0, 1.0])]
    for column in rows.T:
        q = _powers(column)
        slope = polynomial.polysub(
            polynomial.polymul(polynomial.polyder(q), w), polynomial.polymul(q, polynomial.polyder(w))
        )
        # of two roots that nearly coincide, the real parts: a place more does no harm, all are on the curve
        found.append(np.clip(polynomial.polyroots(_without_noise(slope)).real, 0.0, 1.0))
    return np.unique(np.concatenate(found))


def _powers(coefficients: Values) -> Values:
    """Return the coefficients of the powers of v of a polynomial in Bernstein form: a_k = C(n, k) (D^k b)_0."""
    n = len(coefficients) - 1
    return np.array([comb(n, k) * np.diff(coefficients, k)[0] for k in range(n + 1)])


def _without_noise(powers: Values) -> Values:
    """Return a polynomial without leading coefficients that are rounding: they would be roots far away."""
    high = np.flatnonzero(np.abs(powers) > EPS * np.abs(powers).max(initial=0.0))
    return powers[: high[-1] + 1] if high.size else np.zeros(1)


def _turns_of_circle(curve: Circular) -> Values:
    """Return the ends, and where a coordinate of cos(a) U + sin(a) V + a W has no slope.

    With U = R cos(f) and V = R sin(f) that is R sin(f - a) = -W.
    """
    if curve.sweep == 0.0:
        return np.zeros(1)
    low, high = sorted((curve.start, curve.start + curve.sweep))
    found = [np.array([low, high])]
    for u, v, w in zip(curve.U, curve.V, curve.W, strict=True):
        size = float(np.hypot(u, v))
        if abs(w) <= size and size > 0.0:
            found += [_every_turn(angle, low, high) for angle in _level(np.arctan2(v, u), np.arcsin(w / size))]
    return np.clip((np.concatenate(found) - curve.start) / curve.sweep, 0.0, 1.0)


def _level(phase: float, rise: float) -> Sequence[float]:
    return phase + rise, phase + np.pi - rise


def _every_turn(angle: float, low: float, high: float) -> Values:
    """Return the angle and all that differ by full turns, between two angles."""
    first, last = np.ceil((low - angle) / (2.0 * np.pi)), np.floor((high - angle) / (2.0 * np.pi))
    return angle + 2.0 * np.pi * np.arange(first, last + 1.0)
