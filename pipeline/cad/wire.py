"""The faces of a CAD file as a text, to be read back by a process that does not trust the one that wrote it.

    written(value) -> bytes     read(bytes) -> value

The child that reads a broken file runs libraries that may be made to do anything, so what it answers is held to be
any bytes: JSON of a few named sorts of values and of nothing else.  No code comes with it: what is of a wrong type is
an error, here or where it is used.  Numbers keep every
bit: floats are written by their shortest decimals, arrays as the bytes of little-endian doubles, fractions as n/d.
"""

import json
from base64 import b64decode, b64encode
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Array
from stages.geometry.curves.curves import Bezier, Circular, RationalBezier
from stages.geometry.ruled.backwards import Backwards
from stages.model.cadface import CadBody, CadCone, CadEdge, CadFace, CadNet, CadPlane, CadSweep


@dataclass(frozen=True, slots=True)
class Unreadable:
    """Why a file cannot be read."""

    message: str


SORTS: dict[str, Callable[..., object]] = {
    sort.__name__: sort
    for sort in (
        Unreadable, CadBody, CadFace, CadEdge, CadPlane, CadSweep, CadCone, CadNet,
        Bezier, RationalBezier, Circular, Backwards,
    )
}  # fmt: skip
"""What may be made of an answer."""
DOUBLE = "<f8"
SORT, LIST, ARRAY, SHAPE, RATIO = "is a", "list", "array", "shape", "ratio"
"""Keys of the tables of an answer; the first is no name that a field can have."""


class WireError(Exception):
    """Bytes that are no answer."""


def written(value: object) -> bytes:
    """Return a value as bytes."""
    return json.dumps(_plain(value)).encode()


def read(content: bytes) -> CadBody | Unreadable:
    """Return the faces, or why there are none; `WireError` for anything else."""
    try:
        value = _made(json.loads(content))
    except (ValueError, TypeError, KeyError, RecursionError, ZeroDivisionError, OverflowError) as error:
        raise WireError(str(error)) from None
    if not isinstance(value, CadBody | Unreadable):
        raise WireError(f"a {type(value).__name__}")
    return value


def _plain(value: object) -> object:
    match value:
        case None | bool() | int() | str():
            return value
        case Fraction():
            return {RATIO: f"{value.numerator}/{value.denominator}"}
        case float() | np.integer():
            return value.item() if isinstance(value, np.generic) else value
        case tuple():
            return {LIST: [_plain(item) for item in value]}
        case np.ndarray():
            doubles = np.ascontiguousarray(value, dtype=DOUBLE)
            return {ARRAY: b64encode(doubles.tobytes()).decode(), SHAPE: list(doubles.shape)}
    sort = type(value).__name__
    if sort not in SORTS or not is_dataclass(value):
        raise ValueError(f"a {sort} is no part of an answer")
    return {SORT: sort} | {entry.name: _plain(getattr(value, entry.name)) for entry in fields(value)}


def _made(value: object) -> object:
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if not isinstance(value, dict):
        raise TypeError("an array without a sort")
    if RATIO in value:
        top, _, bottom = str(value[RATIO]).partition("/")
        return Fraction(int(top), int(bottom))
    if LIST in value:
        return tuple(_made(item) for item in value[LIST])
    if ARRAY in value:
        return _array(value)
    sort = SORTS[value[SORT]]
    return sort(**{key: _made(item) for key, item in value.items() if key != SORT})


def _array(value: dict[str, object]) -> Array:
    numbers = np.frombuffer(b64decode(str(value[ARRAY]), validate=True), dtype=DOUBLE).astype(np.float64)
    shape = value[SHAPE]
    if not isinstance(shape, list):
        raise TypeError("an array without a shape")
    made: Array = numbers.reshape([int(size) for size in shape])
    return made
