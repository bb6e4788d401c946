"""Array types with their shapes, and the base of all values that own arrays.

The shape annotations are those of jaxtyping.  They are checked while tests run; a normal run does not load jaxtyping
at all (it would double the time to start), and there the names stand for plain `numpy.ndarray`.
"""

import dataclasses
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING or "jaxtyping" in sys.modules:
    from jaxtyping import Bool, Float64, Int64

    Values = Float64[np.ndarray, " n"]
    Points2 = Float64[np.ndarray, "n 2"]
    Points3 = Float64[np.ndarray, "n 3"]
    Vector2 = Float64[np.ndarray, "2"]
    Vector3 = Float64[np.ndarray, "3"]
    Matrix = Float64[np.ndarray, "n m"]
    Mask = Bool[np.ndarray, " n"]
    Indices = Int64[np.ndarray, " n"]
    Pairs = Int64[np.ndarray, "k 2"]
    Triples = Int64[np.ndarray, "m 3"]
else:
    Values = Points2 = Points3 = Vector2 = Vector3 = Matrix = Mask = Indices = Pairs = Triples = np.ndarray

Array = NDArray[np.float64]
"""An array of float64 whose shape the docstring gives."""

Numbers = NDArray[np.int64]
"""An array of whole numbers whose shape the docstring gives."""

EPS = float(np.finfo(np.float64).eps)
"""Spacing of the doubles at 1: 2.2e-16."""


ValueT = TypeVar("ValueT", bound="ArrayValue")
"""The value's own type; `typing.Self` is refused by the checks that run with the tests."""


@dataclass(frozen=True, slots=True, eq=False)
class ArrayValue:
    """A read-only value: its arrays are copied, made float64 (whole numbers: int64) and locked, then `check` is called.

    A pickle would drop numpy's read-only flag and skip the check, so `__reduce__` constructs the value again.
    """

    def __post_init__(self) -> None:
        # the names alone: `dataclasses.fields` takes longer than all else for values of a few numbers
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, name, _numbers(value) if value.dtype.kind == "i" else locked(value))
        self.check()

    def check(self) -> None:
        """Raise ValueError if a rule of this value is broken."""

    def replace(self: ValueT, **changes: object) -> ValueT:
        """Return a copy with some fields changed."""
        return dataclasses.replace(self, **changes)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), tuple(getattr(self, field.name) for field in dataclasses.fields(self))


def locked(values: Array) -> Array:
    """Return a read-only float64 copy."""
    copy = np.array(values, dtype=np.float64)
    copy.setflags(write=False)
    return copy


def _numbers(values: Numbers) -> Numbers:
    """Return a read-only int64 copy."""
    copy = np.array(values, dtype=np.int64)
    copy.setflags(write=False)
    return copy


def floats(values: Iterable[Fraction]) -> Array:
    """Return exact numbers as float64, each rounded once, shape (n,)."""
    return np.array([float(value) for value in values])


def float_rows(rows: Iterable[Iterable[Fraction]]) -> Array:
    """Return rows of exact numbers as float64, each rounded once, shape (n, m)."""
    return np.array([[float(value) for value in row] for row in rows])


def cross2(a: Array, b: Array) -> Array:
    """Return the z component of the cross product of plane vectors, along the last axis."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def cross3(a: Points3, b: Points3) -> Points3:
    """Return the cross products of vectors in space; half the time of numpy's, which takes any number of axes."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    product: Points3 = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
    return product


def dot(a: Array, b: Array) -> Array:
    """Return the dot product along the last axis."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


def norm(a: Array) -> Array:
    """Return the Euclidean length along the last axis."""
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", a, a)))


def diagonal(points: Array) -> float:
    """Return the diagonal of the bounding box of points, shape (n, d), in their unit."""
    return float(norm(np.ptp(points, axis=0)))


def similarities(first: Array, second: Array) -> tuple[Array, Array]:
    """Return half the size of the similarity of 2 x 2 matrices, and of their mirrored similarity, by their columns.

    Their sum and their difference are the singular values, without the cancellation of a characteristic polynomial.
    """
    (a, c), (b, d) = np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0)
    return np.asarray(np.hypot(a + d, c - b) / 2.0), np.asarray(np.hypot(a - d, c + b) / 2.0)


def unit(a: Array) -> Array:
    """Return the vectors scaled to length 1; zero vectors stay zero."""
    length = norm(a)[..., None]
    return np.divide(a, length, out=np.zeros_like(a), where=length > 0)
