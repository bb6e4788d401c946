"""Where a part bends by itself: what of a run of turning lies between flat pieces.

Steps of equal turning go over a flat piece that is no wider than they are: a strip of many narrow faces is bent as if
it were round.  A wider one parts two bends: a step over it would take half of its angle from either side of a plane,
which no press brake does.  A bend between flats that is tight for its thickness is pressed in one hit.
"""

from collections.abc import Iterator
from itertools import groupby
from math import acos, pi, radians

import numpy as np

from stages.geometry.arrays import Mask, Values
from stages.geometry.ruled.turning import FLAT, Run, is_fold, places, run_angle, runs
from stages.model.forming import BendSpec
from stages.unroll.bent import Bent, across, radii_at

PRESSED = 10.0
"""Inside radii of so many thicknesses and less are pressed in one hit, wider ones are rolled: an estimate."""

HALF_TURN = pi * (1.0 + 1e-9)
"""A hem; no hit bends any farther."""

NEAR_END = 1e-9
"""Share of a bend's turning by which its ends are looked for inside it."""


def zones(bent: Bent, run: Run, spec: BendSpec) -> Iterator[Run]:
    """Yield what of a run is divided into steps by itself."""
    wide, flat = _widths(bent, run), _is_flat(run)
    mean_mm = float(wide[~flat].sum()) / max(abs(run_angle(run)), FLAT)
    return _parted(run, flat & (wide > mean_mm * _step_rad(spec, mean_mm)))


def between_flats(bent: Bent) -> list[Run]:
    """Return the bends of a part, parted by its flat pieces however narrow; folds are none."""
    return [zone for run in runs(bent.bends) if not is_fold(run[0]) for zone in _parted(run, _is_flat(run))]


def is_pressed(bent: Bent, zone: Run) -> bool:
    """Return whether one hit makes a bend: half a turn at most, about no more than `PRESSED` thicknesses anywhere.

    None is where the thickness is not known.
    """
    at = places(bent.bends, zone, np.array([NEAR_END, 0.5, 1.0 - NEAR_END]))
    radii = [radius for pair in radii_at(bent, at) for radius in pair]
    most = PRESSED * bent.sheet.thickness_mm
    return abs(run_angle(zone)) <= HALF_TURN and all(radius is not None and radius <= most for radius in radii)


def _parted(run: Run, apart: Mask) -> Iterator[Run]:
    """Yield what is left of a run between the stretches that part it, as far as that turns."""
    for parts, group in groupby(zip(run, apart.tolist(), strict=True), key=lambda pair: pair[1]):
        zone = tuple(stretch for stretch, _ in group)
        if not parts and abs(run_angle(zone)) > FLAT:
            yield zone


def _is_flat(run: Run) -> Mask:
    return np.array([abs(stretch.angle_rad) <= FLAT for stretch in run])


def _widths(bent: Bent, run: Run) -> Values:
    """Return how wide each stretch of a run is across the rulings, at the wider end, mm."""
    ends = np.array([(stretch.piece + stretch.low, stretch.piece + stretch.high) for stretch in run])
    wide: Values = (across(bent, ends[:, 1]) - across(bent, ends[:, 0])).max(axis=1)
    return wide


def _step_rad(spec: BendSpec, radius_mm: float) -> float:
    """Return how far a step turns at most at a radius."""
    if spec.max_angle is not None:
        return radians(float(spec.max_angle))
    # a facet is off by radius (1 - cos(step / 2))
    return 2.0 * acos(max(1.0 - float(spec.facet_error or 0) / max(radius_mm, FLAT), 0.0))
