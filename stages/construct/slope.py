"""Surfaces of constant slope: rulings of one length from a planar curve, all at one angle to its plane.

With the unit tangent T of the curve, the normal Z of its plane and n = T x Z, right of travel, each ruling is

    p = L (cos(angle) n - sin(angle) Z),          -n for the side "in".

Along circles and lines that is exact in closed form (frusta, planes), elsewhere by the derivatives of T; at 90 deg it
is a cylinder over the curve itself.  Where the curve bends towards the rulings they meet at its centre of curvature,
the ridge: longer ones are refused, with the length that would do.  At a kink that opens, a cone about the corner
fills the gap; at one that closes, the pieces would have to be mitred, which is not done: refused.  Rulings that cross
others from further along the curve are for `verify` to find.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import cos, floor, isfinite, pi, radians, sin

import numpy as np

from stages.construct.curves import Chain
from stages.construct.plain import ALMOST_UPRIGHT, closed_chain
from stages.construct.tangent import place, stop_findings
from stages.geometry.arrays import ArrayValue, Values, Vector3, dot, floats, norm, unit
from stages.geometry.curves.curves import Circular, Curve, affine, bezier, exactly
from stages.geometry.curves.tangents import end_tangents, total, unit_tangent
from stages.geometry.numeric.extremum import maximum
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.developables import Slope
from stages.model.report import Finding, Metric, Where
from stages.model.scalars import RIGHT_ANGLE
from stages.model.tolerances import Tolerances

Made = tuple[tuple[RuledPatch, ...], tuple[Metric, ...], tuple[Finding, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Fall(ArrayValue):
    """How the rulings run: across the curve and down.

    normal: Z.  across: the way along n, mm, negative to the left.  down: the way along -Z, mm.
    """

    normal: Vector3
    across: float
    down: float


def slope(spec: Slope, link: Chain, tol: Tolerances) -> Made:
    """Return the patches with the cones at the kinks, the distance of the curve from its plane, and what is wrong."""
    findings = stop_findings(link)
    normal = None if findings else _normal(spec, link)
    if normal is None:
        return (), (), findings or (Finding("no-plane", NO_PLANE, fatal=True),)
    off = _off_plane(link, normal)
    measured = (Metric("planar_error_mm", off, "mm", "sampled", tol.chord_mm),)
    if off > tol.chord_mm:
        message = f"the curve leaves its plane by {off:.4g} mm, {tol.chord_mm:g} mm are allowed: make it planar"
        return (), measured, (Finding("not-planar", message, fatal=True),)
    fall = _fall(spec, normal)
    findings = (*_ridge_findings(link, fall, spec), *_kink_findings(link, fall, tol))
    return tuple(_patches(link, fall, tol)), measured, findings


def _fall(spec: Slope, normal: Vector3) -> Fall:
    length, angle = float(spec.length), radians(float(spec.angle))
    across = 0.0 if abs(spec.angle) == RIGHT_ANGLE else length * cos(angle)
    return Fall(normal, across if spec.side == "out" else -across, length * sin(angle))


def _patches(link: Chain, fall: Fall, tol: Tolerances) -> Iterator[RuledPatch]:
    """Yield the patch of each piece, and after it the cone at its end where there is one."""
    kinks = {kink.index: kink for kink in _kinks(link, fall, tol)}
    for i, curve in enumerate(link.curves):
        yield _patch(curve, fall)
        if i in kinks:
            yield _fan(kinks[i], fall)


def _patch(curve: Curve, fall: Fall) -> RuledPatch:
    p = _rulings(curve, fall)
    return RuledPatch(curve, total(curve, p), p)


def _rulings(curve: Curve, fall: Fall) -> Curve:
    down = exactly(-fall.down * fall.normal)
    if fall.across == 0.0:
        return bezier([down])
    x, y, z = fall.across * fall.normal
    right = [exactly(row) for row in ((0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0))]
    return affine(unit_tangent(curve), right, down)


NO_PLANE = "the curve is straight and not level: give the `normal` of the plane that the angle is measured from"


def _normal(spec: Slope, link: Chain) -> Vector3 | None:
    """Return the normal of the plane: as given, of the circle or arc, else of the curve and upwards."""
    turning = spec.curve.circle or spec.curve.arc
    if spec.normal is not None:
        return _unit(floats(spec.normal))
    if turning is not None:
        return _unit(floats(turning.normal))
    points = _samples(link)
    _, extents, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if extents[1] <= THIN * extents[0]:
        return UP if abs(axes[0] @ UP) <= THIN else None
    return _unit(_upwards(axes[2]))


UP = np.array([0.0, 0.0, 1.0])
THIN = 1e-9
"""Of the extent of a curve: less across is rounding, of coordinates far from the origin too."""


def _unit(vector: Vector3) -> Vector3:
    """Return the unit vector, exactly +-z where it is that up to rounding."""
    normal: Vector3 = unit(vector)
    return np.sign(normal[2]) * UP if abs(normal[2]) > ALMOST_UPRIGHT else normal


def _upwards(normal: Vector3) -> Vector3:
    """Return the normal or its opposite: the one whose last component that is not zero is positive."""
    last = next(x for x in normal[::-1] if abs(x) > THIN)
    return np.asarray(np.sign(last) * normal)


def _samples(link: Chain) -> np.ndarray:
    v = np.linspace(0.0, 1.0, SAMPLES)
    return np.concatenate([curve.jet(v, 0)[0] for curve in link.curves])


SAMPLES = 65
"""To a curve: a size and a distance from a plane, each to some 1e-4 of itself where a curve bends between them."""


def _off_plane(link: Chain, normal: Vector3) -> float:
    """Return how far the curve is from the plane through its middle, mm."""
    heights = _samples(link) @ normal
    return float(heights.max() - heights.min()) / 2.0


# The ridge


def _ridge_findings(link: Chain, fall: Fall, spec: Slope) -> tuple[Finding, ...]:
    """Refuse rulings that reach beyond the centre of curvature, with the longest that do not."""
    if fall.across == 0.0:
        return ()
    found = [(*maximum(partial(_bend_towards, curve, fall)), i) for i, curve in enumerate(link.curves)]
    bend, v, piece = max(found)
    if not isfinite(bend) or abs(fall.across) * bend <= 1.0 + ROUNDING:
        return ()
    longest = float(spec.length) / (abs(fall.across) * bend)
    message = (
        f"the rulings of {float(spec.length):g} mm reach past the ridge at {place(link, piece, v)}, where the "
        f"curve has a radius of {1.0 / bend:.6g} mm: at this angle at most {_down(longest):.12g} mm long"
    )
    return (Finding("slope-past-ridge", message, True, {"piece": piece, "v": v}),)


def _down(length_mm: float) -> float:
    """Return the length rounded down to a nanometre: what the message says must do."""
    return floor(length_mm * MILLION) / MILLION


MILLION = 1e6
"""Nanometres to a millimetre: a length to be typed needs no more."""


ROUNDING = 1e-13
"""Rulings that just reach the centre of curvature may do so up to rounding: a cone with its apex."""


def _bend_towards(curve: Curve, fall: Fall, v: Values) -> Values:
    """Return the curvature of the curve towards the side of the rulings, 1/mm."""
    _, d1, d2 = curve.jet(v, 2)
    side = np.sign(fall.across) * np.cross(d1, fall.normal)
    curvature: Values = dot(d2, side) / norm(d1) ** 3
    return curvature


# Kinks


@dataclass(frozen=True, slots=True, eq=False)
class Kink(ArrayValue):
    """A corner of the curve at the end of piece `index`, the tangent before it, and its turn to the left, rad."""

    index: int
    corner: Vector3
    tangent: Vector3
    turn: float


def _kinks(link: Chain, fall: Fall, tol: Tolerances) -> Iterator[Kink]:
    """Yield the corners where the rulings part by more than a join may gape."""
    pairs = [*pairwise(link.curves)]
    if closed_chain(link) <= tol.join_mm:
        pairs.append((link.curves[-1], link.curves[0]))
    for index, (a, b) in enumerate(pairs):
        before, after = end_tangents(a, b)
        turn = float(np.arctan2(np.cross(before, after) @ fall.normal, dot(before, after)))
        if abs(turn * fall.across) > tol.join_mm:
            yield Kink(index, a.jet(np.array([1.0]), 0)[0, 0], before, turn)


def _kink_findings(link: Chain, fall: Fall, tol: Tolerances) -> tuple[Finding, ...]:
    """Refuse corners that close towards the rulings, and those at which the curve turns back."""
    for kink in _kinks(link, fall, tol):
        at = place(link, kink.index, 1.0)
        where: Where = {"piece": kink.index, "v": 1.0}
        if abs(kink.turn) >= pi - TURNED_BACK:
            return (Finding("kink", f"the curve turns back on itself at {at}", True, where),)
        if kink.turn * fall.across < 0.0:
            message = (
                f"the curve has a kink of {np.degrees(abs(kink.turn)):.4g} deg towards the rulings at {at}: the pieces "
                f"would cross, and are not mitred; round the corner with a radius of at least {abs(fall.across):.6g} "
                f"mm, or take the other side"
            )
            return (Finding("kink", message, True, where),)
    return ()


TURNED_BACK = 1e-9
"""Within this of half a turn, rad, the sense of the turn is rounding."""


def _fan(kink: Kink, fall: Fall) -> RuledPatch:
    """Return the cone about a corner: from the last ruling before it to the first one after it."""
    x = fall.across * np.cross(kink.tangent, fall.normal)
    y, down, zero = np.cross(fall.normal, x), -fall.down * fall.normal, np.zeros(3)
    return RuledPatch(
        Circular(kink.corner, zero, zero, zero, 0.0, kink.turn),
        Circular(kink.corner + down, x, y, zero, 0.0, kink.turn),
        Circular(down, x, y, zero, 0.0, kink.turn),
    )
