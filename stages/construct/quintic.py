"""The paper's patches: G2 quintic Bezier directrices from end data, and Theorems 2.1, 2.2, 2.3 and 3.1.

End data P, T, N, k and shape parameters alpha, beta give the control points of (2.2):

    r'(0) = alpha0 T0,  r''(0) = beta0 T0 + k0 alpha0^2 N0,   and the same at v = 1.

All of it is rational, so it is computed in fractions of the decimals typed: a cylinder of Theorem 2.2 is then exactly a
cylinder.  Vectors are used as given unless the job says `normalise`.

Source: M. Hussain, M. Jabeen, H. A. Wajid, "Developable Surfaces from G2-Quintic Bezier Directrices with G2 Surface
Connection"; where it is wrong (Theorem 2.1 gives only planes, the example of Theorem 2.2 is no cylinder, the minimax
of Theorem 2.3 is no condition) the decisions in `stages/DESIGN.md` say what is done instead.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from stages.geometry.curves.curves import Bezier, ExactPoint, affine, bezier
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.quintics import QuinticCone, QuinticCylinder, QuinticPlanar, QuinticRuled
from stages.model.quinticstrip import NextPatch

Vector = tuple[Fraction, Fraction, Fraction]
ZERO: Vector = (Fraction(0), Fraction(0), Fraction(0))


@dataclass(frozen=True, slots=True)
class End:
    """One end of a directrix: point, tangent, normal, curvature, shape parameters; mm, exact."""

    P: Vector
    T: Vector
    N: Vector
    k: Fraction
    alpha: Fraction
    beta: Fraction


def vector(values: Sequence[Fraction]) -> Vector:
    """Return the three values as plain fractions."""
    return Fraction(values[0]), Fraction(values[1]), Fraction(values[2])


def combine(*terms: tuple[Fraction | int, Vector]) -> Vector:
    """Return the sum of factor times vector."""
    x, y, z = (sum((f * v[axis] for f, v in terms), Fraction(0)) for axis in range(3))
    return x, y, z


def inner(a: Vector, b: Vector) -> Fraction:
    """Return a . b."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def first_derivative(end: End) -> Vector:
    """Return r' at the end: alpha T."""
    return combine((end.alpha, end.T))


def second_derivative(end: End) -> Vector:
    """Return r'' at the end: beta T + k alpha^2 N."""
    return combine((end.beta, end.T), (end.k * end.alpha**2, end.N))


def directrix(start: End, end: End) -> Bezier:
    """Return the quintic of (2.2)."""
    first = [combine((1, start.P), (Fraction(j, 5), first_derivative(start))) for j in range(3)]
    last = [combine((1, end.P), (Fraction(-j, 5), first_derivative(end))) for j in range(3)]
    first[2] = combine((1, first[2]), (Fraction(1, 20), second_derivative(start)))
    last[2] = combine((1, last[2]), (Fraction(1, 20), second_derivative(end)))
    return bezier([*first, *last[::-1]])


def length_exact(a: Vector) -> Fraction:
    """Return |a|: exact where it is rational, else the double next to it."""
    square = inner(a, a)
    roots = isqrt(square.numerator), isqrt(square.denominator)
    if (roots[0] ** 2, roots[1] ** 2) == (square.numerator, square.denominator):
        return Fraction(*roots)
    return Fraction(float(square) ** 0.5)


def unit_exact(a: Vector) -> Vector:
    """Return a / |a|; zero vectors stay zero."""
    length = length_exact(a)
    return combine((1 / length, a)) if length else a


def ends_of(spec: QuinticRuled, suffix: str, *, normalise: bool) -> tuple[End, End]:
    """Return the two ends of one directrix of a ruled patch; suffix "" or "_hat"."""
    start, end = (_end(spec, f"{'q' if suffix else 'p'}{i}", f"{i}{suffix}", normalise=normalise) for i in "01")
    return start, end


def _end(spec: QuinticRuled | QuinticCylinder | QuinticCone, point: str, suffix: str, *, normalise: bool) -> End:
    """Return the data of one end; beta is filled in later where the kind derives it."""
    tangent, normal = vector(getattr(spec, f"t{suffix}")), vector(getattr(spec, f"n{suffix}"))
    return End(
        P=vector(getattr(spec, point)),
        T=unit_exact(tangent) if normalise else tangent,
        N=unit_exact(normal) if normalise else normal,
        k=Fraction(getattr(spec, f"k{suffix}")),
        alpha=Fraction(getattr(spec, f"alpha{suffix}") or 0),
        beta=Fraction(getattr(spec, f"beta{suffix}", None) or 0),
    )


def ruled_ends(spec: QuinticRuled, *, normalise: bool) -> tuple[tuple[End, End], tuple[End, End]]:
    """Return the ends of both directrices of (2.1), values as given."""
    return ends_of(spec, "", normalise=normalise), ends_of(spec, "_hat", normalise=normalise)


