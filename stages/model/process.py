"""How the sheet is cut, as far as it limits what can be cut from it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Process:
    """A way of cutting; None: not known, and what depends on it is not checked.

    min_hole_mm: the narrowest hole that is cut cleanly.  min_web_mm: the least material between two cuts.
    """

    type: str = ""
    kerf_mm: float | None = None
    min_hole_mm: float | None = None
    min_web_mm: float | None = None
