"""What can be measured of the parts of a finished job, with its nominal value, all from `report.json`.

On the blank: width, height, edges, diagonals, round holes, thickness.  On the formed part: angles, inside radii and
outside lengths of flanges of what is bent along lines across the blank, and inside radii of what is rolled.

Diagonals are given where the four corners lie on the outline.  What a kerf does to a size (`rate`, mm per mm) is known
for round holes and for a blank with four straight sides; other sizes are compared and no kerf is fitted to them.
Whether a hole is round is not in the report: the side file beside the drawing says it, by its area and its length.

Nominal values are rounded to `DIGITS` decimals, a nanometre: what a quadrature leaves of 120 is 120 on the sheet, and
a value on its limit is on its limit.

Tolerances, where the sheet gives none: ISO 2768-1 [1]_, class m, for lengths and radii by their size, for angles by the
shorter flange.  Its wider table for broken edges is not for the radii of bends.  Beyond its tables there is none, nor
for the thickness, which is the mill's.

.. [1] ISO 2768-1:1989, "General tolerances", tables 1 and 3; the values were compared with reprints of the tables of
   DIN ISO 2768-1:1991, which is the same standard.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose, pi, sqrt
from pathlib import Path
from typing import Literal

import numpy as np

from pipeline.asmade_report import Bend, Detail, Flat, PartEntry, Thickness, detail_of, report_of, round_holes
from pipeline.store import REPORT, digest, safe_names
from stages.errors import BadInputError, Problem
from stages.unroll.asmade import corner_moves, distance_rate, setback_mm

Unit = Literal["mm", "deg"]
State = Literal["blank", "formed"]

ISO_2768_M = (
    (3.0, 0.1),
    (6.0, 0.1),
    (30.0, 0.2),
    (120.0, 0.3),
    (400.0, 0.5),
    (1000.0, 0.8),
    (2000.0, 1.2),
    (4000.0, 2.0),
)
"""Sizes up to the first, mm, and their tolerance, +- mm."""
ISO_2768_LEAST = 0.5
ISO_2768_ANGLES = ((10.0, 1.0), (50.0, 0.5), (120.0, 1.0 / 3.0), (400.0, 1.0 / 6.0), (np.inf, 1.0 / 12.0))
"""Shorter legs up to the first, mm, and their tolerance, +- deg."""
ISO = "ISO 2768-1 m"

DIGITS = 6
"""Of nominal values in mm and degrees."""
SAME = 1e-9
"""Two lengths that differ by less than this share are the same: one was computed in another way."""
RIGHT_ANGLE = 90.0 * (1.0 + SAME)
"""Beyond it, in degrees, outside lengths are not measured to an apex."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """One thing to measure, nominal in mm or degrees.

    rate: by how much it grows per mm of kerf; None: not known.  tool: the inside radius it is bent to, mm.
    tolerance: None: none is known.
    """

    part: str
    what: str
    unit: Unit
    state: State
    nominal: float
    tolerance: float | None
    rate: float | None = None
    tool: float | None = None


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
    return Nominal(
        job.name, job.digest, digest(content), job.material.name, job.material.thickness_mm,
        job.dxf.helps.beam_mm if job.dxf.helps.compensated else job.process.kerf_mm, job.dxf.helps.compensated,
        tuple(part.name for part in made),
        {name: detail.thickness.k_factor for name, detail in details.items() if detail.thickness.k_factor is not None},
        {name: tuple(bend.name for bend in detail.bends if not bend.fold) for name, detail in details.items()},
        frozenset(part.name for part in made if part.flat is not None and part.flat.edges is not None),
        tuple(dimensions),
    )  # fmt: skip


# Sizes


def _dimensions(part: PartEntry, detail: Detail, circles: frozenset[str]) -> Iterator[Dimension]:
    """Yield everything that can be measured of a part, the blank first."""
    if part.flat is None:
        return
    yield from _blank(part.name, part.flat)
    for hole in part.flat.holes:
        if hole.name in circles:
            yield _length(part.name, f"hole {hole.name}", "blank", 2.0 * sqrt(hole.area / pi), rate=1.0)
    if detail.thickness.thickness_mm is not None:
        nominal = round(detail.thickness.thickness_mm, DIGITS)
        yield Dimension(part.name, "thickness", "mm", "blank", nominal, None)
    yield from _formed(part.name, part.flat, detail)


def _blank(part: str, flat: Flat) -> Iterator[Dimension]:
    """Yield width, height, edges and diagonals."""
    corners = np.array(flat.corners)
    straight = _is_straight(flat)
    moves = corner_moves(corners) if straight else np.zeros_like(corners)
    for axis, (what, size) in enumerate((("width", flat.width), ("height", flat.height))):
        low, high = int(corners[:, axis].argmin()), int(corners[:, axis].argmax())
        rate = float(moves[high, axis] - moves[low, axis]) if straight else None
        yield _length(part, what, "blank", size, rate=rate)
    for name, (i, j) in {"start": (0, 1), "c1": (1, 2), "end": (2, 3), "c0": (3, 0)}.items():
        size = (flat.edges or {}).get(name, 0.0)
        if size > SAME * flat.outline_length:
            rate = distance_rate(corners[i], corners[j], moves[i], moves[j]) if straight else None
            yield _length(part, f"edge {name}", "blank", size, rate=rate)
    for number, (i, j) in enumerate(((0, 2), (1, 3)) if straight or _has_corners(flat) else (), 1):
        rate = distance_rate(corners[i], corners[j], moves[i], moves[j]) if straight else None
        size = float(np.hypot(*(corners[i] - corners[j])))
        if size > SAME * flat.outline_length:
            yield _length(part, f"diagonal {number}", "blank", size, rate=rate)


def _is_straight(flat: Flat) -> bool:
    """Return whether the outline is the straight polygon of its four corners."""
    corners = np.array(flat.corners)
    sides = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    return bool(sides.min() > SAME * flat.outline_length) and isclose(
        float(sides.sum()), flat.outline_length, rel_tol=SAME
    )


def _has_corners(flat: Flat) -> bool:
    """Return whether the corners lie on the outline: its four edges are all of it."""
    return flat.edges is not None and isclose(sum(flat.edges.values()), flat.outline_length, rel_tol=SAME)


def _formed(part: str, flat: Flat, detail: Detail) -> Iterator[Dimension]:
    """Yield what bends and rolls leave."""
    bends = [bend for bend in detail.bends if not bend.fold]
    flanges = _flanges(flat, bends, detail.thickness)
    for number, size in enumerate(flanges, 1):
        yield _length(part, f"flange {number}", "formed", size)
    for number, bend in enumerate(bends):
        leg = min(flanges[number : number + 2], default=0.0)
        yield Dimension(
            part, f"bend {bend.name} angle", "deg", "formed", round(abs(bend.angle_deg), DIGITS), _angle_tolerance(leg)
        )
        yield from _radii(part, f"bend {bend.name} radius", bend.radius_mm, (None, None))
    for number, roll in enumerate(detail.rolls if not bends else (), 1):
        yield from _radii(part, f"roll {number} radius", roll.radius_mm, roll.tool_radius_mm)


def _radii(
    part: str, what: str, radii: tuple[float | None, float | None], tools: tuple[float | None, float | None]
) -> Iterator[Dimension]:
    """Yield the inside radii at the ends of a ruling, one where they are alike."""
    one, other = radii
    alike = one is not None and other is not None and isclose(one, other, rel_tol=SAME)
    for end, radius, tool in ((" c0", one, tools[0]), (" c1", other, tools[1]))[: 1 if alike else 2]:
        if radius is not None and radius > 0.0:
            yield _length(part, what if alike else what + end, "formed", radius, tool=tool)


def _flanges(flat: Flat, bends: Sequence[Bend], sheet: Thickness) -> list[float]:
    """Return the outside lengths of the flanges of a blank that is bent along lines across it; else none."""
    t, k = sheet.thickness_mm, sheet.k_factor
    if not bends or t is None or k is None or not _is_straight(flat):
        return []
    lines = np.array([(bend.start[1], bend.end[1]) for bend in bends])
    radii = [bend.radius_mm[0] for bend in bends]
    along = np.ptp(lines, axis=1).max() <= SAME * flat.outline_length
    if not along or None in radii or max(abs(bend.angle_deg) for bend in bends) > RIGHT_ANGLE:
        return []
    angles, inside = np.radians([abs(bend.angle_deg) for bend in bends]), np.array(radii, float)
    arcs = np.concatenate([[0.0], angles * (inside + k * t), [0.0]]) / 2.0
    setbacks = [0.0, *(setback_mm(angle, r, t) for angle, r in zip(angles, inside, strict=True)), 0.0]
    low, high = min(y for _, y in flat.corners), max(y for _, y in flat.corners)
    legs = np.diff([low, *lines.mean(axis=1), high]) - arcs[:-1] - arcs[1:]
    outside: list[float] = (legs + np.array(setbacks[:-1]) + np.array(setbacks[1:])).tolist()
    return outside if bool((legs > 0.0).all()) else []


def _length(
    part: str, what: str, state: State, size: float, *, rate: float | None = None, tool: float | None = None
) -> Dimension:
    nominal = round(size, DIGITS)
    return Dimension(
        part, what, "mm", state, nominal, length_tolerance(nominal), rate, None if tool is None else round(tool, DIGITS)
    )


def length_tolerance(size_mm: float) -> float | None:
    """Return the general tolerance of a length, +- mm; None beyond the table."""
    if size_mm < ISO_2768_LEAST:
        return None
    return next((tolerance for most, tolerance in ISO_2768_M if size_mm <= most), None)


def _angle_tolerance(leg_mm: float) -> float:
    return next(tolerance for most, tolerance in ISO_2768_ANGLES if leg_mm <= most)
