"""Lengths, areas and flat positions in numbers of 40 digits, by other formulas than the program's.

The flat map here turns the tangent of a directrix by its geodesic curvature,  theta' = (c' x c'') . n / |c'|^2,  and
lays the ruling at the angle it has with that tangent; the program turns the rulings and never sees c''.
Integrals are Chebyshev series on panels, cut off at 1e-24 of their largest value.  Divides by |c'|: not for a directrix
that is an apex.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from math import comb

from mpmath import mp, mpf

mp.dps = 40

Vec = tuple[mpf, mpf, mpf]
Jet = tuple[Vec, Vec, Vec]
Space = Callable[[mpf], Jet]
"""Position and two derivatives of a curve at v."""


def exact(value: object) -> mpf:
    """Return a number of a job file ("1/3", 0.1, 2) to 40 digits."""
    fraction = Fraction(str(value))
    return mpf(fraction.numerator) / fraction.denominator


def add(a: Vec, b: Vec, factor: object = 1) -> Vec:
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


def dot(a: Vec, b: Vec) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def norm(a: Vec) -> mpf:
    return mp.sqrt(dot(a, a))


def bezier(points: Sequence[Sequence[object]]) -> Space:
    """Return the Bezier curve through de Casteljau's scheme."""
    return bezier_of([tuple(exact(x) for x in point) for point in points])


def bezier_of(rows: list[Vec]) -> Space:
    """Return the Bezier curve of control points that are 40-digit numbers already: Horner's scheme in powers of v."""
    n = len(rows) - 1
    zero = (mpf(0),) * 3
    powers = []
    for k in range(n + 1):
        total = zero
        for i in range(k + 1):
            total = add(total, rows[i], (-1) ** (k - i) * comb(n, k) * comb(k, i))
        powers.append(total)
    orders = [powers]
    for _ in range(2):
        orders.append([tuple(k * x for x in row) for k, row in enumerate(orders[-1])][1:] or [zero])

    def horner(coefficients: list[Vec], v: mpf) -> Vec:
        total = coefficients[-1]
        for row in reversed(coefficients[:-1]):
            total = add(row, total, v)
        return total

    return lambda v: tuple(horner(coefficients, v) for coefficients in orders)


def turning(
    centre: Sequence[object], u: Sequence[object], v: Sequence[object], w: Sequence[object], sweep: mpf
) -> Space:
    """Return centre + cos(a) u + sin(a) v + a w, a = sweep t: circles, ellipses, helices."""
    C, U, V, W = (tuple(exact(x) for x in vector) for vector in (centre, u, v, w))

    def jet(t: mpf) -> Jet:
        a = sweep * t
        c, s = mp.cos(a), mp.sin(a)
        position = tuple(C[i] + c * U[i] + s * V[i] + a * W[i] for i in range(3))
        slope = tuple(sweep * (-s * U[i] + c * V[i] + W[i]) for i in range(3))
        return position, slope, tuple(-(sweep**2) * (c * U[i] + s * V[i]) for i in range(3))

    return jet


def combined(a: Space, b: Space, factor: object = 1) -> Space:
    """Return a + factor b."""
    return lambda v: tuple(add(x, y, factor) for x, y in zip(a(v), b(v), strict=True))


def rational(points: Sequence[Sequence[object]], weights: Sequence[object]) -> Space:
    """Return the rational Bezier curve, by the quotient rule."""
    weight = [exact(w) for w in weights]
    top = bezier_of([tuple(w * exact(x) for x in point) for point, w in zip(points, weight, strict=True)])
    bottom = bezier_of([(w, mpf(0), mpf(0)) for w in weight])

    def jet(v: mpf) -> Jet:
        (a, a1, a2), ((w, *_), (w1, *_), (w2, *_)) = top(v), bottom(v)
        r = tuple(x / w for x in a)
        r1 = tuple((y - w1 * x) / w for x, y in zip(r, a1, strict=True))
        r2 = tuple((z - 2 * w1 * y - w2 * x) / w for x, y, z in zip(r, r1, a2, strict=True))
        return r, r1, r2

    return jet


def toward(curve: Space, apex: Sequence[object], fraction: object) -> Space:
    """Return the curve brought a fraction of the way to a point: the other edge of a cone."""
    A, rest = tuple(exact(x) for x in apex), 1 - exact(fraction)

    def jet(v: mpf) -> Jet:
        r, r1, r2 = curve(v)
        return (
            tuple(a + rest * (x - a) for a, x in zip(A, r, strict=True)),
            tuple(rest * x for x in r1),
            tuple(rest * x for x in r2),
        )

    return jet


def fixed(vector: Sequence[object]) -> Space:
    """Return the curve that stays where it is."""
    zero = (mpf(0),) * 3
    return lambda _: (tuple(exact(x) for x in vector), zero, zero)


def length(curve: Space) -> mpf:
    """Return the length of a curve."""
    return Antiderivative(lambda v: norm(curve(v)[1]))(1)


