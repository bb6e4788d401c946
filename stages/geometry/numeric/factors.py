"""Common factors and roots of exact polynomials on [0, 1].

With t = v / (1 - v) the scaled Bernstein coefficients of a polynomial are the plain coefficients of one in t, and
[0, 1] becomes t >= 0 with t = infinity.  Greatest common divisors are those of the polynomials in t, by the primitive
remainder sequence [1]_; a remainder sequence modulo a prime tells first that there is none, as there nearly always is.
Factors v and 1 - v are the leading and trailing zeros; a factor v + (1 - v) = 1 lowers a degree that is too high.

Roots are isolated by the sign changes of the Bernstein coefficients, halving the interval (Descartes' rule [2]_).

.. [1] D. E. Knuth, "The Art of Computer Programming", vol. 2, 3rd ed., 4.6.1.
.. [2] A. Eigenwillig, "Real root isolation for exact and approximate polynomials using Descartes' rule of signs", 2008.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from math import gcd

from stages.geometry.numeric.bernstein import Piece, Polynomial, halves, multiply, whole

PRIME = 2**61 - 1
"""Any prime would do that is unlikely to divide a leading coefficient; this one has cheap products."""
ONE = Polynomial((1,))

Row = tuple[int, ...]
"""Coefficients of a polynomial in t, lowest first, first and last not 0."""

Interval = tuple[Fraction, Fraction]
"""Where exactly one root lies, inside or, if both are equal, there."""


def common_factor(polynomials: Iterable[Polynomial]) -> Polynomial:
    """Return the greatest common divisor of polynomials, in whole numbers without a common one; 1 if all vanish."""
    rows = [f.scaled for f in polynomials if not f.is_zero]
    if not rows:
        return ONE
    front = min(leading_zeros(row) for row in rows)
    back = min(leading_zeros(row[::-1]) for row in rows)
    shared = _common([_stripped(row) for row in rows])
    return Polynomial((0,) * front + shared + (0,) * back)


def quotient(f: Polynomial, g: Polynomial) -> Polynomial:
    """Return f / g for g without a common divisor of its coefficients; ValueError if g is not a factor of f."""
    if f.is_zero:
        return Polynomial((0,))
    front, back = leading_zeros(g.scaled), leading_zeros(g.scaled[::-1])
    inner = f.scaled[front : len(f.scaled) - back]
    if sum(map(abs, f.scaled)) != sum(map(abs, inner)):
        raise ValueError("not a factor")
    return Polynomial(_exact(inner, _stripped(g.scaled)), f.denominator)


def divided_by(polynomials: Iterable[Polynomial], g: Polynomial) -> tuple[Polynomial, ...]:
    """Return the quotients of several polynomials by one factor of all."""
    return tuple(polynomials) if g == ONE else tuple(quotient(f, g) for f in polynomials)


def square_free(f: Polynomial) -> dict[int, Polynomial]:
    """Return factors without repeated roots, by how often each divides f; factors v and 1 - v are left out.

    By Yun's algorithm (Knuth, exercise 4.6.2-34).
    """
    row = _primitive(_stripped(f.scaled))
    found: dict[int, Polynomial] = {}
    if len(row) == 1:
        return found
    repeated = _common([row, _slope(row)])
    rest, slope = _exact(row, repeated), _exact(_slope(row), repeated)
    order = 1
    while len(rest) > 1:
        difference = _less(slope, _slope(rest))
        factor = _common([rest, difference]) if any(difference) else rest
        if len(factor) > 1:
            found[order] = Polynomial(factor)
        rest, slope = _exact(rest, factor), _exact(difference, factor) if any(difference) else (0,)
        order += 1
    return found


def roots_inside(f: Polynomial) -> list[Interval]:
    """Return where the roots of f strictly between 0 and 1 lie, one interval each, from left to right.

    Repeated roots count once.  No interval ends at another root, and none is wider than 2**-50.
    """
    if not sign_changes(_stripped(f.scaled)):
        return []
    simple = reduce(multiply, square_free(f).values(), ONE)
    pending = [(whole(simple), Fraction(0), Fraction(1))]
    found: list[Interval] = []
    while pending:
        piece, low, high = pending.pop()
        changes = sign_changes(piece.b)
        if changes == 1 and piece.b[0] and piece.b[-1]:
            found.append(_narrowed(piece, low, high))
        elif changes:
            middle = (low + high) / 2
            left, right = halves(piece)
            if right.b[0] == 0:
                found.append((middle, middle))
            pending += [(right, middle, high), (left, low, middle)]
    return sorted(found)


NARROW = Fraction(1, 2**50)
"""A root is known to a hundredth of the spacing of places that a sampling tells apart."""


def _narrowed(piece: Piece, low: Fraction, high: Fraction) -> Interval:
    """Return a narrower interval of the only root of a piece."""
    while high - low > NARROW:
        middle = (low + high) / 2
        left, right = halves(piece)
        if right.b[0] == 0:
            return middle, middle
        piece, low, high = (left, low, middle) if (left.b[0] > 0) != (left.b[-1] > 0) else (right, middle, high)
    return low, high


def multiplicity(f: dict[int, Polynomial], root: Interval) -> int:
    """Return how often the root of an interval is one of f, given by its square-free factors; 0 if it is none.

    The interval must hold no other root of f.
    """
    low, high = root
    for order, factor in f.items():
        if (factor(low) == 0) if low == high else (factor(low) > 0) != (factor(high) > 0):
            return order
    return 0


def sign_changes(row: Sequence[int]) -> int:
    """Return how often the sign changes along a row, zeros passed over."""
    signs = [c > 0 for c in row if c]
    return sum(a != b for a, b in pairwise(signs))


# polynomials in t


def leading_zeros(row: Sequence[int]) -> int:
    """Return how many coefficients vanish before the first that does not: the order of the zero at that end."""
    return next(i for i, c in enumerate(row) if c)


def _stripped(row: Sequence[int]) -> Row:
    return tuple(row[leading_zeros(row) : len(row) - leading_zeros(row[::-1])])


def _trimmed(row: Sequence[int]) -> Row:
    """Return the row without vanishing coefficients of the highest degrees."""
    n = len(row)
    while n and not row[n - 1]:
        n -= 1
    return tuple(row[:n])


def _primitive(row: Sequence[int]) -> Row:
    content = gcd(*row)
    return tuple(c // content for c in row)


def _slope(row: Row) -> Row:
    return tuple(i * c for i, c in enumerate(row) if i) or (0,)


def _less(f: Row, g: Row) -> Row:
    n = max(len(f), len(g))
    f, g = f + (0,) * (n - len(f)), g + (0,) * (n - len(g))
    return _trimmed([a - b for a, b in zip(f, g, strict=True)]) or (0,)


def _common(rows: Sequence[Row]) -> Row:
    """Return the greatest common divisor of polynomials in t, primitive."""
    rows = sorted(rows, key=len)
    if _coprime(rows):
        return (1,)
    shared = _primitive(rows[0])
    for row in rows[1:]:
        shared = _pair(row, shared)
        if len(shared) == 1:
            return (1,)
    return shared


def _pair(f: Row, g: Row) -> Row:
    """Return the greatest common divisor of two polynomials by the primitive remainder sequence."""
    while any(g):
        f, g = g, _remainder(f, g)
    return _primitive(f)


def _remainder(f: Row, g: Row) -> Row:
    """Return a multiple of the remainder of f by g, primitive; (0,) if g divides f."""
    rest, lead = list(f), g[-1]
    while len(rest) >= len(g):
        top, place = rest[-1], len(rest) - len(g)
        rest = [c * lead for c in rest]
        for i, c in enumerate(g):
            rest[place + i] -= top * c
        rest = list(_trimmed(rest))
        if not rest:
            return (0,)
        rest = list(_primitive(rest))
    return tuple(rest)


def _coprime(rows: Sequence[Row]) -> bool:
    """Return True if the polynomials surely have no common factor: they have none modulo a prime.

    A common factor keeps its degree modulo a prime that does not divide the leading coefficient of one of them.
    """
    reduced = [[c % PRIME for c in row] for row in rows]
    if not any(row[-1] for row in reduced):
        return False
    f: list[int] = []
    for g in reduced:
        f = _pair_modulo(list(_trimmed(g)), f)
    return len(f) == 1


def _pair_modulo(f: list[int], g: list[int]) -> list[int]:
    """Return a greatest common divisor modulo the prime."""
    while g:
        inverse = pow(g[-1], -1, PRIME)
        while len(f) >= len(g):
            factor, place = f[-1] * inverse % PRIME, len(f) - len(g)
            for i, c in enumerate(g):
                f[place + i] = (f[place + i] - factor * c) % PRIME
            f = list(_trimmed(f))
        f, g = g, f
    return f


def _exact(f: Row, g: Row) -> Row:
    """Return f / g for primitive g: in whole numbers then (Gauss); ValueError if g is not a factor of f."""
    rest, places = list(f), range(len(f) - len(g), -1, -1)
    made = [0] * len(places)
    for place in places:
        made[place], over = divmod(rest[place + len(g) - 1], g[-1])
        if over:
            raise ValueError("not a factor")
        for i, c in enumerate(g):
            rest[place + i] -= made[place] * c
    if any(rest):
        raise ValueError("not a factor")
    return tuple(made)
