"""The seams of a job in groups that are sewn together, and what each group has in common: stitches and notches.

A group is a seam with its mate; more, where one that is cut several times is sewn to several.  All its seams have as
many stitches, at equal fractions of their lengths; what is asked for in mm is divided by the mean of the lengths.  A
row of stitches or a notch on one side is made on the others as well.  A row that a side has itself is made with its own
hole and margin, at the places of the row that comes first in the job.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from stages.model.features import NotchSpec, name_of
from stages.model.part import PartSpec
from stages.model.report import Finding, Metric
from stages.model.sewing import SeamSpec, StitchSpec
from stages.model.tolerances import STRAIN_LIMIT, Tolerances

if TYPE_CHECKING:
    from stages.geometry.arrays import Values
    from stages.unroll.sewing import SeamNotch
    from stages.unroll.stitches import Stitches


MOST_STITCHES = 10_000
"""In a row, as many as may be asked for by count."""


@dataclass(frozen=True, slots=True)
class Half:
    """One side of a seam: the part and its seam."""

    part: PartSpec
    seam: SeamSpec

    @property
    def name(self) -> str:
        """What a mate calls it."""
        return f"{self.part.name}.{self.seam.called}"

    @property
    def stitch(self) -> StitchSpec | None:
        """The row of stitches that the part itself asks for."""
        return next((row for row in self.part.stitch if row.seam == self.seam.called), None)


@dataclass(frozen=True, slots=True)
class Group:
    """Seams that are sewn together, in the order of the job; turned: which run against the first."""

    halves: tuple[Half, ...]
    turned: tuple[bool, ...]

    @property
    def leader(self) -> int | None:
        """The place of the first seam that asks for stitches."""
        return next((i for i, half in enumerate(self.halves) if half.stitch is not None), None)


def groups(parts: Sequence[PartSpec]) -> tuple[Group, ...]:
    """Return every seam of the parts in one group; mates that are not there are left out."""
    halves = {half.name: half for half in (Half(part, seam) for part in parts for seam in part.seam)}
    sewn: dict[str, list[tuple[str, bool]]] = {name: [] for name in halves}
    for name, half in halves.items():
        if half.seam.mate in halves:
            sewn[name].append((half.seam.mate, half.seam.reverse))
            sewn[half.seam.mate].append((name, half.seam.reverse))
    order, seen = list(halves), set[str]()
    found: list[Group] = []
    for name in order:
        if name in seen:
            continue
        turned = {name: False}
        waiting = [name]
        while waiting:
            here = waiting.pop()
            fresh = {there: turned[here] != reverse for there, reverse in sewn[here] if there not in turned}
            turned |= fresh
            waiting += fresh
        seen |= set(turned)
        members = sorted(turned, key=order.index)
        found.append(Group(tuple(halves[one] for one in members), tuple(turned[one] for one in members)))
    return tuple(found)


def unmated(halves: Sequence[Half], names: Collection[str]) -> Iterator[tuple[str, Finding]]:
    """Yield the seams whose mate has no pattern, with the name of their part; names: the seams that have one."""
    for half in halves:
        if half.seam.mate is not None and half.seam.mate not in names:
            message = f"{half.name}: {half.seam.mate}, which it is sewn to, has no pattern; the seams of a part of "
            message += 'several blanks are on those: write "part.n.seam"; of a file, give each blank one of its own'
            yield half.part.name, Finding("mate-missing", message, fatal=True)


Lengths = Mapping[str, float]
"""The lengths of sew lines by the names of their seams, `part.seam`, mm."""


def difference(half: Half, lengths: Lengths, tol: Tolerances) -> Metric:
    """Return how much a seam differs from its mate."""
    mate = str(half.seam.mate)
    one, other = lengths[mate], lengths[half.name]
    asked = half.seam.max_difference
    limit = max(tol.join_mm, STRAIN_LIMIT[tol.accept] * min(one, other)) if asked is None else float(asked)
    where: dict[str, float | int | str] = {"seam": half.name, "mate": mate}
    return Metric("seam_difference_mm", abs(other - one), "mm", "sampled", limit, where)


def too_different(metric: Metric, lengths: Lengths) -> Iterator[Finding]:
    """Yield, if a seam's sides differ by more than they may, what they measure and what to do."""
    if metric.passed or metric.where is None or metric.value is None:
        return
    seam, mate = str(metric.where["seam"]), str(metric.where["mate"])
    message = f"{seam} is {lengths[seam]:.6g} mm long and {mate}, which it is sewn to, {lengths[mate]:.6g} mm: "
    message += f"{metric.value:.4g} mm apart, allowed {metric.limit:.4g} mm; change one of them, or give max_difference"
    yield Finding("seams-differ", message, fatal=True, where=metric.where)


@dataclass(frozen=True, slots=True)
class Division:
    """The stitches of a pair: rows by the part that gets them, and what is to be said to each part."""

    rows: "tuple[tuple[str, Stitches], ...]" = ()
    findings: tuple[tuple[str, Finding], ...] = ()


