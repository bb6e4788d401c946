"""How much of a roll a layout uses."""

from collections.abc import Mapping

from stages.geometry.paths.arcpath import bounds, transform
from stages.model.pattern import FlatPattern
from stages.model.sheet import SheetLayout


def used_length_mm(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> float:
    """Return the length of the sheet, mm; of a roll that up to its furthest part and the edge gap beyond it; exact.

    patterns: by the names of the parts.
    """
    sheet = layout.sheet
    if not sheet.is_roll:
        return sheet.width_mm
    reach = (bounds(transform(patterns[one.part].outer.path, one.motion))[2] for one in layout.placements)
    return max(reach, default=0.0) + sheet.edge_gap_mm
