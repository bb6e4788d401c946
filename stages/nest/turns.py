"""By which angles a part may be turned on a sheet.

A part has a list of angles, or an axis that goes along the grain of the sheet within a band, or both, or neither.  What
is left are spans of angles, a single angle being a span of no width.  A mirror (x to -x) takes a direction d to 180 - d
before the part is turned.
"""

from dataclasses import dataclass

from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Sheet

ANGLE_TOLERANCE_DEG = 1e-9
"""An angle counts as allowed within this: 2e-8 mm on a part of 1 m."""

TURN_DEG = 360.0
HALF_DEG = 180.0
QUARTER_DEG = 90.0


@dataclass(frozen=True, slots=True)
class Turns:
    """Allowed angles: spans (low, high) in degrees, low in [0, 360), high at least low; None: any angle."""

    spans: tuple[tuple[float, float], ...] | None

    @property
    def angles(self) -> tuple[float, ...] | None:
        """The angles, if they are single ones; None if any span has a width."""
        if self.spans is None or any(low < high for low, high in self.spans):
            return None
        return tuple(low for low, _ in self.spans)


ANY = Turns(None)


def allowed(pattern: FlatPattern, sheet: Sheet, options: NestOptions, *, mirrored: bool = False) -> Turns:
    """Return the angles by which a part may be turned on a sheet; none where list and grain contradict each other."""
    listed = _listed(pattern, options)
    if pattern.axis_deg is None or sheet.grain_deg is None or pattern.axis_band_deg >= QUARTER_DEG:
        return listed
    axis = HALF_DEG - pattern.axis_deg if mirrored else pattern.axis_deg
    along = sheet.grain_deg - axis - pattern.axis_band_deg
    width = 2.0 * pattern.axis_band_deg
    banded = Turns(tuple((low, low + width) for low in sorted((along % TURN_DEG, (along + HALF_DEG) % TURN_DEG))))
    if listed.spans is None:
        return banded
    return Turns(tuple(span for span in listed.spans if contains(banded, span[0])))


def contains(turns: Turns, angle_deg: float) -> bool:
    """Return whether an angle is allowed, up to whole turns and rounding."""
    if turns.spans is None:
        return True
    return any(
        (angle_deg - low + ANGLE_TOLERANCE_DEG) % TURN_DEG <= high - low + 2.0 * ANGLE_TOLERANCE_DEG
        for low, high in turns.spans
    )


def _listed(pattern: FlatPattern, options: NestOptions) -> Turns:
    """Return the angles of a part's own list, or of the nest's."""
    wished = options.rotations if pattern.rotations is None else pattern.rotations
    if wished is None or wished == "free":
        return ANY
    return Turns(tuple((angle, angle) for angle in dict.fromkeys(angle % TURN_DEG for angle in wished)))
