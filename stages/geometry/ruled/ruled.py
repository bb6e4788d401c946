"""Ruled patches S(u, v) = c0(v) + u p(v), u and v in [0, 1], and what is measured on them.

Symbols: p = c1 - c0 runs along the ruling; S_v = c0' + u p'; n0 = p x c0' and n1 = p x c1' are normals at both ends of
a ruling, n(u) = (1 - u) n0 + u n1; delta = p . (c0' x c1').  Warp is the angle between n0 and n1: 0 where the patch is
developable, 180 deg where the edge of regression lies between the directrices.  Gaussian curvature is
K = -delta^2 / |n(u)|^4.  Where a normal vanishes (an apex) the other one stands alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import EPS, ArrayValue, Points3, Values, cross3, diagonal, dot, norm, unit
from stages.geometry.curves.curves import Bezier, Curve, RationalBezier, difference, restrict


@dataclass(frozen=True, slots=True, eq=False)
class RuledPatch(ArrayValue):
    """A ruled patch by both directrices and their difference p (kept apart so that no digits are lost near an apex)."""

    c0: Curve
    c1: Curve
    p: Curve

    @property
    def exact(self) -> bool:
        """Whether both directrices are polynomial or rational with exact control points: proofs are possible."""
        return isinstance(self.c0, Bezier | RationalBezier) and isinstance(self.c1, Bezier | RationalBezier)


@dataclass(frozen=True, slots=True, eq=False)
class Frames(ArrayValue):
    """Directrices and rulings at n values of v, each of shape (n, 3); d1, d2 are derivatives by v."""

    c0: Points3
    c0_d1: Points3
    c0_d2: Points3
    p: Points3
    p_d1: Points3
    p_d2: Points3
    c1_d1: Points3


def between(c0: Curve, c1: Curve) -> RuledPatch:
    """Return the patch with these directrices."""
    return RuledPatch(c0, c1, difference(c1, c0))


def part(patch: RuledPatch, low: Fraction, high: Fraction) -> RuledPatch:
    """Return the part of the patch over [low, high] of v; p is restricted like the directrices, not subtracted anew."""
    return RuledPatch(*(restrict(curve, low, high) for curve in (patch.c0, patch.c1, patch.p)))


def frames(patch: RuledPatch, v: Values) -> Frames:
    """Return directrices, rulings and their derivatives at v."""
    c0, p = patch.c0.jet(v, 2), patch.p.jet(v, 2)
    return Frames(c0[0], c0[1], c0[2], p[0], p[1], p[2], patch.c1.jet(v, 1)[1])


def at(patch: RuledPatch, u: Values, v: Values) -> Points3:
    """Return the points S(u, v), mm."""
    points: Points3 = (1.0 - u)[:, None] * patch.c0.jet(v, 0)[0] + u[:, None] * patch.c1.jet(v, 0)[0]
    return points


def end_normals(f: Frames) -> tuple[Points3, Points3]:
    """Return n0 and n1, mm2."""
    return cross3(f.p, f.c0_d1), cross3(f.p, f.c1_d1)


def warp(patch: RuledPatch, v: Values) -> Values:
    """Return the angle that the normal turns along each ruling, rad, in [0, pi]."""
    return warp_of(frames(patch, v))


def warp_of(f: Frames) -> Values:
    """Return the warp of each ruling, rad, in [0, pi].

    By arctan2 of cross and dot product, since arccos loses half the digits near zero.  n0 x n1 is computed as
    p delta, which does not cancel.  Zero where one of the normals vanishes, NaN where both do.
    """
    n0, n1 = end_normals(f)
    l0, l1 = norm(n0), norm(n1)
    turn = norm(f.p) * np.abs(delta(f))
    angle: Values = np.arctan2(turn, dot(n0, n1))
    size = norm(f.p) * np.maximum(norm(f.c0_d1), norm(f.c1_d1))
    gone0, gone1 = l0 <= VANISHED * size, l1 <= VANISHED * size
    return np.where(gone0 & gone1, np.nan, np.where(gone0 | gone1, 0.0, angle))


VANISHED = 1e-13
"""A normal p x c' shorter than this share of |p||c'| is rounding noise: the product of doubles keeps 2e-16 of it."""


def delta(f: Frames) -> Values:
    """Return p . (c0' x c1') = p . (c0' x p'), mm3; the shorter of c1' and p' keeps more digits."""
    shorter = np.where((norm(f.c1_d1) < norm(f.p_d1))[:, None], f.c1_d1, f.p_d1)
    return dot(f.p, cross3(f.c0_d1, shorter))


def gaussian(patch: RuledPatch, v: Values) -> Values:
    """Return the largest |K| on each ruling, 1/mm2."""
    return gaussian_of(frames(patch, v))


def gaussian_of(f: Frames) -> Values:
    """Return the largest |K| on each ruling, 1/mm2: delta^2 over the fourth power of the shortest normal."""
    n0, n1 = end_normals(f)
    shortest = norm(nearest_to_zero(n0, n1))
    top = delta(f) ** 2
    flat = np.abs(delta(f)) <= VANISHED * norm(f.p) * norm(f.c0_d1) * norm(f.c1_d1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(flat, 0.0, top / shortest**4)


def nearest_to_zero(n0: Points3, n1: Points3) -> Points3:
    """Return the shortest of the vectors (1 - u) n0 + u n1, u in [0, 1]."""
    step = n1 - n0
    length = dot(step, step)
    u = np.clip(np.divide(-dot(n0, step), length, out=np.zeros_like(length), where=length > 0), 0.0, 1.0)
    nearest: Points3 = n0 + u[:, None] * step
    return nearest


def across(f: Frames, u: float | Values) -> tuple[Points3, Points3]:
    """Return S_v at u and its part perpendicular to the ruling, mm."""
    s_v = f.c0_d1 + np.reshape(u, (-1, 1)) * f.p_d1
    e = unit(f.p)
    return s_v, s_v - dot(s_v, e)[:, None] * e


def turn_rate(f: Frames) -> Values:
    """Return e'.w: how fast the rulings turn in the tangent plane (and so in the flat), rad per unit of v.

    e = p / |p|, w the unit vector across the ruling at its middle.
    """
    length, turn = norm(f.p), sideways(f.p_d1, unit(f.p), unit(across(f, 0.5)[1]))
    rate: Values = np.divide(turn, length, out=np.zeros_like(length), where=length > 0.0)
    return rate


def sideways(p_d1: Points3, e: Points3, w: Points3) -> Values:
    """Return p'.w, mm, 0 where it is rounding of p': over a short ruling that would turn without bound."""
    # p' without its part along the ruling: w is perpendicular to it only to rounding over the sine of their angle
    turn: Values = dot(p_d1 - dot(p_d1, e)[:, None] * e, w)
    return np.where(np.abs(turn) > PARALLEL * norm(p_d1), turn, 0.0)


PARALLEL = 8 * EPS
"""p'.w below this share of |p'|: three products, and the roundings of two unit vectors."""


def curvature(patch: RuledPatch, v: Values, u: float) -> Values:
    """Return the signed curvature across the rulings at u, 1/mm."""
    return curvature_of(frames(patch, v), u)


def curvature_of(f: Frames, u: float) -> Values:
    """Return the signed curvature across the rulings at u, 1/mm: S_vv . N over |the part of S_v across the ruling|^2.

    Positive towards N = p x S_v.  At an apex it is infinite, or 0 where the normal does not turn; NaN where no tangent
    plane is defined.
    """
    here = bending(f, u)
    length = norm(across(f, u)[1])
    apex = length <= VANISHED * (norm(f.c0_d1) + norm(f.p_d1))
    with np.errstate(divide="ignore", invalid="ignore"):
        result: Values = here / length
    if not apex.any():
        return result
    other = bending(f, 1.0 if u < MIDDLE else 0.0)
    at_apex = np.where(np.isnan(other), np.nan, np.where(np.abs(other) > TURNS, np.copysign(np.inf, other), 0.0))
    return np.where(apex, at_apex, result)


MIDDLE = 0.5
TURNS = 1e-12
"""A normal that turns by less, rad per unit of v, does not turn: rounding of unit vectors, a thousand times over."""


def bending(f: Frames, u: float) -> Values:
    """Return how fast the normal turns about the ruling, rad per unit of v: on a developable the same for every u."""
    s_v, perpendicular = across(f, u)
    normal = unit(cross3(f.p, s_v))
    bend = dot(f.c0_d2 + u * f.p_d2 - 2.0 * _along(f, s_v)[:, None] * f.p_d1, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate: Values = bend / norm(perpendicular)
    return rate


def _along(f: Frames, s_v: Points3) -> Values:
    """Return the component of S_v along the ruling, as a multiple of p: removes the twist of the parametrisation."""
    length = dot(f.p, f.p)
    return np.divide(dot(s_v, f.p), length, out=np.zeros_like(length), where=length > 0)


def regression(f: Frames) -> Values:
    """Return u of the edge of regression on each ruling; infinite where the rulings are parallel."""
    _, c = across(f, 0.0)
    e = unit(f.p)
    turn = f.p_d1 - dot(f.p_d1, e)[:, None] * e
    length = dot(turn, turn)
    return np.divide(-dot(c, turn), length, out=np.full_like(length, np.inf), where=length > 0)


def size_of(patches: Sequence[RuledPatch]) -> float:
    """Return the diagonal of the bounding box of the directrices, mm (sampled at 65 points of each)."""
    v = np.linspace(0.0, 1.0, 65)
    return diagonal(np.concatenate([at(patch, np.full_like(v, u), v) for patch in patches for u in (0.0, 1.0)]))


def longest_ruling(patch: RuledPatch) -> float:
    """Return the length of the longest of three rulings, mm: a scale that no end may take away."""
    return float(norm(patch.p.jet(np.array([0.0, 0.5, 1.0]), 0)[0]).max())