def area(c0: Space, c1: Space) -> mpf:
    """Return the area of a developable patch: the integral of (|n0| + |n1|) / 2, both normals along one direction."""

    def density(v: mpf) -> mpf:
        a, b = c0(v), c1(v)
        p = add(b[0], a[0], -1)
        return (norm(cross(p, a[1])) + norm(cross(p, b[1]))) / 2

    return Antiderivative(density)(1)


def sector(directrix: Space, apex: Sequence[object]) -> mpf:
    """Return the sector angle of the cone over a directrix: the integral of |(r - A) x r'| / |r - A|^2."""
    A = tuple(exact(x) for x in apex)

    def rate(v: mpf) -> mpf:
        r, slope, _ = directrix(v)
        arm = add(r, A, -1)
        return norm(cross(arm, slope)) / dot(arm, arm)

    return Antiderivative(rate)(1)


DEGREE = 32
CUT_OFF = mpf(10) ** -24


@cache
def cosines() -> tuple[list[mpf], list[list[mpf]]]:
    """Return the Chebyshev nodes of [-1, 1] and the rows from values there to the coefficients of their series."""
    angles = [mp.pi * (2 * k + 1) / (2 * DEGREE) for k in range(DEGREE)]
    rows = [[mp.cos(j * a) * (1 if j == 0 else 2) / DEGREE for a in angles] for j in range(DEGREE)]
    return [mp.cos(a) for a in angles], rows


class Antiderivative:
    """The integral from 0 of a function on [0, 1], by Chebyshev series on panels that are halved until they resolve."""

    def __init__(self, function: Callable[[mpf], mpf]) -> None:
        self.breaks, self.series, total = [mpf(0)], [], mpf(0)
        scale = max(abs(function(mpf(2 * k + 1) / 14)) for k in range(7))
        pending = [(mpf(k) / 4, mpf(k + 1) / 4) for k in (3, 2, 1, 0)]
        nodes, rows = cosines()
        while pending:
            a, b = pending.pop()
            values = [function((a + b + x * (b - a)) / 2) for x in nodes]
            c = [mp.fdot(row, values) for row in rows]
            if max(map(abs, c[-3:])) * (b - a) > CUT_OFF * scale:
                pending += [((a + b) / 2, b), (a, (a + b) / 2)]
                continue
            c += [mpf(0), mpf(0)]
            made = [mpf(0)] + [((2 * c[0] if j == 1 else c[j - 1]) - c[j + 1]) / (2 * j) for j in range(1, DEGREE + 1)]
            made = [x * (b - a) / 2 for x in made]
            made[0] = total - self._sum(made, mpf(-1))
            self.series.append(made)
            self.breaks.append(b)
            total = self._sum(made, mpf(1))

    @staticmethod
    def _sum(series: list[mpf], x: mpf) -> mpf:
        b0 = b1 = mpf(0)
        for c in reversed(series[1:]):
            b0, b1 = c + 2 * x * b0 - b1, b0
        return series[0] + x * b0 - b1

    def __call__(self, v: object) -> mpf:
        v = mpf(v)
        panel = min(max(bisect_right(self.breaks, v) - 1, 0), len(self.series) - 1)
        a, b = self.breaks[panel], self.breaks[panel + 1]
        return self._sum(self.series[panel], (2 * v - a - b) / (b - a))


def flat_map(c0: Space, c1: Space) -> Callable[[object, object], tuple[mpf, mpf]]:
    """Return the flat position of S(u, v): c0(0) at the origin, the first ruling along +x, c0 leaving upwards."""
    start = c0(mpf(0))
    p = add(c1(mpf(0))[0], start[0], -1)
    sense = cross(p, start[1])

    def rate(v: mpf) -> mpf:
        position, slope, bend = c0(v)
        ruling = add(c1(v)[0], position, -1)
        normal = cross(ruling, slope)
        return dot(cross(slope, bend), normal) / (norm(normal) * dot(slope, slope))

    def between(v: mpf) -> mpf:
        """The angle from the ruling to the tangent, counter-clockwise."""
        position, slope, _ = c0(v)
        ruling = add(c1(v)[0], position, -1)
        return mp.atan2(norm(cross(ruling, slope)), dot(ruling, slope))

    assert norm(sense) > 0
    theta = Antiderivative(rate)
    begin = between(mpf(0))
    x, y = (
        Antiderivative(lambda v, f=f: norm(c0(v)[1]) * f(theta(v) + begin)) for f in (mp.cos, mp.sin)
    )  # fmt: skip

    def position(u: object, v: object) -> tuple[mpf, mpf]:
        v = mpf(v)
        ruling = add(c1(v)[0], c0(v)[0], -1)
        phi = theta(v) + begin - between(v)
        reach = mpf(u) * norm(ruling)
        return x(v) + reach * mp.cos(phi), y(v) + reach * mp.sin(phi)

    return position
