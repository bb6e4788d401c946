"""How a part is sewn: seams with their allowances, and the stitch holes along them, as a job file asks for them.

A seam is an edge of the flat pattern, or a stretch of it.  What it is sewn to is another seam, `mate`, of any part of
the job.  The pattern stays the sew line; what is cut lies outside it by the allowance.
"""

from collections.abc import Collection, Iterator, Sequence
from typing import Annotated, Literal, get_args

from msgspec import Meta, field
from msgspec.structs import replace

from stages.model.caps import MOST_FEATURES
from stages.model.curves import Table, Trouble, negatives, not_positive
from stages.model.features import NotchSpec
from stages.model.scalars import Angle, Length

Edge = Literal["c0", "c1", "start", "end", "outline"]
EDGES: tuple[Edge, ...] = get_args(Edge)
SeamName = Annotated[str, Meta(max_length=80, pattern="^[^.]*$")]


class SeamSpec(Table, frozen=True, kw_only=True):
    """An edge that is sewn: `allowance` is what the cut lies outside it, 0 for a cut edge.

    edge: c0 and c1 run with v, start and end (first and last ruling) with u; a plate, a mesh and a face have "outline",
        counter-clockwise from its beginning, and from and to as lengths along it, from beyond to: across the beginning.
    kind: closed, lapped, turned (folded over and skived), cut (no allowance: the edge itself is seen).
    mate: what it is sewn to, `part.seam`, where a seam goes by its name, without one by its edge; one that is cut more
        than once may be the mate of several.  reverse: the two run opposite ways.  max_difference: by how much their
        lengths may differ; absent: by what the accepted class of the job may be strained, `tolerance.join` at least.
    blank: on which blank of an elbow or a tee; absent: on each that has the edge.  There a mate is `part.n.seam`; one
        of the part itself is on the same blank, and gores that follow each other are mates without being told so.
    """

    edge: Edge
    allowance: Length | None = None
    kind: Literal["closed", "lapped", "turned", "cut"] = "closed"
    from_: Length | None = field(name="from", default=None)
    to: Length | None = None
    mate: Annotated[str, Meta(max_length=161)] | None = None
    reverse: bool = False
    max_difference: Length | None = None
    name: SeamName = ""
    blank: Annotated[int, Meta(ge=1)] | None = None

    @property
    def called(self) -> str:
        """Its name; without one its edge."""
        return self.name or self.edge

    @property
    def allowance_mm(self) -> float:
        """What the cut lies outside it, mm."""
        return float(self.allowance or 0)

    def troubles(self) -> Iterator[Trouble]:
        """Yield an allowance that does not go with the kind, and stretches that are none."""
        yield from negatives(self, "allowance", "to", "max_difference")
        if self.from_ is not None and self.from_ < 0:
            yield Trouble("from", f"{float(self.from_):g} mm", "may not be negative")
        if "." in self.name:
            yield Trouble(
                "name", f'"{self.name}" has a dot', 'a mate is written "part.seam": choose a name without one'
            )
        if self.kind == "cut" and self.allowance:
            yield Trouble(
                "allowance", f"{self.allowance_mm:g} mm beside a cut edge", 'leave it out, or kind = "closed"'
            )
        if self.kind != "cut" and not self.allowance:
            yield Trouble(
                "allowance", f"a {self.kind} seam without one", 'give it in units of the job, or kind = "cut"'
            )
        if (self.from_ is None) != (self.to is None):
            yield Trouble("to", "exactly one of from and to", "a stretch has both ends")
        if self.from_ is not None and self.edge != "outline":
            yield Trouble("from", f"a stretch of {self.edge}", "only an outline is sewn piece by piece")
        if self.from_ is not None and self.from_ == self.to:
            yield Trouble("to", "the same length as from", "the whole outline: leave both out")
        if self.mate is not None and "." not in self.mate:
            yield Trouble("mate", f'"{self.mate}" names no seam', 'write "part.seam", such as "gusset.c1"')
        if self.mate is None and (self.reverse or self.max_difference is not None):
            key = "reverse" if self.reverse else "max_difference"
            yield Trouble(key, "without a mate", "say what it is sewn to, or leave it out")


