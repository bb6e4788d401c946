"""The strain energy of a flat map near the one along the rulings, with its exact derivatives.

The map is the ruling map plus a displacement d(u, v) that is a polynomial on each element.  In the orthonormal frame of
ruling e and across w of the surface, and in the frame E, E_perp of the flat ruling, the Jacobian is J = I + G with

    G = R^T [d_e, d_w] - kappa E_perp E_perp^T,   d_e = d_u / |p|,   d_w = (d_v - (S_v.e) d_e) / b,

b the length of S_v across the ruling, R the rotation to E.  kappa = 1 - cos(theta), theta the angle of the tangent
plane from that in the middle of the ruling: so the map along the rulings, d = 0, shortens the sheet across them, and
kappa is all that is left to relax.  With s1, s2 the principal stretches and Z^2 = (2 + tr G)^2 + c^2, c = G_21 - G_12,
half the energy density is

    ((s1 - 1)^2 + (s2 - 1)^2) / 2 = (|G|^2 - 2 c^2 / (Z + 2 + tr G)) / 2:

the distance of J from the nearest rotation [1]_, written without the cancellation of |J|^2 - 2 (s1 + s2) + 2.  Its
second derivative is I - r r^T / Z, where r of length sqrt 2 is the rotation; it is indefinite where Z < 2.

Everything is taken at Gauss points of the exact surface: no mesh, so no error of one.  Frames are never at the ends of
a ruling or of an element, so an apex or a ruling of length 0 there does no harm.

.. [1] L. Liu, L. Zhang, Y. Xu, C. Gotsman, S. J. Gortler, "A Local/Global Approach to Mesh Parameterization", 2008.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Matrix, Values, dot, norm, unit
from stages.geometry.flat.development import RulingMap, angle
from stages.geometry.numeric.elements import Degrees, rule
from stages.geometry.ruled.ruled import across, frames


@dataclass(frozen=True, slots=True, eq=False)
class Metric(ArrayValue):
    """A patch and its ruling map at n points: what derivatives by u and v become in orthonormal frames.

    length: |p|.  along: S_v.e.  aside: b.  kappa: what the ruling map is short of 1 across.  cos, sin: of E's angle.
    """

    length: Values
    along: Values
    aside: Values
    kappa: Values
    cos: Values
    sin: Values


def metric(base: RulingMap, u: Values, v: Values) -> Metric:
    """Return the metric at the points; each ruling is evaluated once."""
    rulings, index = np.unique(v, return_inverse=True)
    f = frames(base.patch, rulings)
    e, w = unit(f.p), unit(across(f, 0.5)[1])
    s_v = f.c0_d1[index] + u[:, None] * f.p_d1[index]
    level, lifted = dot(s_v, w[index]), dot(s_v, np.cross(e, w)[index])
    aside = np.hypot(level, lifted)
    cosine, sine = (np.divide(x, aside, out=np.zeros_like(x), where=aside > 0.0) for x in (level, lifted))
    # 1 - cosine, where it is small from the sine, which has not lost its digits
    kappa = np.divide(sine**2, 1.0 + cosine, out=1.0 - cosine, where=cosine > 0.0)
    phi = angle(base, rulings)[index]
    return Metric(norm(f.p)[index], dot(s_v, e[index]), aside, kappa, np.cos(phi), np.sin(phi))


@dataclass(frozen=True, slots=True, eq=False)
class Sheet(ArrayValue):
    """The Gauss points of m elements with q points and k nodes each.

    by_e, by_w: from values at the nodes to derivatives along and across the rulings, 1/mm, shape (m, q, k).
    weights: areas, mm2; kappa, cos, sin: see `Metric`; all of shape (m, q).
    stiffness: the integral of by_e by_e + by_w by_w, the constant part of the second derivatives, shape (m, k, k).
    """

    by_e: Array
    by_w: Array
    weights: Matrix
    kappa: Matrix
    cos: Matrix
    sin: Matrix
    stiffness: Array


def sheet(base: RulingMap, breaks: Values, degrees: Degrees) -> Sheet:
    """Return the Gauss points of the elements between `breaks` of v on one patch."""
    points, width = rule(degrees), np.diff(breaks)[:, None]
    v = breaks[:-1, None] + width * points.v
    flat = metric(base, np.tile(points.u, width.size), v.ravel())
    length, along, aside = (x.reshape(v.shape) for x in (flat.length, flat.along, flat.aside))
    by_e = points.by_u / length[..., None]
    by_w = (points.by_v / width[..., None] - along[..., None] * by_e) / aside[..., None]
    weights = points.weights * width * length * aside
    stiffness = sum(np.swapaxes(by, 1, 2) @ (weights[..., None] * by) for by in (by_e, by_w))
    kappa, cos, sin = (x.reshape(v.shape) for x in (flat.kappa, flat.cos, flat.sin))
    return Sheet(by_e, by_w, weights, kappa, cos, sin, np.asarray(stiffness))


def joined(sheets: list[Sheet]) -> Sheet:
    """Return the elements of several patches as one."""
    names = ("by_e", "by_w", "weights", "kappa", "cos", "sin", "stiffness")
    return Sheet(*(np.concatenate([getattr(sheet, name) for sheet in sheets]) for name in names))


@dataclass(frozen=True, slots=True, eq=False)
class Stretched(ArrayValue):
    """G at the Gauss points, shape (m, q) each: the first index is of the flat frame, the second of the surface's."""

    g11: Matrix
    g21: Matrix
    g12: Matrix
    g22: Matrix

    @property
    def curl(self) -> Matrix:
        """Return c = G_21 - G_12."""
        return np.asarray(self.g21 - self.g12)

    @property
    def spread(self) -> Matrix:
        """Return 2 + tr G."""
        return np.asarray(2.0 + self.g11 + self.g22)

    @property
    def size(self) -> Matrix:
        """Return Z, the sum of the principal stretches."""
        return np.asarray(np.hypot(self.spread, self.curl))


