"""Exact numbers with a meaning: what a job file holds after units are resolved.

A number is kept as the fraction that was typed (0.1 is 1/10, "1/3" is 1/3, "1 in" is 127/5 mm), so that a surface
that is developable in the decimals of its job file is exactly developable in the program.
"""

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Array


class Length(Fraction):
    """A length in mm."""

    __slots__ = ()


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


def floats(values: Iterable[Fraction]) -> Array:
    """Return the values as float64, each rounded once, shape (n,)."""
    return np.array([float(value) for value in values])


def is_zero(vector: Iterable[Fraction]) -> bool:
    """Return whether every component is zero."""
    return not any(vector)