def planar_ends(spec: QuinticPlanar) -> tuple[tuple[End, End], tuple[End, End]]:
    """Return the ends that Theorem 2.1 asks for: every tangent is the unit vector from P0 to Q0, all k = 0."""
    p0, q0 = vector(spec.p0), vector(spec.q0)
    tangent = unit_exact(combine((1, q0), (-1, p0)))

    def end(name: str, suffix: str) -> End:
        alpha, beta = Fraction(getattr(spec, f"alpha{suffix}") or 0), Fraction(getattr(spec, f"beta{suffix}") or 0)
        return End(vector(getattr(spec, name)), tangent, ZERO, Fraction(0), alpha, beta)

    return (end("p0", "0"), end("p1", "1")), (end("q0", "0_hat"), end("q1", "1_hat"))


def cylinder_ends(spec: QuinticCylinder, *, normalise: bool) -> tuple[tuple[End, End], tuple[End, End]]:
    """Return the ends that Theorem 2.2 derives: beta = s alpha, Q1 = P1 + g (Q0 - P0), and the rest of a hat equal."""
    start, end = (_end(spec, f"p{i}", i, normalise=normalise) for i in "01")
    start = with_beta(start, Fraction(spec.s0 or 0) * start.alpha)
    end = with_beta(end, Fraction(spec.s1 or 0) * end.alpha)
    ruling = combine((1, vector(spec.q0)), (-1, start.P))
    return (start, end), (moved(start, ruling), moved(end, combine((Fraction(spec.g), ruling))))


def with_beta(end: End, beta: Fraction) -> End:
    """Return the end with another beta."""
    return End(end.P, end.T, end.N, end.k, end.alpha, beta)


def moved(end: End, shift: Vector) -> End:
    """Return the end at another point."""
    return End(combine((1, end.P), (1, shift)), end.T, end.N, end.k, end.alpha, end.beta)


def cone_ends(spec: QuinticCone, shape: Sequence[Fraction], *, normalise: bool) -> tuple[End, End]:
    """Return the ends of a cone's directrix with the shape parameters alpha0, alpha1, beta0, beta1."""
    start, end = (_end(spec, f"p{i}", i, normalise=normalise) for i in "01")
    return (
        End(start.P, start.T, start.N, start.k, shape[0], shape[2]),
        End(end.P, end.T, end.N, end.k, shape[1], shape[3]),
    )


def cone_over(r: Bezier, apex: ExactPoint, fraction: tuple[Fraction, Fraction]) -> RuledPatch:
    """Return the cone over r between two fractions of the way to the apex: exactly developable for any r."""
    a, b = fraction
    return RuledPatch(towards(r, apex, a), towards(r, apex, b), _scaled(r, apex, b - a))


def towards(r: Bezier, apex: ExactPoint, share: Fraction) -> Bezier:
    """Return r + share (apex - r)."""
    return _bezier(affine(r, scaling(1 - share), combine((share, apex))))


def _scaled(r: Bezier, apex: ExactPoint, share: Fraction) -> Bezier:
    """Return share (apex - r), the ruling."""
    return _bezier(affine(r, scaling(-share), combine((share, apex))))


def _bezier(curve: object) -> Bezier:
    if not isinstance(curve, Bezier):
        raise TypeError("an affine image of a Bezier curve is one")
    return curve


def scaling(factor: Fraction) -> tuple[Vector, Vector, Vector]:
    """Return the matrix factor times identity."""
    zero = Fraction(0)
    return (factor, zero, zero), (zero, factor, zero), (zero, zero, factor)


def patch_between(c0: tuple[End, End], c1: tuple[End, End]) -> RuledPatch:
    """Return the ruled patch (2.1) between two directrices (2.2)."""
    return between(directrix(*c0), directrix(*c1))


def next_end(patch: NextPatch, suffix: str, beta: Fraction, point: Vector, *, normalise: bool) -> End:
    """Return the new end of a further patch.

    Conditions (A) to (F) of Theorem 3.1 ask only that the new patch starts with the derivatives of the old one's end.
    gamma0 = alpha1, t0 = T1, mu0 = beta1, n0 = N1, k2 = k1 is the solution with unit vectors: the old end serves as
    the new start.
    """
    tangent, normal = vector(getattr(patch, f"t1{suffix}")), vector(getattr(patch, f"n1{suffix}"))
    return End(
        P=point,
        T=unit_exact(tangent) if normalise else tangent,
        N=unit_exact(normal) if normalise else normal,
        k=Fraction(getattr(patch, f"k1{suffix}")),
        alpha=Fraction(getattr(patch, f"alpha1{suffix}")),
        beta=beta,
    )
