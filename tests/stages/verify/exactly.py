"""The geometry of a ruling in exact arithmetic, by evaluating points: the second method for the certificate."""

from fractions import Fraction
from itertools import pairwise
from math import atan2, isqrt, pi

from stages.geometry.curves.curves import Bezier, RationalBezier, homogeneous
from stages.geometry.ruled.ruled import RuledPatch

Row = list[Fraction]


def inner(a: Row, b: Row) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def cross(a: Row, b: Row) -> Row:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def jet(curve: object, v: Fraction) -> tuple[Row, Row]:
    """Return position and derivative, by de Casteljau's scheme and the quotient rule."""
    assert isinstance(curve, Bezier | RationalBezier)
    rows = [list(point) for point in homogeneous(curve)]
    n = len(rows) - 1
    while len(rows) > 2:
        rows = [[(1 - v) * a + v * b for a, b in zip(x, y, strict=True)] for x, y in pairwise(rows)]
    slope = [n * (b - a) for a, b in zip(*rows, strict=True)]
    over = [(1 - v) * a + v * b for a, b in zip(*rows, strict=True)]
    place = [x / over[3] for x in over[:3]]
    return place, [(d - slope[3] * x) / over[3] for d, x in zip(slope[:3], place, strict=True)]


def normals(patch: RuledPatch, v: Fraction) -> tuple[Row, Row]:
    """Return n0 = p x c0' and n1 = p x c1'."""
    (c0, d0), (c1, d1) = (jet(curve, v) for curve in (patch.c0, patch.c1))
    p = [b - a for a, b in zip(c0, c1, strict=True)]
    return cross(p, d0), cross(p, d1)


def delta(patch: RuledPatch, v: Fraction) -> Fraction:
    (c0, d0), (c1, d1) = (jet(curve, v) for curve in (patch.c0, patch.c1))
    return inner([b - a for a, b in zip(c0, c1, strict=True)], cross(d0, d1))


def dot(patch: RuledPatch, v: Fraction) -> Fraction:
    """Return n0.n1."""
    return inner(*normals(patch, v))


def warp_at(patch: RuledPatch, v: Fraction) -> float:
    """Return the warp of one ruling, rad, rounded from exact numbers."""
    n0, n1 = normals(patch, v)
    turn, along = cross(n0, n1), inner(n0, n1)
    if not along:
        return pi / 2.0
    return atan2(_root(inner(turn, turn) / along**2), 1.0 if along > 0 else -1.0)


def curvature_at(patch: RuledPatch, v: Fraction) -> float:
    """Return the larger |K| of both ends of one ruling, rounded from exact numbers."""
    top = delta(patch, v) ** 2
    return max(float(top / inner(n, n) ** 2) for n in normals(patch, v))


def _root(value: Fraction) -> float:
    """Return the square root, rounded down by less than 1e-30 of it."""
    shift = max(0, 200 - value.numerator.bit_length() + value.denominator.bit_length())
    shift += shift % 2
    return float(Fraction(isqrt(int(value * 2**shift)), 2 ** (shift // 2)))