def stretched(sheet: Sheet, moved: Array) -> Stretched:
    """Return G for displacements of the nodes, mm, shape (m, k, 2)."""
    (e_x, e_y), (w_x, w_y) = (np.moveaxis(by @ moved, 2, 0) for by in (sheet.by_e, sheet.by_w))
    c, s = sheet.cos, sheet.sin
    return Stretched(c * e_x + s * e_y, c * e_y - s * e_x, c * w_x + s * w_y, c * w_y - s * w_x - sheet.kappa)


def energy(sheet: Sheet, at: Stretched) -> float:
    """Return half the integral of (s1 - 1)^2 + (s2 - 1)^2, mm2."""
    square = at.g11**2 + at.g21**2 + at.g12**2 + at.g22**2
    density = square / 2.0 - at.curl**2 / (at.size + at.spread)
    return float((sheet.weights * density).sum())


def gradient(sheet: Sheet, at: Stretched) -> Array:
    """Return the derivative of the energy by the displacements of each element's nodes, mm, shape (m, k, 2)."""
    turned = at.curl / at.size
    opened = turned * at.curl / (at.size + at.spread)
    along = _in_plane(sheet, at.g11 + opened, at.g21 - turned)
    aside = _in_plane(sheet, at.g12 + turned, at.g22 + opened)
    total: Array = np.swapaxes(sheet.by_e, 1, 2) @ (sheet.weights[..., None] * along)
    return total + np.swapaxes(sheet.by_w, 1, 2) @ (sheet.weights[..., None] * aside)


def hessian(sheet: Sheet, at: Stretched, *, convex: bool) -> Array:
    """Return the second derivatives, shape (m, 2 k, 2 k), nodes before components.

    convex: leave out what is negative in the density (where Z < 2), so that no direction bends downwards.
    """
    c, s = at.spread / at.size, at.curl / at.size
    r_e, r_w = _in_plane(sheet, -s, c), _in_plane(sheet, -c, -s)
    share = 1.0 / (np.maximum(at.size, 2.0) if convex else at.size)
    turning = sheet.by_e[..., None] * r_e[:, :, None] + sheet.by_w[..., None] * r_w[:, :, None]
    m, q, k, _ = turning.shape
    flat = turning.reshape(m, q, 2 * k)
    total: Array = -(np.swapaxes(flat, 1, 2) @ ((sheet.weights * share)[..., None] * flat))
    parts = total.reshape(m, k, 2, k, 2)
    for component in range(2):
        parts[:, :, component, :, component] += sheet.stiffness
    return total


def _in_plane(sheet: Sheet, x: Matrix, y: Matrix) -> Array:
    """Return vectors of the flat ruling's frame in the plane's, shape (m, q, 2)."""
    return np.stack([sheet.cos * x - sheet.sin * y, sheet.sin * x + sheet.cos * y], axis=-1)
