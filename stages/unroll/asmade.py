"""What measurements of made parts say of kerf, K-factor and springback: one value each, with its standard uncertainty.

Kerf.  A cut along the nominal contour leaves the part half a kerf smaller all around, and its holes larger: a size
departs from nominal by a k, a = -1 across the outline, +1 across a hole, and for a straight line between corners of the
interior angles p and q by the shares of both corners, which move by k / 2 / sin(p / 2) along their bisectors.

K-factor.  A blank of the length L is bent by theta_i to inside radii r_i into flanges whose outside lengths, from
outer apex to outer apex, are F_j.  From L = sum F - 2 sum (r + t) tan(theta / 2) + sum theta (r + K t) [1]_

    K = (L - sum F + 2 sum (r + t) tan(theta / 2) - sum theta r) / (t sum theta).

Springback.  Bent to the radius R of its middle and left at R_f, R / R_f = 4 X^3 - 3 X + 1 with X = sigma_y R / (E t)
(`stages.unroll.rolls`).  The right side falls from 2 at X = -1/2 to 0 at X = 1/2, so one X belongs to every pair of
radii with R <= 2 R_f; what is left over is sigma_y / E.  Noise may make it negative, and has to: else its mean is off.

Uncertainties are carried through by central differences of half of each: exact for what is linear.

.. [1] DIN 6935, "Kaltbiegen von Flacherzeugnissen aus Stahl", 2011: bend allowance and setback.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, tan

import numpy as np

from stages.geometry.arrays import Points2, Values, Vector2, norm

STEEPEST = 0.5
"""X at which the outer fibre just yields, and minus it: the cubic falls between them."""
MOST_RATIO = 2.0
"""Of R to R_f, at X = -1/2."""
HALVINGS = 60
"""From an interval of 1 to the last digit."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value and its standard uncertainty."""

    value: float
    uncertainty: float


@dataclass(frozen=True, slots=True)
class Folded:
    """One part as bent: sizes in mm, angles in rad."""

    blank_mm: Estimate
    thickness_mm: Estimate
    flanges_mm: tuple[Estimate, ...]
    angles_rad: tuple[Estimate, ...]
    radii_mm: tuple[Estimate, ...]


# Kerf


def corner_moves(corners: Points2) -> Points2:
    """Return by how much each corner of a polygon, counter-clockwise, moves per mm of kerf."""
    after = np.roll(corners, -1, axis=0) - corners
    along = after / norm(after)[:, None]
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    before = np.roll(outward, 1, axis=0)
    moves: Points2 = -(outward + before) / (1.0 + (outward * before).sum(axis=1))[:, None] / 2.0
    return moves


def distance_rate(one: Vector2, other: Vector2, move_one: Vector2, move_other: Vector2) -> float:
    """Return by how much the distance of two points grows per mm of kerf."""
    return float((other - one) @ (move_other - move_one) / norm(other - one))


# K-factor


def k_factor_of(part: Folded) -> Estimate:
    """Return the K-factor of one part as bent."""
    bends = len(part.angles_rad)
    given = (part.blank_mm, part.thickness_mm, *part.flanges_mm, *part.angles_rad, *part.radii_mm)
    first = len(given) - 2 * bends

    def k(values: Values) -> float:
        blank, t = float(values[0]), float(values[1])
        flanges, angles, radii = values[2:first], values[first : first + bends], values[first + bends :]
        setback = 2.0 * float(((radii + t) * np.tan(angles / 2.0)).sum())
        return (blank - float(flanges.sum()) + setback - float((angles * radii).sum())) / (t * float(angles.sum()))

    return propagated(k, given)


def setback_mm(angle_rad: float, inside_mm: float, thickness_mm: float) -> float:
    """Return the outside setback of a bend, from the end of its arc to the outer apex, mm."""
    return (inside_mm + thickness_mm) * tan(abs(angle_rad) / 2.0)


# Springback


def yield_share(tool_mm: Estimate, left_mm: Estimate, thickness_mm: float) -> Estimate:
    """Return sigma_y / E from the inside radii bent to and left.  An infinite uncertainty: they tell nothing."""
    half = thickness_mm / 2.0

    def share(values: Values) -> float:
        middle = float(values[0]) + half
        return bending_share(middle / (float(values[1]) + half)) * thickness_mm / middle

    if not 0.0 < (tool_mm.value + half) / (left_mm.value + half) < MOST_RATIO:
        return Estimate(0.0, inf)
    return propagated(share, (tool_mm, left_mm))


def bending_share(ratio: float) -> float:
    """Return X of R / R_f = 4 X^3 - 3 X + 1, by halving [-1/2, 1/2], where the cubic falls from 2 to 0."""
    low, high = -STEEPEST, STEEPEST
    for _ in range(HALVINGS):
        x = (low + high) / 2.0
        low, high = (x, high) if 4.0 * x**3 - 3.0 * x + 1.0 > ratio else (low, x)
    return (low + high) / 2.0


# Uncertainties


def propagated(formula: Callable[[Values], float], given: tuple[Estimate, ...]) -> Estimate:
    """Return a formula at some values, their uncertainties independent of each other and added as squares."""
    values = np.array([one.value for one in given])
    steps = np.diag([one.uncertainty / 2.0 for one in given])
    changes = [formula(values + step) - formula(values - step) for step in steps]
    return Estimate(formula(values), hypot(*changes))
