"""How the sheet is cut, as far as it limits what can be cut from it."""

from dataclasses import dataclass

from stages.model.helps import Tabs


@dataclass(frozen=True, slots=True)
class Process:
    """A way of cutting; None: not known, and what depends on it is not checked.

    min_hole_mm: the narrowest hole that is cut cleanly.  min_web_mm: the least material between two cuts.
    refuses_narrow: what is narrower refuses the part; else it is said.
    slat_pitch_mm: from slat to slat of the table below the sheet.
    compensated: contours are written half a kerf beside the nominal ones.  tabs: what holds parts in the sheet.
    """

    type: str = ""
    kerf_mm: float | None = None
    min_hole_mm: float | None = None
    min_web_mm: float | None = None
    refuses_narrow: bool = False
    slat_pitch_mm: float | None = None
    compensated: bool = False
    tabs: Tabs | None = None
