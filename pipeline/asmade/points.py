"""Points measured on formed parts against the surfaces that the job asks for.

The report holds no surface, so the job file is read again and the parts constructed; a job that is not the one of the
report, by its digest, is refused.  Points are in the part's own frame: what a wrong place of the part on the bench adds
counts as its own fault.  On request those of each copy are first moved, as a whole, to where they lie best
(`geometry.ruled.bestfit`): for machines with a frame of their own.

Ruled parts alone: not flat ones, meshes, parts that were divided, nor faces that branch.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.rows import PointReading, exact
from pipeline.asmade.sheet import point_tolerance
from pipeline.asmade.sizes import ISO
from stages.errors import BadInputError, NoSolutionError, Problem
from stages.geometry.arrays import Values

if TYPE_CHECKING:
    from pipeline.job import Job
    from stages.geometry.ruled.bestfit import BestFit
    from stages.geometry.ruled.feet import Feet
    from stages.model.sheetface import Layers
    from stages.model.surface import RuledSurface


MOTIONS = 6
"""Of a rigid part: as many points fit any surface."""
SETTLED = 0.1
"""The last step of a best fit is at most this share of what the instrument does not know."""
FEW = f"a best fit needs more than {MOTIONS}: measure more, or lay them in the part's own frame, without --best-fit"


@dataclass(frozen=True, slots=True)
class PointResult:
    """A point against its part: how far off the face that was touched, mm, along N positive, and where."""

    reading: PointReading
    off_mm: float
    u: float
    v: float
    beyond: bool
    tolerance: Fraction | None
    by: str
    passed: bool | None


@dataclass(frozen=True, slots=True)
class Cloud:
    """The points of one copy."""

    part: str
    copy: int
    points: tuple[PointResult, ...]
    fit: "BestFit | None"

    @property
    def rms_mm(self) -> float:
        """Return the root of the mean square, mm."""
        return float(np.sqrt(np.mean([one.off_mm**2 for one in self.points])))

    @property
    def worst(self) -> PointResult:
        """Return the point farthest off."""
        return max(self.points, key=lambda one: abs(one.off_mm))


def clouds(
    points: Sequence[PointReading], nominal: Nominal, job: "Job", file: str, *, fitted: bool
) -> tuple[Cloud, ...]:
    """Return all points against their parts; `BadInputError` with everything that stands against it.

    file: the sheet, for messages.  fitted: those of each copy where they lie best; raises `NoSolutionError` where that
    does not settle.
    """
    if job.digest != nominal.digest:
        hint = "give the job file that this folder was made from, with the same --set"
        raise BadInputError(Problem("the job file is not the one of this report", "job.digest", hint, file))
    groups: dict[tuple[str, int], list[PointReading]] = defaultdict(list)
    for point in points:
        groups[point.part, point.copy].append(point)
    surfaces = _surfaces(job, {part for part, _ in groups})
    hint = "points are compared with ruled parts that are one blank"
    problems = [
        Problem(f'"{part}" is no ruled surface of this job', "part", hint, file, group[0].line)
        for (part, _), group in groups.items()
        if part not in surfaces
    ]
    problems += [
        Problem(f"{len(group)} points of {part}, copy {copy}", "x", FEW, file, group[0].line)
        for (part, copy), group in groups.items()
        if fitted and len(group) <= MOTIONS
    ]
    if problems:
        raise BadInputError(*problems)
    return tuple(_cloud(surfaces[part], group, nominal, fitted=fitted) for (part, _), group in groups.items())


def _surfaces(job: "Job", names: set[str]) -> "dict[str, RuledSurface]":
    """Return the ruled surfaces of these parts, by name."""
    from stages.construct import construct
    from stages.construct.sets import parts_of
    from stages.model.surface import RuledSurface

    made = {}
    for part in job.parts:
        for piece in parts_of(part):
            surface = construct(piece, job.tolerances).product if piece.name in names else None
            if isinstance(surface, RuledSurface):
                made[piece.name] = surface
    return made


def _cloud(surface: "RuledSurface", group: Sequence[PointReading], nominal: Nominal, *, fitted: bool) -> Cloud:
    """Return the points of one copy against its surface."""
    from stages.geometry.ruled.bestfit import best_fit
    from stages.geometry.ruled.feet import exact_feet, off_faces
    from stages.geometry.ruled.strip import Strip

    strip = Strip(surface.patches, np.arange(len(surface.patches) + 1.0))
    measured, heights = np.array([one.at for one in group]), _offsets(surface, group)
    fit, feet = best_fit(strip, measured, heights) if fitted else (None, exact_feet(strip, measured))
    wanted = SETTLED * min(float(one.uncertainty) for one in group)
    if fit is not None and fit.last_step_mm > wanted:
        raise NoSolutionError(f"the best fit of {group[0].part}", reached=fit.last_step_mm, wanted=wanted, unit="mm")
    there = measured if fit is None else fit.motion.moved(measured)
    off, _ = off_faces(strip, feet, there, heights)
    first = group[0]
    return Cloud(first.part, first.copy, _results(group, feet, off, point_tolerance(nominal, first.part)), fit)


def _offsets(surface: "RuledSurface", group: Sequence[PointReading]) -> Values:
    """Return how far the faces that were touched lie from the surface as given, along N, mm."""
    there = _layers(surface)
    heights = {"given": 0.0, "plus": there.plus_mm, "minus": there.minus_mm}
    return np.array([heights[one.face] for one in group])


def _layers(surface: "RuledSurface") -> "Layers":
    """Return where the sheet lies; without thickness both faces are the surface."""
    from stages.geometry.ruled.turning import turning
    from stages.model.report import Finding
    from stages.model.sheetface import Layers, layers

    thickness = surface.part.material.thickness_mm
    if thickness is None:
        return Layers(0.0, 0.0)
    found = layers(surface.part.spec.face, turning(surface.patches), thickness)
    if isinstance(found, Finding):
        raise BadInputError(Problem(found.message, "part.face"))
    return found


def _results(
    group: Sequence[PointReading], feet: "Feet", off_mm: Values, usual: Fraction | None
) -> tuple[PointResult, ...]:
    """Return each point with its verdict."""
    made = []
    for one, place, off, beyond in zip(group, feet.place, off_mm.tolist(), feet.beyond, strict=True):
        limit, by = (one.tolerance, "sheet") if one.tolerance is not None else (usual, ISO)
        passed = None if limit is None else abs(exact(off)) <= limit
        made.append(PointResult(one, off, float(place[0]), float(place[1]), bool(beyond), limit, by, passed))
    return tuple(made)
