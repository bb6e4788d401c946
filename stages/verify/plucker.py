"""The exact polynomials of a ruled patch with polynomial or rational directrices, free of denominators and weights.

A directrix is c = A / w in homogeneous coordinates; common factors of A and w mean nothing, so A and w are taken in
whole numbers.  Its tangent has the Plucker coordinates [1]_  d = w A' - w' A  and  m = A x A',  so that with positive
powers of the weights (w0 of c0, w1 of c1) left out

    p  ~ P = w0 A1 - w1 A0,            delta ~ Delta = -(d0 . m1 + d1 . m0),
    n0 ~ M0 = A1 x d0 - w1 m0,         n1 ~ M1 = w0 m1 - A0 x d1,
    c0' ~ d0,                          c1' ~ d1,

    tan(warp) = |P| |Delta| / (M0 . M1),     sqrt|K| = |Delta| wi^2 / |Mi|^2  along edge i.

Both are free of scale.  With w = 1 these are the plain formulas.  A common factor of the three components of P, Mi or
di is where the ruling has no length, the normal vanishes, or the directrix stops; it is divided out, so that what is
left vanishes nowhere.

.. [1] H. Pottmann, J. Wallner, "Computational Line Geometry", 2001, ch. 2.
"""

from dataclasses import dataclass
from math import comb, gcd, lcm

from stages.geometry.curves.curves import Bezier, HomogeneousPoints, RationalBezier, homogeneous
from stages.geometry.numeric.bernstein import (
    Polynomial,
    Vector,
    add,
    cross,
    derivative,
    inner,
    lowered,
    multiply,
    subtract,
)
from stages.geometry.numeric.factors import common_factor, divided_by
from stages.geometry.ruled.ruled import RuledPatch


@dataclass(frozen=True, slots=True)
class Factored:
    """A vector of polynomials as factor times rest; the rest vanishes nowhere, not even in complex numbers."""

    factor: Polynomial
    rest: Vector

    @property
    def is_zero(self) -> bool:
        """Return whether the vector vanishes identically."""
        return all(f.is_zero for f in self.rest)


@dataclass(frozen=True, slots=True)
class Tangent:
    """A directrix and its tangent: A, w, d, m as above; stop: the common factor of d."""

    A: Vector
    w: Polynomial
    d: Vector
    m: Vector

    @property
    def stop(self) -> Polynomial:
        """Return the common factor of the components of d: where the speed vanishes."""
        return common_factor(self.d)


@dataclass(frozen=True, slots=True)
class Ingredients:
    """The polynomials of a patch: both tangents, P, M0, M1 (in lower case) and Delta."""

    tangents: tuple[Tangent, Tangent]
    ruling: Factored
    normals: tuple[Factored, Factored]
    delta: Polynomial


def ingredients(patch: RuledPatch) -> Ingredients:
    """Return the polynomials of a patch whose directrices are exact."""
    a, b = (_tangent(_points(curve)) for curve in (patch.c0, patch.c1))
    ruling = subtract(_scaled(b.A, a.w), _scaled(a.A, b.w))
    m0 = subtract(cross(b.A, a.d), _scaled(a.m, b.w))
    m1 = subtract(_scaled(b.m, a.w), cross(a.A, b.d))
    delta = add(inner(a.d, b.m), inner(b.d, a.m))
    return Ingredients((a, b), _factored(ruling), (_factored(m0), _factored(m1)), delta)


def _points(curve: object) -> HomogeneousPoints:
    if not isinstance(curve, Bezier | RationalBezier):
        raise TypeError("the exact certificate needs polynomial or rational directrices")
    return homogeneous(curve)


def _tangent(points: HomogeneousPoints) -> Tangent:
    """Return a directrix in whole numbers, its weight of degree 0 where all weights are equal."""
    scale = lcm(*(x.denominator for point in points for x in point))
    rows = [[int(x * scale) for x in point] for point in points]
    content, degree = gcd(*(x for row in rows for x in row)), len(rows) - 1
    columns = zip(*rows, strict=True)
    x, y, z, w = (Polynomial(tuple(comb(degree, i) * c // content for i, c in enumerate(row))) for row in columns)
    A, slopes = (x, y, z), (derivative(x), derivative(y), derivative(z))
    even = len({row[3] for row in rows}) == 1
    if even:
        w = Polynomial((w.scaled[0],))
    d = _scaled(slopes, w) if even else _lowered(subtract(_scaled(slopes, w), _scaled(A, derivative(w))))
    return Tangent(A, w, d, _lowered(cross(A, slopes)))


def _lowered(f: Vector) -> Vector:
    """Return a Wronskian in its own degree: the product of a curve with its derivative is one too high."""
    return tuple(lowered(component) if component.degree else component for component in f)


def _scaled(f: Vector, w: Polynomial) -> Vector:
    return tuple(multiply(component, w) for component in f)


def _factored(f: Vector) -> Factored:
    factor = common_factor(f)
    return Factored(factor, divided_by(f, factor))
