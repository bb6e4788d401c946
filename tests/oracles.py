"""Lengths, areas and flat positions at 40 digits, by other formulas than the program's.

The flat map here turns the tangent of a directrix by its geodesic curvature,  theta' = (c' x c'') . n / |c'|^2,  and
lays the ruling at the angle it has with that tangent; the program turns the rulings and never sees c''.
Antiderivatives are Chebyshev series on panels.  Divides by |c'|: not for a directrix that is an apex.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

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
    """Return the Bezier curve by de Casteljau's scheme."""
    rows = [tuple(exact(x) for x in point) for point in points]
    n = len(rows) - 1

    def value(control: list[Vec], v: mpf) -> Vec:
        while len(control) > 1:
            control = [add(a, add(b, a, -1), v) for a, b in pairwise(control)]
        return control[0]

    def slopes(control: list[Vec], degree: int) -> list[Vec]:
        made = [add(b, a, -1) for a, b in pairwise(control)]
        return [(degree * x, degree * y, degree * z) for x, y, z in made] or [(mpf(0),) * 3]

    first = slopes(rows, n)
    second = slopes(first, n - 1)
    return lambda v: (value(rows, v), value(first, v), value(second, v))


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


def fixed(vector: Sequence[object]) -> Space:
    """Return the curve that stays where it is."""
    zero = (mpf(0),) * 3
    return lambda _: (tuple(exact(x) for x in vector), zero, zero)


def length(curve: Space) -> mpf:
    """Return the length of a curve."""
    return mp.quad(lambda v: norm(curve(v)[1]), mp.linspace(0, 1, 9))


def area(c0: Space, c1: Space) -> mpf:
    """Return the area of a developable patch: the integral of (|n0| + |n1|) / 2, both normals along one direction."""

    def density(v: mpf) -> mpf:
        a, b = c0(v), c1(v)
        p = add(b[0], a[0], -1)
        return (norm(cross(p, a[1])) + norm(cross(p, b[1]))) / 2

    return mp.quad(density, mp.linspace(0, 1, 9))


def sector(directrix: Space, apex: Sequence[object]) -> mpf:
    """Return the sector angle of the cone over a directrix: the integral of |(r - A) x r'| / |r - A|^2."""
    A = tuple(exact(x) for x in apex)

    def rate(v: mpf) -> mpf:
        r, slope, _ = directrix(v)
        arm = add(r, A, -1)
        return norm(cross(arm, slope)) / dot(arm, arm)

    return mp.quad(rate, mp.linspace(0, 1, 9))


class Antiderivative:
    """The integral from 0 of a function on [0, 1], by Chebyshev series on equal panels."""

    def __init__(self, function: Callable[[mpf], mpf], panels: int = 6, degree: int = 36) -> None:
        self.panels, self.degree = panels, degree
        angles = [mp.pi * (2 * k + 1) / (2 * degree) for k in range(degree)]
        self.series: list[list[mpf]] = []
        total = mpf(0)
        for panel in range(panels):
            values = [function((panel + (1 + mp.cos(a)) / 2) / panels) for a in angles]
            c = [2 * mp.fsum(f * mp.cos(j * a) for f, a in zip(values, angles, strict=True)) / degree
                 for j in range(degree)]  # fmt: skip
            c[0] /= 2
            c += [mpf(0), mpf(0)]
            made = [mpf(0)] + [((2 * c[0] if j == 1 else c[j - 1]) - c[j + 1]) / (2 * j) for j in range(1, degree + 1)]
            made = [x / (2 * panels) for x in made]
            made[0] = total - self._sum(made, mpf(-1))
            self.series.append(made)
            total = self._sum(made, mpf(1))

    @staticmethod
    def _sum(series: list[mpf], x: mpf) -> mpf:
        b0 = b1 = mpf(0)
        for c in reversed(series[1:]):
            b0, b1 = c + 2 * x * b0 - b1, b0
        return series[0] + x * b0 - b1

    def __call__(self, v: object) -> mpf:
        place = mpf(v) * self.panels
        panel = min(int(place), self.panels - 1)
        return self._sum(self.series[panel], 2 * (place - panel) - 1)


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
