"""Copies against each other on one sheet: the smallest gap, and areas that two of them claim.

Contours that are apart do not cross, so one point of each contour tells whether one part lies in the other
(`region`).  Where common lines are asked for, pairs nearer than the gap are looked at again (`common`).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stages.geometry.paths.clearance import clearances
from stages.model.report import Finding
from stages.model.sheet import NestOptions
from stages.nest.legal.common import Gaps, without_common_lines
from stages.nest.legal.ground import REACH_GROWTH, REACH_MM
from stages.nest.legal.laid import Ground, Laid, Spread, fatal
from stages.nest.legal.region import GAP_TOLERANCE_MM, meeting, overlap_mm2


class Between(NamedTuple):
    """What lies between the copies on one sheet.

    gap_mm: the smallest gap, without what common lines excuse; infinite if there are no two copies.
    common_gap_mm: the smallest gap along common lines; infinite if there is none.
    """

    gap_mm: float
    common_gap_mm: float
    overlap_mm2: float
    findings: tuple[Finding, ...]


def between_copies(spread: Spread, options: NestOptions) -> Between:
    """Return the gaps and overlaps of the copies on one sheet, and what is wrong with them."""
    laid = spread.laid
    every = _pair_gaps(spread, options.gap_mm)
    asked = without_common_lines([one.region for one in laid], every, options) if options.common_line else every
    common = min((every[pair] for pair in every if asked[pair] != every[pair]), default=np.inf)
    overlaps = {
        (i, j): area
        for i, j in meeting([one.region for one in laid])
        if (area := overlap_mm2(laid[i].region, laid[j].region, every.get((i, j), options.gap_mm + REACH_MM))) > 0.0
    }
    findings = [*_too_near(spread.ground, laid, asked, options), *_overlapping(spread.ground, laid, overlaps)]
    return Between(min(asked.values(), default=np.inf), common, sum(overlaps.values(), start=0.0), tuple(findings))


def _pair_gaps(spread: Spread, gap_mm: float) -> Gaps:
    """Return the exact gaps of all pairs at least as near as asked, and of the nearest pair in any case."""
    if len(spread.laid) <= 1:
        return {}
    some, owner = spread.owned
    reach = gap_mm + REACH_MM
    while not (found := clearances(some, owner, within=reach)):
        reach *= REACH_GROWTH
    return found


def _too_near(ground: Ground, laid: Sequence[Laid], gaps: Gaps, options: NestOptions) -> list[Finding]:
    """Return the nearest two copies, if they are nearer than asked."""
    least, pair = min(((gap, pair) for pair, gap in gaps.items()), default=(np.inf, (0, 0)))
    if least >= options.gap_mm - GAP_TOLERANCE_MM:
        return []
    names = " and ".join(laid[i].name for i in pair)
    message = f"{names} on {ground.label} are {least:.6g} mm apart, asked {options.gap_mm:g} mm"
    return [fatal("gap", message, sheet=ground.name, gap_mm=least)]


def _overlapping(ground: Ground, laid: Sequence[Laid], overlaps: Gaps) -> list[Finding]:
    """Return every two copies that overlap."""
    return [
        fatal(
            "overlap",
            f"{laid[i].name} and {laid[j].name} on {ground.label} overlap by {area:.6g} mm2",
            sheet=ground.name,
            overlap_mm2=area,
        )
        for (i, j), area in overlaps.items()
    ]
