"""The rules of a nest that its list of placements decides: copies, sheets, turns, mirrors, what was fixed by hand."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import atan2, cos, degrees, radians, sin

import numpy as np

from stages.geometry.curves.rigid import Rigid2, matrix
from stages.model.pattern import FlatPattern
from stages.model.report import Finding
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.legal.laid import fatal

ANGLE_TOLERANCE_DEG = 1e-9
"""An angle counts as allowed within this: 2e-8 mm on a part of 1 m."""

HALF_TURN_DEG = 180.0


def miscounted(nesting: Nesting, patterns: Sequence[FlatPattern]) -> list[Finding]:
    """Return what is missing, there twice, or not wanted at all."""
    wanted = {(pattern.part, copy) for pattern in patterns for copy in range(1, pattern.quantity + 1)}
    there = Counter((one.part, one.copy) for layout in nesting.layouts for one in layout.placements)
    missing = [
        fatal("missing-copy", f"'{part}' copy {copy} is not placed", part=part)
        for part, copy in sorted(wanted - set(there))
    ]
    twice = [
        fatal("duplicate-copy", f"'{part}' copy {copy} is placed {count} times", part=part)
        for (part, copy), count in sorted(there.items())
        if count > 1
    ]
    odd = [
        fatal("unknown-copy", f"'{part}' copy {copy} was not asked for", part=part)
        for part, copy in sorted(set(there) - wanted)
    ]
    return missing + twice + odd


def overdrawn(nesting: Nesting, stock: Sequence[Sheet]) -> list[Finding]:
    """Return which sheets do not exist, or are used more often than there are."""
    findings = [
        fatal("unknown-sheet", f"sheet '{layout.sheet.id}' is not in the stock as it is used", sheet=layout.sheet.id)
        for layout in nesting.layouts
        if layout.sheet not in stock
    ]
    for sheet in stock:
        indices = sorted(layout.index for layout in nesting.layouts if layout.sheet.id == sheet.id)
        if indices != list(range(1, len(indices) + 1)):
            findings.append(fatal("sheet-index", f"the sheets of '{sheet.id}' are numbered {indices}", sheet=sheet.id))
        if sheet.quantity is not None and len(indices) > sheet.quantity:
            message = f"{len(indices)} sheets of '{sheet.id}' are used, there are {sheet.quantity}"
            findings.append(fatal("stock-exceeded", message, sheet=sheet.id))
    return findings


def misturned(nesting: Nesting, by_name: Mapping[str, FlatPattern], options: NestOptions) -> list[Finding]:
    """Return which copies are mirrored or turned against their limits, the grain of their sheet included."""
    return [
        finding
        for layout in nesting.layouts
        for one in layout.placements
        if one.part in by_name
        for finding in (*_mirror(one, by_name[one.part], options), *_turn(one, by_name[one.part], layout, options))
    ]


def _mirror(one: Placement, pattern: FlatPattern, options: NestOptions) -> Iterator[Finding]:
    """Yield that a copy is mirrored or not against the rule: of a pair the even copies and no others."""
    mirrored = one.motion.mirrored
    if pattern.pair and mirrored != (one.copy % 2 == 0):
        text = (
            "is mirrored, as only even copies of a pair are" if mirrored else "is not mirrored, as it must be in a pair"
        )
        yield fatal("mirrored", f"'{one.part}' copy {one.copy} {text}", part=one.part)
    if mirrored and not (pattern.pair or options.mirror):
        yield fatal("mirrored", f"'{one.part}' copy {one.copy} is mirrored", part=one.part)


def _turn(one: Placement, pattern: FlatPattern, layout: SheetLayout, options: NestOptions) -> Iterator[Finding]:
    """Yield that a copy lies in an angle that is not on its list, or too far off the grain of its sheet."""
    angle = one.motion.angle_deg
    wished = options.rotations if pattern.rotations is None else pattern.rotations
    if not (
        wished is None or wished == "free" or any(apart_deg(angle, each) <= ANGLE_TOLERANCE_DEG for each in wished)
    ):
        listed = ", ".join(f"{each:g}" for each in wished) or "none"
        message = f"'{one.part}' copy {one.copy} is turned by {angle:g} deg, allowed are {listed}"
        yield fatal("rotation", message, part=one.part, angle_deg=angle)
    off = off_grain_deg(one, pattern, layout.sheet)
    if off is not None and off > pattern.axis_band_deg + ANGLE_TOLERANCE_DEG:
        allowed = f"allowed are {pattern.axis_band_deg:g}"
        message = f"'{one.part}' copy {one.copy} lies {off:g} deg off the grain of {layout.sheet.id}, {allowed}"
        yield fatal("grain", message, part=one.part, angle_deg=off)


def off_grain_deg(one: Placement, pattern: FlatPattern, sheet: Sheet) -> float | None:
    """Return the angle between the axis of a part where it lies and the grain, either way; None if either has none."""
    if pattern.axis_deg is None or sheet.grain_deg is None:
        return None
    axis = radians(pattern.axis_deg)
    x, y = matrix(one.motion) @ np.array([cos(axis), sin(axis)])
    off = abs(degrees(atan2(y, x)) - sheet.grain_deg) % HALF_TURN_DEG
    return min(off, HALF_TURN_DEG - off)


def astray(nesting: Nesting) -> list[Finding]:
    """Return of which parts copies of one handedness lie in different angles."""
    first: dict[tuple[str, bool], Placement] = {}
    found = {}
    for one in (one for layout in nesting.layouts for one in layout.placements):
        kept = first.setdefault((one.part, one.motion.mirrored), one)
        off = apart_deg(one.motion.angle_deg, kept.motion.angle_deg)
        if off > ANGLE_TOLERANCE_DEG and one.part not in found:
            message = f"'{one.part}' copy {one.copy} is turned by {off:g} deg against copy {kept.copy}"
            found[one.part] = fatal("direction", message, part=one.part, angle_deg=off)
    return list(found.values())


def apart_deg(a_deg: float, b_deg: float) -> float:
    """Return how far two angles are apart, up to whole turns."""
    return abs((a_deg - b_deg + HALF_TURN_DEG) % (2.0 * HALF_TURN_DEG) - HALF_TURN_DEG)


def moved(nesting: Nesting, fixed: Nesting) -> list[Finding]:
    """Return which copies do not lie where they were put by hand, each sheet's all on one sheet of the same stock."""
    found = {
        (one.part, one.copy): (layout.sheet.id, layout.index, one.motion)
        for layout in nesting.layouts
        for one in layout.placements
    }
    findings = []
    for layout in fixed.layouts:
        on_sheet = [found[key][:2] for one in layout.placements if (key := (one.part, one.copy)) in found]
        common = Counter(on_sheet).most_common(1)
        for one in layout.placements:
            sheet, index, motion = found.get((one.part, one.copy), ("", 0, None))
            same = motion is not None and _motion(motion) == _motion(one.motion)
            if not same or sheet != layout.sheet.id or (sheet, index) != common[0][0]:
                message = f"'{one.part}' copy {one.copy} does not lie where it was fixed on sheet {layout.sheet.id}"
                findings.append(fatal("moved", message, part=one.part))
    return findings


def _motion(motion: Rigid2) -> tuple[float, float, float, bool]:
    """Return a motion by its numbers."""
    return motion.x, motion.y, motion.angle_deg, motion.mirrored
