"""What the examples of all kinds share: tables by size, and curves by their positions in 40 digits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from mpmath import mp, mpf

from tests import oracles
from tests.oracles import Space, Vec, exact, norm
from tests.parts import Table

Pair = tuple[Space, Space]
Rows = Sequence[Sequence[object]]


@dataclass(frozen=True)
class Example:
    """A table of a job file by its size, and for each blank the edges (c0, c1) of its pieces at size 1, in order.

    proved: whether its edges are polynomial or rational.
    """

    table: Callable[[Fraction], Table]
    blanks: Callable[[], list[list[Pair]]]
    proved: bool


def one(value: object, size: Fraction) -> str:
    """Return a length at a size as a job file may hold it."""
    return str(Fraction(str(value)) * size)


def point(values: Sequence[object], size: Fraction) -> list[str]:
    return [one(value, size) for value in values]


def points(rows: Rows, size: Fraction) -> list[list[str]]:
    return [point(row, size) for row in rows]


def numbers(row: Sequence[object]) -> Vec:
    x, y, z = (exact(value) for value in row)
    return x, y, z


def unit(a: Vec) -> Vec:
    length = norm(a)
    return a[0] / length, a[1] / length, a[2] / length


STEP, MORE = mpf(10) ** -20, 40


def placed(position: Callable[[mpf], Vec]) -> Space:
    """Return a curve by its positions; its derivative by a central difference in more digits, good to some 1e-38."""

    def jet(v: mpf) -> oracles.Jet:
        with mp.workdps(mp.dps + MORE):
            ahead, behind = position(v + STEP), position(v - STEP)
            slope = tuple((a - b) / (2 * STEP) for a, b in zip(ahead, behind, strict=True))
        return position(v), slope, (mpf(0),) * 3

    return jet