class StitchSpec(Table, frozen=True, kw_only=True):
    """Stitch holes along a seam at equal fractions of its length; the seam that it is sewn to gets as many.

    margin: from the sew line into the part, or with line = "cut" from the cut edge into the part.
    pitch: from hole to hole, as near as an even division gives it, or count; pitch_range: what both seams must keep.
    ends: from the ends of the seam to the first and to the last hole; absent: one pitch (half a pitch from a count).
    diameter of round holes, or length of slits at an `angle` to the seam, counter-clockwise.
    """

    seam: str
    pitch: Length | None = None
    count: Annotated[int, Meta(ge=2, le=MOST_FEATURES)] | None = None
    pitch_range: tuple[Length, Length] | None = None
    margin: Length = field(default_factory=Length)
    line: Literal["sew", "cut"] = "sew"
    ends: tuple[Length, Length] | None = None
    diameter: Length | None = None
    slit: Length | None = None
    angle: Angle = field(default_factory=Angle)
    name: Annotated[str, Meta(max_length=80)] = ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield neither or both ways to divide the seam or to make a hole, and sizes that are none."""
        yield from not_positive(self, "pitch", "diameter", "slit")
        yield from negatives(self, "margin")
        if (self.pitch is None) == (self.count is None):
            yield Trouble("pitch", "exactly one of pitch and count", "say how the seam is divided")
        if (self.diameter is None) == (self.slit is None):
            yield Trouble("diameter", "exactly one of diameter and slit", "say what is pricked")
        if self.pitch_range is not None and not 0 < self.pitch_range[0] <= self.pitch_range[1]:
            yield Trouble("pitch_range", "no range", "[least, most], both above 0")
        if self.ends is not None and min(self.ends) < 0:
            yield Trouble("ends", "before the seam begins", "lengths from 0 on")


def seam_troubles(
    seams: Sequence[SeamSpec], stitches: Sequence[StitchSpec], notches: Sequence[NotchSpec], *, sides: Sequence[Edge]
) -> Iterator[Trouble]:
    """Yield what the seams of a part break that only shows beside each other or beside its sides."""
    names = [seam.called for seam in seams]
    for i, seam in enumerate(seams):
        if seam.edge not in sides:
            yield Trouble(f"seam[{i}].edge", f'no edge "{seam.edge}" on this kind', f"one of {', '.join(sides)}")
        if seam.called in names[:i]:
            yield Trouble(f"seam[{i}].name", f'"{seam.called}" is taken', "give every seam a name of its own")
    rows = [stitch.seam for stitch in stitches]
    on = [(f"stitch[{i}]", seam) for i, seam in enumerate(rows)]
    on += [(f"notch[{i}]", notch.seam) for i, notch in enumerate(notches) if notch.seam is not None]
    for key, name in on:
        if name not in names:
            known = ", ".join(names) or "none is given"
            yield Trouble(f"{key}.seam", f'no seam "{name}" on this part', f"seams: {known}")
    for i, name in enumerate(rows):
        if name in rows[:i]:
            yield Trouble(f"stitch[{i}].seam", f'"{name}" is stitched already', "one row of holes for each seam")


def blank_troubles(part: str, count: int, seams: Sequence[SeamSpec]) -> Iterator[Trouble]:
    """Yield seams on blanks that are not there, or on all of them where only one can be sewn to something else."""
    for i, seam in enumerate(seams):
        if seam.blank is not None and seam.blank > count:
            message = "the part is one blank" if count == 1 else f"the part takes {count} blanks"
            yield Trouble(f"seam[{i}].blank", f"{seam.blank}: {message}", "leave it out, or give one that is there")
        foreign = seam.mate is not None and not seam.mate.startswith(f"{part}.")
        if count > 1 and seam.blank is None and foreign:
            yield Trouble(f"seam[{i}].blank", "missing beside a mate of another part", "say which is sewn to it")


def seams_on(
    seams: Sequence[SeamSpec], number: int, edges: Collection[str], names: tuple[str, str]
) -> tuple[SeamSpec, ...]:
    """Return the seams of a part on one of its blanks, which has these edges; names: of part and blank.

    A mate of the part itself is on the same blank.
    """
    part, blank = names
    found = (seam for seam in seams if seam.blank in (None, number) and seam.edge in edges)
    return tuple(replace(seam, blank=None, mate=_on_same(seam.mate, part, blank)) for seam in found)


def _on_same(mate: str | None, part: str, blank: str) -> str | None:
    """Return a mate by its name on a blank, if it is one of the part itself."""
    owner, _, seam = (mate or "").rpartition(".")
    return f"{blank}.{seam}" if owner == part else mate


def mate_troubles(parts: Sequence[tuple[str, Sequence[SeamSpec], int]]) -> Iterator[Trouble]:
    """Yield the mates that are not there, and two that disagree on how they run.

    parts: by name, in their order, with how many blanks each takes.
    """
    known = {f"{name}.{seam.called}": seam for name, seams, _ in parts for seam in seams}
    known |= {f"{name}.{n}.{seam.called}": seam for name, seams, count in parts for seam in seams
              for n in range(1, count + 1) if count > 1 and seam.blank in (None, n)}  # fmt: skip
    for number, (name, seams, _) in enumerate(parts):
        for i, seam in enumerate(seams):
            mine, path = f"{name}.{seam.called}", f"part[{number}].seam[{i}]"
            if seam.mate is None:
                continue
            if seam.mate == mine:
                yield Trouble(f"{path}.mate", "is sewn to itself", "name the other seam")
            elif seam.mate not in known:
                hint = f"seams: {', '.join(other for other in known if other != mine) or 'no other one'}"
                yield Trouble(f"{path}.mate", f'no seam "{seam.mate}" in this job', hint)
            elif known[seam.mate].mate == mine and known[seam.mate].reverse != seam.reverse:
                yield Trouble(f"{path}.reverse", f'"{seam.mate}" says otherwise', "the same on both, or on one of them")
