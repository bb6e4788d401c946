"""Exact numbers with a meaning: what a job file holds after units are resolved.

A number is kept as the fraction that was typed (0.1 is 1/10, "1/3" is 1/3, "1 in" is 127/5 mm), so that a surface
that is developable in the decimals of its job file is exactly developable in the program.
"""

from collections.abc import Iterable
from fractions import Fraction


class Length(Fraction):
    """A length in mm."""

    __slots__ = ()


class Coordinate(Length):
    """A coordinate of a point: a length in mm, unless it is one of the pure numbers u and v of a place on a surface.

    Two coordinates are u and v on a curved part, and lengths x and y on a plate; only the whole part tells.
    plain: the number as it was typed, without the unit of the job; None if it was typed with a unit of its own.
    """

    __slots__ = ("_plain",)
    _plain: Fraction | None

    @property
    def plain(self) -> Fraction | None:
        """The number as typed; the length in mm if nothing else was said."""
        return getattr(self, "_plain", Fraction(self))

    def __reduce__(self) -> tuple[object, ...]:
        return coordinate, (Fraction(self), self.plain)

    def __copy__(self) -> "Coordinate":
        return self

    def __deepcopy__(self, _memo: object) -> "Coordinate":
        return self


def coordinate(mm: Fraction, plain: Fraction | None) -> Coordinate:
    """Return the coordinate of that length, and the number it was typed as."""
    made = Coordinate(mm)
    made._plain = plain
    return made


class Curvature(Fraction):
    """A curvature in 1/mm."""

    __slots__ = ()


class Number(Fraction):
    """A number without a unit."""

    __slots__ = ()


class Angle(Fraction):
    """An angle in degrees."""

    __slots__ = ()


Point = tuple[Length, Length, Length]
"""A point or a difference of points, mm."""

Direction = tuple[Number, Number, Number]
"""A vector without unit."""


RIGHT_ANGLE, HALF_TURN, FULL_TURN = 90, 180, 360
"""Angles in degrees, whole and so exact."""


def is_zero(vector: Iterable[Fraction]) -> bool:
    """Return whether every component is zero."""
    return not any(vector)
