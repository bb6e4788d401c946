"""What can be measured of the parts of a finished job, with its nominal value, all from `report.json`.

On the blank: width, height, edges, diagonals, round holes, thickness.  On the formed part: angles, inside radii and
outside lengths of flanges of what is bent along lines across the blank, and inside radii of what is rolled.

What is measured of a blank between its corners is what `traveller.pdf` has of it (`blank`).  Whether a hole is
round is not in the report: the side file beside the drawing says it, by its area and its length.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose, pi, sqrt
from pathlib import Path

import numpy as np

from pipeline.asmade.blank import blank_sizes, polygon
from pipeline.asmade.report import detail_of, report_of, round_holes
from pipeline.asmade.sizes import DIGITS, SAME, Dimension, angle_tolerance, length
from pipeline.report.shopentries import DetailEntry, HelpsEntry, PartEntry
from pipeline.sidelines import BendRow, Radii, Thickness
from pipeline.store import REPORT, digest, safe_names
from stages.errors import BadInputError, Problem
from stages.geometry.arrays import Points2
from stages.unroll.asmade import setback_mm

CORNERS = 4
"""Of a blank whose flanges can be told from its height and its bend lines."""
RIGHT_ANGLE = 90.0 * (1.0 + SAME)
"""Beyond it, in degrees, outside lengths are not measured to an apex."""


@dataclass(frozen=True, slots=True)
class Nominal:
    """A finished job as it is to be measured.

    kerf_mm: what the drawings were written with where they are compensated, else what the job gives.
    k_factors, bends: by part; bends: the names of those that are no folds.  ruled: parts with four edges.
    """

    job: str
    digest: str
    report_sha256: str
    material: str
    thickness_mm: float | None
    kerf_mm: float | None
    compensated: bool
    parts: tuple[str, ...]
    k_factors: dict[str, float]
    bends: dict[str, tuple[str, ...]]
    ruled: frozenset[str]
    dimensions: tuple[Dimension, ...]


def nominal_of(out: Path) -> Nominal:
    """Return what can be measured of a finished job; `BadInputError` where the folder holds none."""
    file = out / REPORT
    report, content = report_of(file)
    made = [part for part in report.parts if part.flat is not None]
    if not made:
        raise BadInputError(
            Problem("no part of this job has a flat pattern", "parts", "compare a job that was made", str(file))
        )
    files = safe_names(part.name for part in report.parts)
    details = {part.name: detail_of(part) for part in made}
    dimensions = [
        one
        for part in made
        for one in _dimensions(part, details[part.name], round_holes(out / "flat" / f"{files[part.name]}.json"))
    ]
    job = report.job
    helps = HelpsEntry() if job.dxf is None else job.dxf.helps
    kerf_mm = None if job.process is None else job.process.kerf_mm
    sheets = {name: detail.thickness for name, detail in details.items() if detail.thickness is not None}
    return Nominal(
        job.name, job.digest or "", digest(content), job.material.name, job.material.thickness_mm,
        helps.beam_mm if helps.compensated else kerf_mm, helps.compensated,
        tuple(part.name for part in made),
        {name: sheet.k_factor for name, sheet in sheets.items() if sheet.k_factor is not None},
        {name: tuple(bend.name for bend in detail.bends if not bend.fold) for name, detail in details.items()},
        frozenset(part.name for part in made if part.flat is not None and part.flat.edges is not None),
        tuple(dimensions),
    )  # fmt: skip


# Sizes


def _dimensions(part: PartEntry, detail: DetailEntry, circles: frozenset[str]) -> Iterator[Dimension]:
    """Yield everything that can be measured of a part, the blank first."""
    if part.flat is None:
        return
    yield from blank_sizes(part.name, part.flat, part.tape)
    for hole in part.flat.holes:
        if hole.name in circles:
            yield length(part.name, f"hole {hole.name}", "blank", 2.0 * sqrt(hole.area / pi), rate=1.0)
    sheet = detail.thickness
    if sheet is not None and sheet.thickness_mm > 0.0:
        yield Dimension(part.name, "thickness", "mm", "blank", round(sheet.thickness_mm, DIGITS), None)
    yield from _formed(part.name, polygon(part.flat, part.tape), detail)


def _formed(part: str, corners: Points2 | None, detail: DetailEntry) -> Iterator[Dimension]:
    """Yield what bends and rolls leave; corners: of a blank with straight sides."""
    bends = [bend for bend in detail.bends if not bend.fold]
    flanges = [] if corners is None or detail.thickness is None else _flanges(corners, bends, detail.thickness)
    for number, size in enumerate(flanges, 1):
        yield length(part, f"flange {number}", "formed", size)
    for number, bend in enumerate(bends):
        leg = min(flanges[number : number + 2], default=0.0)
        yield Dimension(
            part, f"bend {bend.name} angle", "deg", "formed", round(abs(bend.angle_deg), DIGITS), angle_tolerance(leg)
        )
        yield from _radii(part, f"bend {bend.name} radius", bend.radius_mm, (None, None))
    for number, roll in enumerate(detail.rolls if not bends else (), 1):
        yield from _radii(part, f"roll {number} radius", roll.radius_mm, roll.tool_radius_mm or (None, None))


def _radii(part: str, what: str, radii: Radii, tools: Radii) -> Iterator[Dimension]:
    """Yield the inside radii at the ends of a ruling, one where they are alike."""
    one, other = radii
    alike = one is not None and other is not None and isclose(one, other, rel_tol=SAME)
    for end, radius, tool in ((" c0", one, tools[0]), (" c1", other, tools[1]))[: 1 if alike else 2]:
        if radius is not None and radius > 0.0:
            yield length(part, what if alike else what + end, "formed", radius, tool=tool)


def _flanges(corners: Points2, bends: Sequence[BendRow], sheet: Thickness) -> list[float]:
    """Return the outside lengths of the flanges of a blank that is bent along lines across it; else none."""
    t, k = sheet.thickness_mm, sheet.k_factor
    if not bends or k is None or len(corners) != CORNERS:
        return []
    lines = np.array([(bend.start[1], bend.end[1]) for bend in bends])
    radii = [bend.radius_mm[0] for bend in bends]
    along = np.ptp(lines, axis=1).max() <= SAME * float(np.ptp(corners, axis=0).sum())
    if not along or None in radii or max(abs(bend.angle_deg) for bend in bends) > RIGHT_ANGLE:
        return []
    angles, inside = np.radians([abs(bend.angle_deg) for bend in bends]), np.array(radii, float)
    arcs = np.concatenate([[0.0], angles * (inside + k * t), [0.0]]) / 2.0
    setbacks = [0.0, *(setback_mm(angle, r, t) for angle, r in zip(angles, inside, strict=True)), 0.0]
    low, high = corners[:, 1].min(), corners[:, 1].max()
    legs = np.diff([low, *lines.mean(axis=1), high]) - arcs[:-1] - arcs[1:]
    outside: list[float] = (legs + np.array(setbacks[:-1]) + np.array(setbacks[1:])).tolist()
    return outside if bool((legs > 0.0).all()) else []
