"""What helps the process and changes no part: where the cutter's middle runs, where it begins, how it comes and goes.

All of it is off by default, and concerns the files in `cut/` alone: patterns, `flat/` and the nest stay nominal.
"""

from dataclasses import dataclass
from typing import Literal

StartRule = Literal["as-drawn", "corner", "line", "left", "right", "bottom", "top"]
LeadKind = Literal["line", "arc"]


@dataclass(frozen=True, slots=True)
class Lead:
    """A way from the pierce to the contour, or off it.

    line: `length_mm` long, at `angle_deg` to the contour.  arc: of that radius, through that angle, touching it.
    """

    kind: LeadKind
    length_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Tabs:
    """Bridges that hold a part in its sheet: `count` to a contour, or one every `spacing_mm`.

    width_mm: of what is left; the gap in the contour is wider by the beam.
    holes: what falls out of holes is held too.  below_mm: only what has a side shorter than this is held; None: all.
    """

    width_mm: float
    count: int | None = None
    spacing_mm: float | None = None
    holes: bool = False
    below_mm: float | None = None


@dataclass(frozen=True, slots=True)
class Helps:
    """The helps that a job asks for.

    beam_mm: width of the cut; 0 where it is not known.
    compensated: contours are written half a beam beside the nominal ones.  mitred: their corners are not rounded.
    start: by which rule the first vertex of a contour is chosen, or at which share of its length it lies.
    """

    beam_mm: float = 0.0
    compensated: bool = False
    mitred: bool = False
    start: StartRule | float = "as-drawn"
    lead_in: Lead | None = None
    lead_out: Lead | None = None
    tabs: Tabs | None = None

    @property
    def any(self) -> bool:
        """Whether there is anything to do."""
        return self.compensated or self.begins or self.tabs is not None

    @property
    def leads(self) -> bool:
        """Whether a cut has a way in or off."""
        return self.lead_in is not None or self.lead_out is not None

    @property
    def begins(self) -> bool:
        """Whether it counts where a contour begins: a circle is then arcs from there."""
        return self.start != "as-drawn" or self.leads

    @property
    def gap_mm(self) -> float:
        """Return how long the gap of a tab is: as wide as what is left, and the beam's reach at both ends."""
        return 0.0 if self.tabs is None else self.tabs.width_mm + self.beam_mm

    @property
    def offset_mm(self) -> float:
        """Return how far beside the nominal contours they are written."""
        return self.beam_mm / 2.0 if self.compensated else 0.0
