"""Two rails run through together so that both tangents and the ruling between them stay in one plane.

Rails r(t) and c(s) bound a developable where F(t, s) = det(r', c - r, c') vanishes.  Along an arc of F = 0 on which
both parameters rise, w = t + s rises too and t(w) is a smooth function: F_t and F_s have opposite signs there, so that
F(t, w - t) crosses zero steeply.  A `Link` is such an arc by its knots; `Linked` is one of the rails, or an affine
image of it, as a function of w.

t is taken from the cubic through the knots around it and set onto F = 0 by Newton's method, in brackets between the
knots, to rounding; the derivatives follow from the power series of G(x, h) = F(t + x, w + h - t - x) in x and h, order
by order (`implicit`).  Both rails and the ruling between them are asked for at the same places one after the other:
the last few answers are kept.

Not for arcs with a point at which F_t = F_s = 0 (two arcs cross there): divide them there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Mask, Values, locked
from stages.geometry.curves.curves import Curve, affine
from stages.geometry.numeric.implicit import composed, crosses, implicit, offset, sheared
from stages.geometry.numeric.roots import bracketed
from stages.geometry.numeric.series import derivatives, slope
from stages.geometry.rails.mismatch import mismatch, mismatch_and_slope, mismatch_series, scale


@dataclass(frozen=True, slots=True, eq=False)
class Link(ArrayValue):
    """An arc of F = 0 between two rails, each smooth over [0, 1].

    w, t: its knots, w rising, F(t, w - t) = 0 there.  rate: dt/dw there, in [0, 1].
    ends: Taylor coefficients of t(w) about its first and its last knot, shape (2, k), where another arc crosses there.
    reach: how far from these knots they hold, in w; 0 where none crosses.
    """

    a: Curve
    b: Curve
    w: Values
    t: Values
    rate: Values
    ends: Array
    reach: Array

    def check(self) -> None:
        """Refuse knots that do not rise."""
        if not ((np.diff(self.w) > 0.0).all() and self.w.size == self.t.size == self.rate.size >= len("ab")):
            raise ValueError("the knots of an arc must rise")


@dataclass(frozen=True, slots=True, eq=False)
class Linked(ArrayValue):
    """A rail, or an affine image of it, along an arc of F = 0 from w = start to w = end, over v in [0, 1].

    on_b: whether it is run through by s = w - t instead of t.
    """

    link: Link
    rail: Curve
    on_b: bool
    start: float
    end: float

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        # both products: exact at both ends, so that parts meet
        w = (1.0 - v) * self.start + v * self.end
        t = arc(self.link, w, order)
        x = complement(w, t) if self.on_b else t
        scales = (self.end - self.start) ** np.arange(order + 1.0)
        return derivatives(composed(self.rail.jet(x[0], order), x) * scales[:, None, None])

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> "Linked":
        """Return matrix @ curve + shift."""
        return self.replace(rail=affine(self.rail, matrix, shift))

    def part(self, low: Fraction, high: Fraction) -> "Linked":
        """Return the part over [low, high], with its parameter again in [0, 1]; backwards if high < low."""
        start, end = ((1 - v) * Fraction(self.start) + v * Fraction(self.end) for v in (low, high))
        return self.replace(start=float(start), end=float(end))


def link(a: Curve, b: Curve, w: Values, t: Values) -> Link:
    """Return the arc with these knots, and more of them where the cubics between them are off it."""
    ends, reach = _crossed_ends(a, b, w, t)
    made = Link(a, b, w, t, _rates(a, b, w, t), ends, reach)
    for _ in range(ROUNDS):
        middles = (made.w[:-1] + made.w[1:]) / 2.0
        first, last = _held(made, middles)
        middles = middles[~first & ~last & (np.diff(made.w) > SHORTEST)]
        found = _solved(made, middles)
        off = np.abs(_guess(made, middles) - found) > NEAR / 2.0
        if not off.any() or made.w.size > MOST_KNOTS:
            break
        w, order = np.unique(np.concatenate([made.w, middles[off]]), return_index=True)
        t = np.concatenate([made.t, found[off]])[order]
        made = Link(a, b, w, t, _rates(a, b, w, t), ends, reach)
    return made


def _crossed_ends(a: Curve, b: Curve, w: Values, t: Values) -> tuple[Array, Array]:
    """Return the power series of t(w) at ends where another arc crosses, and how far they hold.

    Beside a crossing F is flat: at a distance d rounding leaves 1e-16 / d of t, 1e-16 / d^2 of its slope.
    """
    pair = [0, -1]
    G = np.tensordot(sheared(TERMS), mismatch_series(a, b, t[pair], (w - t)[pair], TERMS), axes=2)
    chords = np.array([(t[1] - t[0]) / (w[1] - w[0]), (t[-1] - t[-2]) / (w[-1] - w[-2])])
    ends = implicit(G, chords)
    ends[0] = t[pair]
    span = float(w[-1] - w[0])
    reaches = [span, *(reach for reach in REACHES if reach < span)]
    held = np.zeros(len(pair))
    for k in np.flatnonzero(crosses(G)):
        away = 1.0 if k == 0 else -1.0
        good = (r for r in reaches if _holds(a, b, float(w[pair[k]]), away * r, ends[:, k]))
        held[k] = next(good, 0.0)
    return ends.T, held


def _holds(a: Curve, b: Curve, w: float, step: float, series: Values) -> bool:
    """Return whether the series about w gives a place on F = 0 at a step from there, to rounding."""
    there = np.polynomial.polynomial.polyval(np.array([step]), series)
    other = w + step - there
    if not all(-ROUNDED <= float(x[0]) <= 1.0 + ROUNDED for x in (there, other)):
        return False
    if abs(step) > FAR and (np.abs(series[-LAST:]) * abs(step) ** np.arange(TERMS)[-LAST:] > EPS).any():
        return False
    size = scale(a.jet(there, 1), b.jet(other, 1))
    return bool((np.abs(mismatch(a, b, there, other)) <= NOISE * size).all())


TERMS = 20
ROUNDED = 1e-12
"""What a parameter may leave its piece by at the arc's other end: rounding."""
REACHES = tuple(0.64 / 2**k for k in range(20))
"""How far a series may hold, the farthest first; it is also tried to the other end of the arc."""
FAR = 0.08
"""Beyond it rounding leaves 1e-16 / d^2 = 2e-14 of the slope of t(w), less than a quadrature asks for, but up to a
hundred times as much where arcs cross at a small angle: there the series is better, if its terms end below rounding."""
LAST = 3
"""So many last terms of a series say that it ends."""


