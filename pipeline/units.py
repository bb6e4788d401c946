"""Text and numbers of a job file -> exact lengths in mm, curvatures in 1/mm, angles in degrees: the one place of units.

A value is a number (int, or Decimal as the parsers deliver it) or a text with or without a unit of its own: "1/8 in",
"1 1/2 in", "3.5mm", "0.02 1/mm", "12 deg", "0.2 rad", "1/3".  A bare length is scaled by the unit of the job, a bare
curvature by its inverse; angles are degrees.  Everything stays a fraction: 1/8 in is 127/40 mm, not a rounding of it.
Radians alone are rounded, in the 40th digit.

Numbers that no drawing holds are refused before a fraction is made of them, since 1e999999 as a fraction would fill
the memory.  Signs of units are ASCII; feet and inches are not mixed in one text.
"""

import re
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import TypeVar

from stages.model.scalars import Angle, Coordinate, Curvature, Length, Number, coordinate

Quantity = TypeVar("Quantity", Length, Curvature, Number, Angle)
Dimension = type[Length] | type[Curvature] | type[Number] | type[Angle]

MM_PER: dict[str, Fraction] = {
    "mm": Fraction(1),
    "cm": Fraction(10),
    "m": Fraction(1000),
    "um": Fraction(1, 1000),
    "in": Fraction(127, 5),
    "ft": Fraction(1524, 5),
}
JOB_UNITS = ("mm", "cm", "m", "in")
"""What `units` of a job may be."""

SYNONYMS = {"inch": "in", "inches": "in", '"': "in", "degree": "deg", "degrees": "deg", "°": "deg", "radians": "rad"}
PI = Fraction(Decimal("3.141592653589793238462643383279502884197169399375"))
DEGREES_PER = {"deg": Fraction(1), "rad": 180 / PI}

LARGEST = 10**9
"""Nothing in mm, 1/mm, degrees or plain numbers is larger: a thousand kilometres of sheet is a slip of the keyboard."""
LEAST = Fraction(1, 10**20)
"""Nothing but 0 is smaller: what rounding leaves of a 0, as of the cosine of 90 deg, is 1e-16 of the others."""
MOST_DIGITS = 100
LEAST_EXPONENT = -400
"""Below the smallest double; the fraction still takes only some 1300 bits."""
LONGEST_TEXT = 200

_NUMBER = re.compile(
    r"(?P<sign>[+-]?)\s*"
    r"(?:(?:(?P<whole>\d+)\s+)?(?P<top>\d+)\s*/\s*(?P<bottom>\d+)|(?P<decimal>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))"
    r"\s*(?P<unit>.*)",
    re.ASCII,
)
_EXAMPLE: dict[Dimension, str] = {
    Length: 'a length such as 12.5, "12.5 mm" or "1/8 in"',
    Curvature: 'a curvature such as 0.02, "0.02 1/mm" or "1/2 1/in"',
    Number: 'a number without unit such as 0.5 or "1/3"',
    Angle: 'an angle in degrees such as 30, "30 deg" or "0.5 rad"',
}


class UnreadableError(ValueError):
    """A value that is no such quantity: what was read, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def quantity(sort: type[Quantity], value: object, unit: str = "mm") -> Quantity:
    """Return the value as a length in mm, curvature in 1/mm, angle in degrees or number; exact.

    unit: the unit of bare lengths, one of `JOB_UNITS`.  Raises `UnreadableError`.
    """
    hint = _EXAMPLE[sort]
    if isinstance(value, str):
        size, named = _parts(value, hint)
        scale = _named_scale(sort, named, hint) if named else _bare_scale(sort, unit)
    elif isinstance(value, int | float | Decimal) and not isinstance(value, bool):
        size, scale = _fraction(value, hint), _bare_scale(sort, unit)
    else:
        raise UnreadableError(f"{describe(value)} where {_EXAMPLE[sort].split(' such')[0]} belongs", hint)
    if abs(size * scale) > LARGEST:
        raise UnreadableError(f"{describe(value)} is absurdly large", f"at most 1e9 in mm, 1/mm, degrees; {hint}")
    if 0 < abs(size * scale) < LEAST:
        raise UnreadableError(f"{describe(value)} is absurdly small", f"0, or at least 1e-20; {hint}")
    return sort(size * scale)


def coordinate_of(value: object, unit: str = "mm") -> Coordinate:
    """Return the value as a coordinate: its length in mm, and the number as typed where it has no unit of its own."""
    mm = quantity(Length, value, unit)
    try:
        return coordinate(Fraction(mm), Fraction(quantity(Number, value)))
    except UnreadableError:
        return coordinate(Fraction(mm), None)


def describe(value: object) -> str:
    """Return what was read in a few words, for a message."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return f"an array of {len(value)}"
    if isinstance(value, str):
        return _short(f'"{value}"')
    if isinstance(value, int):
        return str(value) if abs(value) <= LARGEST**2 else "a whole number of very many digits"
    if isinstance(value, float | Decimal):
        return _short(str(value).replace("Infinity", "inf").replace("NaN", "nan"))
    return "nothing (null)" if value is None else f"a {type(value).__name__}"


