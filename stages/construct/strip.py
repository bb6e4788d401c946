"""Theorem 3.1: composite surfaces of the paper's patches.

Conditions (A) to (F) say that both directrices of the next patch start with the first and second derivatives that the
ones before end with (and at the same points).  That makes the join C2 in the fixed parametrisation: sufficient for G2,
not necessary.  The next patch must be developable by itself, so it is built by the theorem of the first one.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from stages.construct.quintic import (
    End,
    combine,
    cone_ends,
    cylinder_ends,
    directrix,
    length_exact,
    moved,
    next_end,
    planar_ends,
    ruled_ends,
    vector,
)
from stages.construct.shape import Patch
from stages.geometry.arrays import floats
from stages.geometry.curves.curves import Bezier
from stages.model.quintics import (
    SHAPE_KEYS,
    QuinticCone,
    QuinticCylinder,
    QuinticPlanar,
    QuinticRuled,
)
from stages.model.quinticstrip import NextPatch

EndPair = tuple[End, End]
Pair = tuple[EndPair, EndPair | None]
"""Ends of c0 and of c1; None where c1 follows from an apex."""


def strip_ends(
    first: Patch, following: Sequence[NextPatch], first_detail: dict[str, object], *, normalise: bool
) -> list[Pair]:
    """Return the ends of both directrices of every patch of a strip, the first one settled."""
    pairs = [_first(first, first_detail, normalise=normalise)]
    for patch in following:
        pairs.append(_following(first, pairs[-1], patch, normalise=normalise))
    return pairs


def _first(first: Patch, first_detail: dict[str, object], *, normalise: bool) -> Pair:
    match first:
        case QuinticRuled():
            return ruled_ends(first, normalise=normalise)
        case QuinticPlanar():
            return planar_ends(first)
        case QuinticCylinder():
            return cylinder_ends(first, normalise=normalise)
        case QuinticCone():
            shape = first_detail["shape"]
            if not isinstance(shape, dict):
                raise TypeError("a cone's detail holds its shape parameters by name")
            return cone_ends(first, [Fraction(shape[key]) for key in SHAPE_KEYS], normalise=normalise), None


def _following(first: Patch, before: Pair, patch: NextPatch, *, normalise: bool) -> Pair:
    """Return the ends of the patch after `before`."""
    c0_start, point = before[0][1], vector(patch.p1)
    if isinstance(first, QuinticCylinder):
        alpha = Fraction(patch.alpha1)
        end = next_end(patch, "", Fraction(patch.s1 or 0) * alpha, point, normalise=normalise)
        c1_before = before[1]
        if c1_before is None:
            raise ValueError("a cylinder has two directrices")
        ruling = combine((1, c1_before[1].P), (-1, c0_start.P))
        return (c0_start, end), (moved(c0_start, ruling), moved(end, combine((Fraction(patch.g or 0), ruling))))
    end = next_end(patch, "", Fraction(patch.beta1 or 0), point, normalise=normalise)
    if before[1] is None:
        return (c0_start, end), None
    hat = next_end(patch, "_hat", Fraction(patch.beta1_hat or 0), vector(patch.q1 or ()), normalise=normalise)
    return (c0_start, end), (before[1][1], hat)


def joins_detail(pairs: Sequence[Pair]) -> dict[str, object]:
    """Return, per join, the new patch's start data in the paper's letters and the residuals of (3.9)."""
    return {"joins": [_join(a, b) for a, b in pairwise(pairs)]}


def _join(before: Pair, after: Pair) -> dict[str, object]:
    start = after[0][0]
    jumps = [
        derivative_jumps(directrix(*old), directrix(*new))
        for old, new in zip(before, after, strict=True)
        if old is not None and new is not None
    ]
    return {
        "gamma0": float(start.alpha),
        "mu0": float(start.beta),
        "t0": floats(start.T).tolist(),
        "n0": floats(start.N).tolist(),
        "k2": float(start.k),
        "first_derivative_residual": max(first for first, _ in jumps),
        "second_derivative_residual": max(second for _, second in jumps),
    }


def derivative_jumps(before: Bezier, after: Bezier) -> tuple[float, float]:
    """Return how far first and second derivative of two quintics differ where one ends and the next begins, mm.

    Of the curves as built, by their exact control points: 0 only where they are equal.
    """
    a3, a4, a5 = before.exact[-3:]
    b0, b1, b2 = after.exact[:3]
    first = combine((5, a5), (-5, a4), (-5, b1), (5, b0))
    second = combine((20, a5), (-40, a4), (20, a3), (-20, b2), (40, b1), (-20, b0))
    return float(length_exact(first)), float(length_exact(second))
