"""Proofs that a polynomial is positive on [0, 1], and the least multiple of one that lies above another.

Positive Bernstein coefficients prove it; where they do not decide, the interval is halved.  Floats only propose where
to look: every statement is made in whole numbers.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from math import isqrt

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.numeric import bernstein
from stages.geometry.numeric.bernstein import Polynomial, add, multiply, ratio, rounded
from stages.geometry.numeric.extremum import maximum

RAISES = (1e-10, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 0.5, 2.0)
"""The bound tried is (1 + this) times the largest value known; then the proof is given up."""
SPLITS = 1500
"""Halvings that one proof may take; a smooth peak takes some 60."""
NARROWEST = 2.0**-40
"""Below this width a place stays open: a zero without a change of sign, which no halving decides."""
ELSEWHERE = tuple(Fraction(k, 128) for k in range(1, 128))
"""Where a bound starts from if it is 0 at the place found: no polynomial here, of degree 104 at most, is 0 at all."""


def proved_positive(f: Polynomial) -> tuple[bool | None, float | None]:
    """Return True if f > 0 on [0, 1] is proved, False with a v where f < 0, None with a v where it stays open."""
    pending = [(bernstein.whole(f), 0.0, 1.0)]
    undecided: float | None = None
    for _ in range(SPLITS):
        if not pending:
            return (True, None) if undecided is None else (None, undecided)
        piece, low, high = pending.pop()
        if min(piece.b) > 0:
            continue
        for value, v in ((piece.b[0], low), (piece.b[-1], high)):
            if value < 0:
                return False, v
        if high - low <= NARROWEST:
            undecided = low
            continue
        middle = (low + high) / 2.0
        left, right = bernstein.halves(piece)
        pending += [(right, middle, high), (left, low, middle)]
    return None, pending[-1][1] if pending else 0.5


def least_multiple(tops: Sequence[Polynomial], below: Polynomial) -> tuple[Fraction | None, float]:
    """Return t with every top <= t below on [0, 1] proved, as small as found, and the v where it is nearly reached.

    below must be positive and `tops` one polynomial that is not identically zero, or that and its negative.  None if
    no t was proved.
    """
    quotient = partial(_size, rounded(tops[0]), rounded(below))
    place = maximum(quotient)[1]
    known = _value(tops, below, place) or max(max(top(v) for top in tops) / below(v) for v in ELSEWHERE)
    for raised in RAISES:
        t = _short(known * (1 + Fraction(raised)))
        above = _exceeded(tops, below, t)
        if above is True:
            return t, place
        if above is not None:
            place = _climbed(quotient, above)
            known = max(known, _value(tops, below, place), _value(tops, below, above))
    return None, place


def _exceeded(tops: Sequence[Polynomial], below: Polynomial, t: Fraction) -> float | bool | None:
    """Return True if every top <= t below is proved, a v where one is greater, or None where that stays open."""
    raised = multiply(Polynomial((t.numerator,), t.denominator), below)
    for top in tops:
        state, where = proved_positive(add(raised, top, sign=-1))
        if state is not True:
            return None if state is None else where
    return True


def _value(tops: Sequence[Polynomial], below: Polynomial, v: float) -> Fraction:
    """Return the exact ratio at v; 0 where `below` is."""
    place = Fraction(v)
    under = below(place)
    return max(top(place) for top in tops) / under if under else Fraction(0)


def _size(top: Array, below: Array, v: Values) -> Values:
    size: Values = np.abs(ratio(top, below, v))
    return np.where(np.isfinite(size), size, 0.0)


STEPS = np.concatenate([-(0.5 ** np.arange(1, 53)), [0.0], 0.5 ** np.arange(1, 53)])
"""From the whole interval to the spacing of the doubles: a peak may be of any width."""
CLIMBS = 40
"""Each step leaves at most half of the way to the peak: after so many none is left."""


def _climbed(quotient: Callable[[Values], Values], v: float) -> float:
    """Return a place near v where the ratio has a local maximum, by steps of all widths."""
    best = -1.0
    for _ in range(CLIMBS):
        around = np.clip(v + STEPS, 0.0, 1.0)
        found = quotient(around)
        highest = int(np.argmax(found))
        if not found[highest] > best:
            break
        best, v = float(found[highest]), float(around[highest])
    return v


BITS = 60
"""Bits of a bound: rounding it up loses less than 1e-17 of it."""


def _short(t: Fraction) -> Fraction:
    """Return t rounded up to 60 bits: short numbers keep a proof quick, and t is free."""
    shift = BITS - t.numerator.bit_length() + t.denominator.bit_length()
    scale = Fraction(2) ** shift
    return -((-t * scale).__floor__()) / scale


def root_above(t: Fraction) -> Fraction:
    """Return a number not below the square root of t, by less than 2**-59 of it."""
    shift = BITS - (t.numerator.bit_length() - t.denominator.bit_length()) // 2
    return Fraction(isqrt((t * Fraction(4) ** shift).__floor__()) + 1) / Fraction(2) ** shift
