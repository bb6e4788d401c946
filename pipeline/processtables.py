"""The table `[process]`: how the sheet is cut, and what helps that, all of it off unless the job asks for it.

The helps concern the drawings in `cut/` alone: what is nested, and what lies in `flat/`, is nominal.
"""

from collections.abc import Iterator
from typing import Annotated, Literal

from msgspec import Meta

from stages.model.curves import Table, Trouble, negatives, not_positive
from stages.model.helps import LeadKind, StartRule
from stages.model.scalars import Angle, Length, Number

STEEPEST_DEG, ROUNDEST_DEG = 90.0, 180.0
"""A straight lead stands at right angles to the contour at most; an arc is half a circle at most."""


class LeadTable(Table, frozen=True, kw_only=True):
    """A way of the cutter onto each contour, or off it, on its waste side, on the layer LEAD.

    kind: "line" of a `length` at an `angle` to the contour (90 if absent), or an "arc" of a `radius` that touches the
        contour and goes through an `angle` (90 if absent).
    """

    kind: LeadKind
    length: Length | None = None
    radius: Length | None = None
    angle: Angle | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield sizes that are missing, of the other kind, or no sizes."""
        yield from not_positive(self, "length", "radius", "angle")
        wanted, other = ("length", "radius") if self.kind == "line" else ("radius", "length")
        if getattr(self, wanted) is None:
            yield Trouble(wanted, "missing", f'a lead of kind "{self.kind}" has a {wanted}')
        if getattr(self, other) is not None:
            yield Trouble(other, f'of a lead of kind "{self.kind}"', f"it has a {wanted}")
        most = STEEPEST_DEG if self.kind == "line" else ROUNDEST_DEG
        if self.angle is not None and self.angle > most:
            yield Trouble("angle", f"{float(self.angle):g} deg", f"at most {most:g} deg")


class TabsTable(Table, frozen=True, kw_only=True):
    """Tabs, or micro-joints, that hold parts in the sheet.

    count: to a contour, 3 if absent; or spacing: at most so far from one to the next.
    width: of what is left between the cuts, the kerf is added to the gap; absent: by thickness and material.
    holes: what falls out of holes is held too.  below: only what has a side shorter than this is held.
    """

    count: Annotated[int, Meta(ge=1, le=100)] | None = None
    spacing: Length | None = None
    width: Length | None = None
    holes: bool = False
    below: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield sizes that are none, and two answers to one question."""
        yield from not_positive(self, "spacing", "width", "below")
        if self.count is not None and self.spacing is not None:
            yield Trouble("spacing", "beside count", "give one of count and spacing")


class ProcessTable(Table, frozen=True, kw_only=True):
    """How the sheet is cut; min_hole, min_web: narrowest hole, least material between two cuts, if not the table's.

    kerf: width of the cut.  speed: way of the cutter in a minute; pierce_time: seconds for each cut begun; both for the
        time in the cost table.
    on_narrow: whether a hole or web under its least width is warned of, or the part refused.
    slat_pitch: from slat to slat of the table below the sheet: parts that may tip up or fall are warned of.
    kerf_compensation: "none": contours are nominal, the machine offsets them; "offset": they are offset by half a kerf,
        and the layers say so.  kerf_corners: outer corners are gone around in an arc, or straight on to a point.
    start: where contours begin: as drawn, at the sharpest corner, amid the longest line, at the vertex nearest to a
        side of the sheet, or at a share of the length, from 0 to below 1.
    lead_in, lead_out: ways onto contours and off them.  tabs: what holds parts in the sheet.
    """

    type: Literal["laser", "plasma", "waterjet", "oxy-fuel", "knife", "die"] | None = None
    kerf: Length | None = None
    min_hole: Length | None = None
    min_web: Length | None = None
    speed: Length | None = None
    pierce_time: Number | None = None
    on_narrow: Literal["warn", "refuse"] = "warn"
    slat_pitch: Length | None = None
    kerf_compensation: Literal["none", "offset"] = "none"
    kerf_corners: Literal["round", "mitre"] = "round"
    start: StartRule | float = "as-drawn"
    lead_in: LeadTable | None = None
    lead_out: LeadTable | None = None
    tabs: TabsTable | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield widths and times below nothing, a cutter that stands still, and a start beyond the contour."""
        yield from negatives(self, "kerf", "min_hole", "min_web", "pierce_time")
        yield from not_positive(self, "speed", "slat_pitch")
        if isinstance(self.start, float) and not 0.0 <= self.start < 1.0:
            yield Trouble("start", f"{self.start:g}", "a share of the contour's length, from 0 to below 1, or a rule")