def _held(along: Link, w: Values) -> tuple[Mask, Mask]:
    """Return which places take the series about the first knot, and which that about the last; the nearer of both."""
    away = w - along.w[0], along.w[-1] - w
    first, last = away[0] < along.reach[0], away[1] < along.reach[1]
    nearer = away[0] < away[1]
    return first & (nearer | ~last), last & ~(nearer & first)


ROUNDS = 8
MOST_KNOTS = 2000
"""An arc between lattice lines takes some hundred; where so many do not do, F is noise and no more of them would."""
SHORTEST = 1e-6
"""Knots are not put closer than twice this: beside a point where arcs cross no cubic will do."""


def both_rails(found: Link) -> tuple[Linked, Linked]:
    """Return both rails along an arc."""
    start, end = float(found.w[0]), float(found.w[-1])
    return Linked(found, found.a, False, start, end), Linked(found, found.b, True, start, end)


def complement(w: Values, t: Array) -> Array:
    """Return the Taylor coefficients of s = w - t."""
    s = -t
    s[0] += w
    s[1:2] += 1.0
    return s


def arc(along: Link, w: Values, order: int) -> Array:
    """Return the Taylor coefficients of t(w) up to `order`, shape (order + 1, n)."""
    return _kept(along, w.tobytes(), max(order, USUAL))[: order + 1]


USUAL = 2
"""Frames of a patch ask for two derivatives of one rail and for one of the other."""


@lru_cache(maxsize=16)
def _kept(along: Link, w: bytes, order: int) -> Array:
    return locked(_expanded(along, np.frombuffer(w), order))


def _expanded(along: Link, w: Values, order: int) -> Array:
    """Return the Taylor coefficients of t(w)."""
    found = np.zeros((order + 1, w.size))
    held = _held(along, w)
    clear = ~held[0] & ~held[1]
    found[:, clear] = _from_places(along, w[clear], order)
    for end, (knot, here) in enumerate(zip(along.w[[0, -1]], held, strict=True)):
        if not here.any():
            continue
        series = np.polynomial.Polynomial(along.ends[end])
        for k in range(order + 1):
            found[k, here] = series(w[here] - knot)
            series = series.deriv() / (k + 1.0)
    found[0] = np.clip(found[0], 0.0, 1.0)
    return found