def _short(text: str) -> str:
    limit = 60
    printable = "".join(letter if letter.isprintable() else "?" for letter in text[: limit + 1])
    return printable if len(printable) <= limit else printable[: limit - 3] + "..."


def _parts(text: str, hint: str) -> tuple[Fraction, str]:
    """Return the number and the name of the unit, as far as there is one."""
    found = _NUMBER.fullmatch(text.strip()) if len(text) <= LONGEST_TEXT else None
    if found is None:
        raise UnreadableError(f"{describe(text)} is not a number with a unit", hint)
    if found["unit"].startswith(","):
        raise UnreadableError(f"{describe(text)} has a comma in its number", f"decimals come after a point; {hint}")
    if found["decimal"]:
        size = _fraction(found["decimal"], hint)
    elif int(found["bottom"]) == 0:
        raise UnreadableError(f"{describe(text)} divides by zero", hint)
    else:
        size = int(found["whole"] or 0) + Fraction(int(found["top"]), int(found["bottom"]))
    return (-size if found["sign"] == "-" else size), found["unit"].strip()


def _fraction(number: str | float | Decimal, hint: str) -> Fraction:
    """Return the number exactly as typed, or refuse it before it grows."""
    if isinstance(number, int):
        if abs(number) > LARGEST**2:
            raise UnreadableError(f"{describe(number)} is absurdly large", hint)
        return Fraction(number)
    try:
        decimal = Decimal(number) if isinstance(number, str | Decimal) else Decimal(repr(number))
    except InvalidOperation:
        raise UnreadableError(f"{number} has an absurd exponent", hint) from None
    if not decimal.is_finite():
        raise UnreadableError(f"{describe(decimal)} is not a finite number", hint)
    _, digits, exponent = decimal.as_tuple()
    if len(digits) > MOST_DIGITS or not isinstance(exponent, int) or not LEAST_EXPONENT < exponent < MOST_DIGITS:
        raise UnreadableError(f"{describe(decimal)} has absurdly many digits or an absurd exponent", hint)
    return Fraction(decimal)


def _bare_scale(sort: Dimension, unit: str) -> Fraction:
    """Return what a number without a unit is multiplied by."""
    if sort is Length:
        return MM_PER[unit]
    return 1 / MM_PER[unit] if sort is Curvature else Fraction(1)


def _named_scale(sort: Dimension, name: str, hint: str) -> Fraction:
    """Return what a number with a unit is multiplied by; refuse a unit of another dimension."""
    plain = SYNONYMS.get(name, name)
    inverse = plain.split("/", 1)[1].strip() if re.match(r"1?\s*/", plain) else ""
    tables: dict[Dimension, Fraction | None] = {
        Length: MM_PER.get(plain),
        Curvature: 1 / MM_PER[inverse] if inverse in MM_PER else None,
        Angle: DEGREES_PER.get(plain),
        Number: None,
    }
    scale = tables[sort]
    if scale is not None:
        return scale
    known = next((_EXAMPLE[other] for other, found in tables.items() if found is not None), None)
    if known is None:
        raise UnreadableError(f'unknown unit "{_short(name)}"', hint)
    raise UnreadableError(f'the unit "{_short(name)}" is that of {known.split(" such")[0]}', hint)
