"""Two rails run through together so that both tangents and the ruling between them stay in one plane.

Rails r(t) and c(s) bound a developable where F(t, s) = det(r', c - r, c') vanishes.  Along an arc of F = 0 on which
both parameters rise, w = t + s rises too and t(w) is a smooth function: F_t and F_s have opposite signs there, so that
F(t, w - t) crosses zero steeply.  `Linked` is one of the rails as a function of w: t in brackets to
rounding, its derivatives from the power series of F(t(w), w - t(w)) = 0, order by order.

Not for arcs with a point at which F_t = F_s = 0 (two arcs cross there): divide them there.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Points3, Values
from stages.geometry.curves import Curve
from stages.geometry.roots import bracketed
from stages.geometry.series import derivatives, inner, outer, product, taylor


@dataclass(frozen=True, slots=True, eq=False)
class Linked(ArrayValue):
    """One of two rails along an arc of F = 0, over v in [0, 1].

    a, b: both rails, each smooth over [0, 1].
    w, t: knots of the arc, w rising, F(t, w - t) = 0 there.
    on_b: whether this is rail b's curve.
    """

    a: Curve
    b: Curve
    w: Values
    t: Values
    on_b: bool

    def check(self) -> None:
        """Refuse knots that do not rise."""
        if not ((np.diff(self.w) > 0.0).all() and self.w.size == self.t.size >= len("ab")):
            raise ValueError("the knots of an arc must rise")

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        span = float(self.w[-1] - self.w[0])
        w = self.w[0] + v * span
        t = arc(self, w, order)
        rail, x = (self.b, complement(w, t)) if self.on_b else (self.a, t)
        scales = span ** np.arange(order + 1.0)
        return derivatives(composed(rail.jet(x[0], order), x) * scales[:, None, None])


def complement(w: Values, t: Array) -> Array:
    """Return the Taylor coefficients of s = w - t."""
    s = -t
    s[0] += w
    s[1:2] += 1.0
    return s


def arc(link: Linked, w: Values, order: int) -> Array:
    """Return the Taylor coefficients of t(w) up to `order`, shape (order + 1, n)."""
    t = np.zeros((order + 1, w.size))
    t[0] = _solved(link, w)
    slope = _steepness(link, t[0], w - t[0]) if order else t[0]
    for k in range(1, order + 1):
        t[k] = -_mismatch(link, w, t[: k + 1]) / slope
    return t


def _mismatch(link: Linked, w: Values, t: Array) -> Values:
    """Return the last Taylor coefficient of F(t(w), w - t(w)) for a series t whose own last one is still missing."""
    count = t.shape[0]
    s = complement(w, t)
    r, c = link.a.jet(t[0], count), link.b.jet(s[0], count)
    along_r, along_c = composed(r[1:], t), composed(c[1:], s)
    arm = composed(c[:count], s) - composed(r[:count], t)
    found: Values = inner(outer(along_r, arm), along_c)[-1]
    return found


def composed(jet: Array, x: Array) -> Array:
    """Return the Taylor coefficients of f(x(w)), shape (m, n, 3), from f's derivatives at x[0] and x's own, (m, n)."""
    count = x.shape[0]
    step = x.copy()
    step[0] = 0.0
    power = np.zeros_like(x)
    power[0] = 1.0
    total = np.zeros((count, *jet.shape[1:]))
    for term in taylor(jet[:count]):
        total += power[:, :, None] * term
        power = product(power, step)
    return total


def _triple(a: Points3, b: Points3, c: Points3) -> Values:
    product: Values = np.einsum("ni,ni->n", np.cross(a, b), c)
    return product


def mismatch(a: Curve, b: Curve, t: Values, s: Values) -> Values:
    """Return F = det(r', c - r, c') at pairs of parameters, mm3."""
    r, c = a.jet(t, 1), b.jet(s, 1)
    return _triple(r[1], c[0] - r[0], c[1])


def _steepness(link: Linked, t: Values, s: Values) -> Values:
    """Return F_t - F_s."""
    r, c = link.a.jet(t, 2), link.b.jet(s, 2)
    arm = c[0] - r[0]
    steepness: Values = _triple(r[2], arm, c[1]) - _triple(r[1], arm, c[2])
    return steepness


def _solved(link: Linked, w: Values) -> Values:
    """Return t with F(t, w - t) = 0 between the knots around w, to rounding.

    Newton's method from the chord between the knots, which are near; what does not settle is bracketed.
    """
    k = np.clip(np.searchsorted(link.w, w, side="right") - 1, 0, link.w.size - 2)
    s = link.w - link.t
    # both parameters rise, so t lies between the knots' t, and w - t between their s
    low, high = np.maximum(link.t[k], w - s[k + 1]), np.minimum(link.t[k + 1], w - s[k])
    high = np.maximum(low, high)
    t: Values = np.clip(np.interp(w, link.w, link.t), low, high)
    step = np.zeros_like(t)
    for _ in range(NEWTON_STEPS):
        with np.errstate(divide="ignore", invalid="ignore"):
            newton: Values = t - mismatch(link.a, link.b, t, w - t) / _steepness(link, t, w - t)
        after = np.clip(np.where(np.isfinite(newton), newton, t), low, high)
        step, t = np.abs(after - t), after
        if (step <= SETTLED).all():
            return t
    open_ = np.flatnonzero(step > SETTLED)
    t[open_] = bracketed(lambda x, n: mismatch(link.a, link.b, x, w[open_][n] - x), low[open_], high[open_])
    return t


NEWTON_STEPS = 8
"""From a knot's distance of 1/200 four steps pass rounding; twice as many for knots far apart."""
SETTLED = 4.0 * EPS
"""A last step of Newton's method, in parameters of size 1: its error is the square of it, or the rounding of F."""