def _from_places(along: Link, w: Values, order: int) -> Array:
    """Return the Taylor coefficients of t(w), from those of G about places near t."""
    t = _guess(along, w)
    G = _mismatch_series(along, w, t, order + 1)
    # where F is rounding of zero there is no better place
    far = ~(np.abs(offset(G)) <= NEAR) & ~_is_rounding(along, G[0, 0], w, t)
    if far.any():
        t[far] = _solved(along, w[far])
        G[..., far] = _mismatch_series(along, w[far], t[far], order + 1)
    step = offset(G)
    step = np.where(np.abs(step) <= NEAR, step, 0.0)
    G[:-1] += step * slope(G)
    found = implicit(G, np.interp(w, along.w, along.rate))
    found[0] = t + step
    return found


NEAR = 1e-8
"""A place so near to the arc that one step leads onto it: what it leaves is of the order of its square, 1e-16."""


def _mismatch_series(along: Link, w: Values, t: Values, order: int) -> Array:
    """Return the Taylor coefficients of G in x and h, each up to `order`, shape (order + 1, order + 1, n)."""
    return np.tensordot(sheared(order), mismatch_series(along.a, along.b, t, w - t, order), axes=2)


def _rates(a: Curve, b: Curve, w: Values, t: Values) -> Values:
    """Return dt/dw at knots."""
    chords = np.diff(t) / np.diff(w)
    beside = (np.append(chords[:1], chords) + np.append(chords, chords[-1:])) / 2.0
    G = np.tensordot(sheared(2), mismatch_series(a, b, t, w - t, 2), axes=2)
    rates: Values = np.clip(implicit(G, beside)[1], 0.0, 1.0)
    return rates


def _is_rounding(along: Link, F: Values, w: Values, t: Values) -> Mask:
    """Return where F is rounding of zero."""
    rounding: Mask = np.abs(F) <= NOISE * scale(along.a.jet(t, 1), along.b.jet(w - t, 1))
    return rounding


NOISE = 1e-14
"""As a share of |r'||p||c'|: some fifty roundings."""


def _brackets(along: Link, w: Values) -> tuple[Values, Values]:
    """Return between which t must lie: both parameters rise, so t and w - t are between those of the knots."""
    k = np.clip(np.searchsorted(along.w, w, side="right") - 1, 0, along.w.size - 2)
    s = along.w - along.t
    low, high = np.maximum(along.t[k], w - s[k + 1]), np.minimum(along.t[k + 1], w - s[k])
    return low, np.maximum(low, high)


def _guess(along: Link, w: Values) -> Values:
    """Return t by the cubics between the knots."""
    k = np.clip(np.searchsorted(along.w, w, side="right") - 1, 0, along.w.size - 2)
    width = along.w[k + 1] - along.w[k]
    x = (w - along.w[k]) / width
    ahead, rise = along.rate[k + 1], (along.t[k + 1] - along.t[k]) / width
    bend = along.rate[k] + ahead - 2.0 * rise
    t = along.t[k] + width * x * (along.rate[k] + x * (rise - along.rate[k] - bend * (1.0 - x)))
    guess: Values = np.clip(t, *_brackets(along, w))
    return guess


def _solved(along: Link, w: Values) -> Values:
    """Return t with F(t, w - t) = 0 between the knots around w, to rounding.

    Newton's method from the cubic between the knots, which are near; what does not settle is bracketed.
    """
    low, high = _brackets(along, w)
    t = _guess(along, w)
    step = np.zeros_like(t)
    for _ in range(NEWTON_STEPS):
        F, steep = mismatch_and_slope(along.a, along.b, t, w - t)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton: Values = t - F / steep
        after = np.clip(np.where(np.isfinite(newton), newton, t), low, high)
        step, t = np.abs(after - t), after
        if (step <= SETTLED).all():
            return t
    open_ = np.flatnonzero(step > SETTLED)
    t[open_] = bracketed(lambda x, n: mismatch(along.a, along.b, x, w[open_][n] - x), low[open_], high[open_])
    return t


NEWTON_STEPS = 8
"""From a knot's distance of 1/200 four steps pass rounding; twice as many for knots far apart."""
SETTLED = 4.0 * EPS
"""A last step of Newton's method, in parameters of size 1: its error is the square of it, or the rounding of F."""
