"""A strap through two inflections, and a ribbon under four normals."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import comb

from mpmath import mp, mpf

from tests import oracles
from tests.inflections import FREE, control_points, frame, rising
from tests.inflections import times as product
from tests.kinds.example import MORE, Pair, one, placed, points, unit
from tests.oracles import Space, Vec, add, cross, dot, exact, norm
from tests.parts import Table

BENDS_BACK = rising(["2/5", "3/5"])
HALF = "0.02"


def strap(size: Fraction) -> Table:
    """Return a strap through two inflections."""
    rows = control_points(FREE, BENDS_BACK, size)
    return {"kind": "strap", "centre": {"bezier": rows}, "half_width": one(HALF, size)}


def strap_pairs() -> list[list[Pair]]:
    """r -+ w (B + lambda T), T and B those of the spherical curve that r' follows to and fro."""
    r = oracles.bezier(control_points(FREE, BENDS_BACK))

    def beside(distance: mpf) -> Space:
        def position(v: mpf) -> Vec:
            T, B, lean = frame(FREE, BENDS_BACK, v)
            return add(add(r(v)[0], B, distance), T, distance * lean)

        return placed(position)

    return [[(beside(-exact(HALF)), beside(exact(HALF)))]]


BAND = [[0, 0, 0], ["0.5", "0.6", "0.3"], [4, 3, 1], [9, 3, "0.5"], [10, "0.5", "-1.5"]]
WIDTHS = "0.8", "0.5"


def band_normals() -> list[list[str]]:
    """Return normals across the curve at v = 0, 1/3, 2/3 and 1, upwards, to 20 decimals."""
    r, made = oracles.bezier(BAND), []
    for k, lean in zip(range(4), ("0.1", "0.2", "0.25", "0.3"), strict=True):
        T = unit(r(mpf(k) / 3)[1])
        side = unit(cross((mpf(0), mpf(0), mpf(1)), T))
        up = cross(T, side)
        made.append([mp.nstr(x, 20) for x in unit(add(up, side, exact(lean)))])
    return made


def ribbon(size: Fraction) -> Table:
    return {"kind": "ribbon", "curve": {"bezier": points(BAND, size)}, "normals": band_normals(),
            "widths": [one(width, size) for width in WIDTHS]}  # fmt: skip


def _across_the_band() -> tuple[Callable[[mpf], Vec], Callable[[mpf], Vec]]:
    """Return m = n |r'|^2 - (n . r') r' and m', polynomials: exact in the decimals of the normals."""
    thirds = [Fraction(k, 3) for k in range(4)]
    shares = []
    for k in range(4):
        share = [Fraction(1)]
        for j in range(4):
            share = product(share, [-thirds[j], Fraction(1)]) if j != k else share
        shares.append([c / _at(share, thirds[k]) for c in share])
    given = [[Fraction(x) for x in row] for row in band_normals()]
    n = [[sum(share[i] * row[axis] for share, row in zip(shares, given, strict=True)) for i in range(4)]
         for axis in range(3)]  # fmt: skip
    slope = [derived(powers([Fraction(str(row[axis])) for row in BAND])) for axis in range(3)]
    square, lean = _dot(slope, slope), _dot(n, slope)
    m = [_less(product(a, square), product(lean, b)) for a, b in zip(n, slope, strict=True)]
    return evaluated(m), evaluated([derived(f) for f in m])


def powers(row: Sequence[Fraction]) -> list[Fraction]:
    """Return the power coefficients of Bernstein ones."""
    n = len(row) - 1
    return [sum(((-1) ** (k - i) * comb(n, k) * comb(k, i) * row[i] for i in range(k + 1)), Fraction(0))
            for k in range(n + 1)]  # fmt: skip


def derived(f: Sequence[Fraction]) -> list[Fraction]:
    return [k * c for k, c in enumerate(f)][1:]


def _at(f: Sequence[Fraction], x: Fraction) -> Fraction:
    return sum((c * x**k for k, c in enumerate(f)), Fraction(0))


def _dot(a: Sequence[Sequence[Fraction]], b: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    products = [product(f, g) for f, g in zip(a, b, strict=True)]
    return [sum(terms, Fraction(0)) for terms in zip(*products, strict=True)]


def _less(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    return [x - y for x, y in zip(a, b, strict=True)]


def evaluated(vector: Sequence[Sequence[Fraction]]) -> Callable[[mpf], Vec]:
    """Return a vector of polynomials as a function, its coefficients in more digits than it is asked for."""
    with mp.workdps(3 * MORE):
        rows = [[mpf(c.numerator) / c.denominator for c in reversed(f)] for f in vector]

    def value(v: mpf) -> Vec:
        totals = [mpf(0)] * 3
        for axis, row in enumerate(rows):
            for c in row:
                totals[axis] = totals[axis] * v + c
        return totals[0], totals[1], totals[2]

    return value


def ribbon_pairs() -> list[list[Pair]]:
    """The not-a-knot spline through four normals is the cubic through them; rulings m x m' for m across the curve."""
    r, (across, turning) = oracles.bezier(BAND), _across_the_band()

    def beside(distance: mpf) -> Space:
        def position(v: mpf) -> Vec:
            at, slope, _ = r(v)
            m = across(v)
            ruling, side = cross(m, turning(v)), cross(m, slope)
            return add(at, ruling, distance * norm(side) / dot(ruling, side))

        return placed(position)

    left, right = (exact(width) for width in WIDTHS)
    return [[(beside(left), beside(-right))]]
