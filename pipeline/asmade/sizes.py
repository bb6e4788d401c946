"""One thing that can be measured of a part, and the general tolerance of its size.

Nominal values are rounded to `DIGITS` decimals, a nanometre: what a quadrature leaves of 120 is 120 on the sheet, and
a value on its limit is on its limit.

Tolerances, where the sheet gives none: ISO 2768-1 [1]_, class m, for lengths and radii by their size, for angles by the
shorter flange.  Its wider table for broken edges is not for the radii of bends.  Beyond its tables there is none, nor
for the thickness, which is the mill's.

.. [1] ISO 2768-1:1989, "General tolerances", tables 1 and 3; the values were compared with reprints of the tables of
   DIN ISO 2768-1:1991, which is the same standard.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

Unit = Literal["mm", "deg"]
State = Literal["blank", "formed"]

ISO_2768_M = (
    (3.0, 0.1),
    (6.0, 0.1),
    (30.0, 0.2),
    (120.0, 0.3),
    (400.0, 0.5),
    (1000.0, 0.8),
    (2000.0, 1.2),
    (4000.0, 2.0),
)
"""Sizes up to the first, mm, and their tolerance, +- mm."""
ISO_2768_LEAST = 0.5
ISO_2768_ANGLES = ((10.0, 1.0), (50.0, 0.5), (120.0, 1.0 / 3.0), (400.0, 1.0 / 6.0), (np.inf, 1.0 / 12.0))
"""Shorter legs up to the first, mm, and their tolerance, +- deg."""
ISO = "ISO 2768-1 m"

DIGITS = 6
"""Of nominal values in mm and degrees."""
SAME = 1e-9
"""Two lengths that differ by less than this share are the same: one was computed in another way."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """One thing to measure, nominal in mm or degrees.

    rate: by how much it grows per mm of kerf; None: not known.  tool: the inside radius it is bent to, mm.
    tolerance: None: none is known.
    """

    part: str
    what: str
    unit: Unit
    state: State
    nominal: float
    tolerance: float | None
    rate: float | None = None
    tool: float | None = None


def length(
    part: str, what: str, state: State, size: float, *, rate: float | None = None, tool: float | None = None
) -> Dimension:
    """Return a length, or a radius, rounded and with its tolerance."""
    nominal = round(size, DIGITS)
    return Dimension(
        part, what, "mm", state, nominal, length_tolerance(nominal), rate, None if tool is None else round(tool, DIGITS)
    )


def length_tolerance(size_mm: float) -> float | None:
    """Return the general tolerance of a length, +- mm; None beyond the table."""
    if size_mm < ISO_2768_LEAST:
        return None
    return next((tolerance for most, tolerance in ISO_2768_M if size_mm <= most), None)


def angle_tolerance(leg_mm: float) -> float:
    """Return the general tolerance of an angle by its shorter leg, +- deg."""
    return next(tolerance for most, tolerance in ISO_2768_ANGLES if leg_mm <= most)