def divided(group: Group, lengths: Lengths) -> Division:
    """Return the stitches of all sides of a seam, nothing for one that has none."""
    from stages.unroll.stitches import Stitches

    place = group.leader
    asked = None if place is None else group.halves[place].stitch
    if place is None or asked is None:
        return Division()
    leader, against = group.halves[place], group.turned[place]
    mean = sum(lengths[half.name] for half in group.halves) / len(group.halves)
    if asked.pitch is not None and mean > MOST_STITCHES * float(asked.pitch):
        message = f"the stitches of {leader.name}: {mean / float(asked.pitch):.3g} of them on {mean:.5g} mm"
        message += f", at most {MOST_STITCHES}; give a larger pitch"
        return Division(findings=((leader.part.name, Finding("stitch-too-many", message, fatal=True)),))
    shares = fractions(asked, mean)
    if shares is None:
        message = f"the stitches of {leader.name}: no room for two of them between the ends of {mean:.5g} mm"
        message += "; give less for ends, or a smaller pitch"
        return Division(findings=((leader.part.name, Finding("stitch-no-room", message, fatal=True)),))
    joined = tuple(_overlapping(group, asked, shares, lengths))
    if joined:
        return Division(findings=joined)
    rows: list[tuple[str, Stitches]] = []
    findings: list[tuple[str, Finding]] = []
    for half, turned in zip(group.halves, group.turned, strict=True):
        spec = half.stitch or asked
        own = shares if turned == against else (1.0 - shares)[::-1]
        name = spec.name or f"stitch-{half.seam.called}"
        rows.append((half.part.name, Stitches(name, half.seam.called, spec, own)))
        findings += [(half.part.name, found) for found in _odd_pitch(half, spec, shares, lengths[half.name])]
    return Division(tuple(rows), tuple(findings))


def fractions(spec: StitchSpec, length_mm: float) -> "Values | None":
    """Return the places of stitches as shares of a seam; None where its ends leave no room for two."""
    import numpy as np

    if spec.pitch is None and spec.count is None:
        raise ValueError("a row of stitches has a pitch or a count")
    usual = float(spec.pitch) if spec.pitch is not None else length_mm / (2.0 * (spec.count or 1))
    first, last = (usual, usual) if spec.ends is None else (float(end) for end in spec.ends)
    room = length_mm - first - last
    if room <= 0.0:
        return None
    count = spec.count or max(round(room / usual), 1) + 1
    made: Values = np.linspace(first / length_mm, 1.0 - last / length_mm, count)
    return made


def pitch_mm(shares: "Values", length_mm: float) -> float:
    """Return the distance from stitch to stitch along a seam, mm."""
    return float(shares[-1] - shares[0]) / (len(shares) - 1) * length_mm


def _overlapping(group: Group, asked: StitchSpec, shares: "Values", lengths: Lengths) -> Iterator[tuple[str, Finding]]:
    """Yield the sides on which the holes of a row run into each other: along a curve they are nearer still."""
    for half in group.halves:
        pitch, diameter = pitch_mm(shares, lengths[half.name]), (half.stitch or asked).diameter
        if diameter is not None and pitch <= float(diameter):
            message = f"{half.name}: {len(shares)} stitch holes of {float(diameter):g} mm are {pitch:.4g} mm apart and "
            message += "run into each other; give fewer stitches or a smaller diameter"
            where: dict[str, float | int | str] = {"seam": half.name, "pitch_mm": pitch}
            yield half.part.name, Finding("stitch-overlap", message, fatal=True, where=where)


def _odd_pitch(half: Half, spec: StitchSpec, shares: "Values", length_mm: float) -> Iterator[Finding]:
    """Yield a pitch outside the range that is asked for."""
    pitch = pitch_mm(shares, length_mm)
    if spec.pitch_range is None or float(spec.pitch_range[0]) <= pitch <= float(spec.pitch_range[1]):
        return
    low, high = (float(end) for end in spec.pitch_range)
    message = f"{half.name}: {len(shares)} stitches are {pitch:.4g} mm apart, asked for {low:g} to {high:g} mm"
    yield Finding("stitch-pitch", message, where={"seam": half.name, "pitch_mm": pitch})


def seam_notches(group: Group, lengths: Lengths) -> "Iterator[tuple[str, SeamNotch | Finding]]":
    """Yield the notches of a seam with the part that gets each: those of any side on all, unless it says no."""
    for i, half in enumerate(group.halves):
        for number, spec in enumerate(half.part.notch, 1):
            if spec.seam != half.seam.called:
                continue
            name, share = name_of(spec, number), _share(spec, lengths[half.name])
            if share is None:
                far = float(spec.distance or 0)
                message = f"{name}: {far:g} mm is more than {half.name} is long, {lengths[half.name]:.6g} mm"
                yield half.part.name, Finding("notch-off-edge", message, fatal=True, where={"feature": name})
            else:
                yield from _on_all(group, i, name, spec, share)


def _on_all(group: Group, own: int, name: str, spec: NotchSpec, share: float) -> "Iterator[tuple[str, SeamNotch]]":
    """Yield a notch of one side of a seam on that side, and on the others unless it says no."""
    from stages.unroll.sewing import SeamNotch

    for i, half in enumerate(group.halves):
        if i == own:
            yield half.part.name, SeamNotch(name, half.seam.called, spec, share)
        elif spec.mate:
            there = share if group.turned[i] == group.turned[own] else 1.0 - share
            full = f"{group.halves[own].part.name}.{name}"
            yield half.part.name, SeamNotch(full, half.seam.called, spec, there)


def _share(spec: NotchSpec, length_mm: float) -> float | None:
    """Return where a notch is as a share of its seam; None beyond the end."""
    if spec.fraction is not None:
        return float(spec.fraction)
    share = float(spec.distance or 0) / length_mm
    return share if share <= 1.0 else None
