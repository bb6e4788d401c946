"""Tangent surfaces: r + u T along the unit tangent T of a curve r, its edge of regression.

Every developable that is neither a cone nor a cylinder is one of these, piece by piece.  The normal is the binormal, so
where the curvature of r vanishes the surface has no tangent plane: `verify` finds that place and says what happens
there.  A curve that stops or is straight throughout has no such surface and is refused here; so is a kink, at which
the rulings jump.
"""

from functools import partial
from itertools import pairwise

import numpy as np

from stages.construct.curves import Chain
from stages.construct.quintic import ZERO, scaling
from stages.geometry.arrays import Array, Values, cross3, norm
from stages.geometry.curves.curves import Curve, affine
from stages.geometry.curves.tangents import total, turn_between, unit_tangent
from stages.geometry.numeric.extremum import maxima
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.developables import Tangent
from stages.model.report import Finding
from stages.model.tolerances import Tolerances


def tangent_surface(spec: Tangent, edge: Chain, tol: Tolerances) -> tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]:
    """Return the tangent surface of every piece of the edge, and what refuses it: a stop, a straight piece, a kink."""
    stops = stop_findings(edge)
    if stops:
        return (), stops
    patches = tuple(_patch(curve, spec) for curve in edge.curves)
    return patches, (*_straight_findings(edge), *_kink_findings(spec, edge, tol))


def _patch(curve: Curve, spec: Tangent) -> RuledPatch:
    T = unit_tangent(curve)
    c0, c1 = (curve if d == 0 else total(curve, affine(T, scaling(d), ZERO)) for d in (spec.from_, spec.to))
    return RuledPatch(c0, c1, affine(T, scaling(spec.to - spec.from_), ZERO))


def stop_findings(link: Chain) -> tuple[Finding, ...]:
    """Refuse a curve that stops: there it has no tangent to build on."""
    for i, curve in enumerate(link.curves):
        (fastest, _), (slowest, v) = maxima(partial(_speeds, curve))
        if -slowest <= STOPPED * fastest:
            message = f"the curve stops at {place(link, i, v)}: it has no tangent there"
            return (Finding("curve-stops", message, True, {"piece": i, "v": v}),)
    return ()


def place(link: Chain, piece: int, v: float) -> str:
    """Return a place on a curve in words; the piece is named where there are several."""
    return f"v = {v:.6g}" + (f" of piece {piece}" if len(link.curves) > 1 else "")


def _speeds(curve: Curve, v: Values) -> Array:
    speed = norm(curve.jet(v, 1)[1])
    return np.stack([speed, -speed], axis=1)


STOPPED = 1e-6
"""Of the largest speed: what sampling makes of a zero between two places."""


def _straight_findings(edge: Chain) -> tuple[Finding, ...]:
    for i, curve in enumerate(edge.curves):
        (bend, _), *_ = maxima(partial(_bends, curve))
        if bend <= UNTURNED:
            message = f"piece {i} of the edge is straight: its tangents are one line, and no surface"
            return (Finding("edge-straight", message, True, {"piece": i}),)
    return ()


def _bends(curve: Curve, v: Values) -> Array:
    """Return how fast the tangent turns, rad per unit of v."""
    _, slope, bend = curve.jet(v, 2)
    turn: Array = norm(cross3(slope, bend)) / norm(slope) ** 2
    return turn[:, None]


UNTURNED = 1e-9
"""A tangent that turns less, rad over the whole piece, turns by rounding: of coordinates of 1e6 times the length."""


def _kink_findings(spec: Tangent, edge: Chain, tol: Tolerances) -> tuple[Finding, ...]:
    reach = max(abs(float(spec.from_)), abs(float(spec.to)))
    for i, (a, b) in enumerate(pairwise(edge.curves)):
        turn = turn_between(a, b)
        if turn * reach > tol.join_mm:
            kink = f"a kink of {np.degrees(turn):.4g} deg at {place(edge, i, 1.0)}"
            return (Finding("kink", f"the edge has {kink}: the rulings jump; make it smooth", True, {"piece": i}),)
    return ()
