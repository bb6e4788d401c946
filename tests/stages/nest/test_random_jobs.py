"""Random jobs: what the nest hands out passes the certifier; polygons as the second opinion, on pushed copies too."""

import numpy as np
import pytest
from numpy.random import default_rng
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, polygon, transform
from stages.model.sheet import Nesting, NestOptions, Placement, SheetLayout
from stages.nest.legal.certify import certify, passed
from stages.nest.legal.ground import accepts
from stages.nest.legal.laid import paths_of
from tests.stages.nest.randomjobs import FAILURES, REFUSALS, RandomJob, nested, random_job, read_back

COUNT = 30
CHORD_MM = 2e-3
SURE_MM = 2.0 * CHORD_MM
"""Two polygons within the chord of their contours are each off by less than this together."""


@pytest.mark.parametrize("seed", range(COUNT))
def test_a_random_job_is_certified_as_placed_and_as_read_or_refused_for_a_reason(seed: int) -> None:
    job = random_job(seed, most=2)
    outcome = nested(job)
    codes = {finding.code for finding in outcome.report.findings}
    assert not codes & FAILURES, outcome.report.findings
    if outcome.product is None:
        assert codes & REFUSALS
        return
    assert outcome.report.passed
    assert read_back(job, outcome.product) == ()
    assert shortfall_mm(job, outcome.product) <= SURE_MM
    for moved, short in moves(job, outcome.product, seed):
        metrics, findings = certify(moved, job.parts, job.stock, job.options)
        if short > SURE_MM:
            assert not passed(metrics, findings)
        elif short < -SURE_MM:
            assert passed(metrics, findings), findings


def moves(job: RandomJob, nesting: Nesting, seed: int) -> list[tuple[Nesting, float]]:
    """Return the nest with one copy pushed some way, a few times, and by how much it is then short of what is asked."""
    rng = default_rng(seed)
    found = []
    for reach in (0.05, 1.0, 30.0):
        layout = nesting.layouts[int(rng.integers(len(nesting.layouts)))]
        number = int(rng.integers(len(layout.placements)))
        one = layout.placements[number]
        motion = Rigid2(
            one.motion.x + float(rng.uniform(-reach, reach)),
            one.motion.y + float(rng.uniform(-reach, reach)),
            one.motion.angle_deg,
            one.motion.mirrored,
        )
        placements = [
            Placement(one.part, one.copy, motion) if i == number else at for i, at in enumerate(layout.placements)
        ]
        pushed = SheetLayout(layout.sheet, layout.index, tuple(placements), 0.0)
        moved = Nesting(tuple(pushed if each is layout else each for each in nesting.layouts))
        found.append((moved, shortfall_mm(job, moved)))
    return found


def shortfall_mm(job: RandomJob, nesting: Nesting) -> float:
    """Return by how much the worst distance is short of what is asked, by polygons; negative: some is left."""
    by_name = {part.part: part for part in job.parts}
    worst = -np.inf
    for layout in nesting.layouts:
        solid = [
            _polygon([transform(path, one.motion) for path in paths_of(by_name[one.part])]) for one in layout.placements
        ]
        parts = [by_name[one.part] for one in layout.placements]
        worst = max([worst, *(_short(a, b, job.options) for i, a in enumerate(solid) for b in solid[:i])])
        worst = max([worst, *(_off_sheet(one, layout) for one in solid)])
        for zone in layout.sheet.zones:
            poor = _polygon([zone.outline])
            wary = [one for one, part in zip(solid, parts, strict=True) if not accepts(part.quality, zone.quality)]
            worst = max([worst, *(_depth(one, poor) for one in wary)])
    return float(worst)


def _polygon(paths: list[ArcPath]) -> Polygon:
    rings = [polygon(path, accuracy=CHORD_MM) for path in paths]
    return Polygon(rings[0], rings[1:]).buffer(0.0)


def _short(a: Polygon, b: Polygon, options: NestOptions) -> float:
    """Return by how much two parts are nearer than the gap."""
    return options.gap_mm + _depth(a, b)


def _depth(a: Polygon, b: Polygon) -> float:
    """Return how deep two regions reach into each other, roughly; 0 if hardly, minus their distance if apart."""
    common = a.intersection(b)
    return _size(common) if common.area > 0.0 else -float(a.distance(b))


def _size(some: BaseGeometry) -> float:
    """Return the size of what should be empty; 0 if it is so thin that the chords may have made it."""
    return 0.0 if some.buffer(-SURE_MM / 2.0).is_empty else float(np.sqrt(some.area))


def _off_sheet(one: Polygon, layout: SheetLayout) -> float:
    """Return by how much a part is nearer than asked to the edge of its sheet or to a defect, or on it."""
    sheet = layout.sheet
    if sheet.outline is None:
        low_x, low_y, high_x, high_y = one.bounds
        room = min(low_x, low_y, sheet.width_mm - high_x, sheet.height_mm - high_y)
    else:
        bed = _polygon([sheet.outline])
        inside = bed.exterior.distance(one.exterior)
        room = inside if bed.contains(one) else -_size(one.difference(bed))
    on_defects = [_depth(one, _polygon([defect])) for defect in sheet.defects]
    return max([-room, *on_defects]) + sheet.edge_gap_mm
