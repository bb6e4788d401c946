"""Bend lines for a part that is bent in steps, at equal turning of the normal.

What bends one way by itself (`zones`), by theta, is divided into N = ceil(theta / delta) steps of theta / N, so that
the hits add up to the part's own angle; each hit lies in the middle of its step, between two flat facets [1]_.  On a
cone or any other developable, equal spacing would not do: the hits follow the rulings.  A facet is off the surface by
rho (1 - cos(delta / 2)), rho the mean radius over its step at the wider end.  Folds between patches are hits of their
own, with their own angle and the smallest radius of the material; they are drawn on every part that has them, asked for
or not, and so are tight bends between flat faces.

The flat frame is seen from the side of N = p x c0'.  A bend towards the viewer is `up` (BEND_UP), away from the viewer
`down` (BEND_DOWN).  Radii in the table are inside radii, at the c0 end and at the c1 end of the line.

.. [1] MetalForming magazine (metalformingmagazine.com), "Step bending": hits, pitch and the width of the die.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, zip_longest
from math import ceil, cos, degrees
from typing import Literal

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Points2, Values, cross2, norm
from stages.geometry.flat.flatmap import Development
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.ruled.turning import MOST_TURNS, Run, chord_turning, equal_turns, is_fold, places, run_angle, runs
from stages.model.forming import BendSpec
from stages.model.pattern import Mark
from stages.model.report import Finding, Metric
from stages.model.surface import RuledSurface
from stages.unroll.bent import Bent, across, radii_at
from stages.unroll.zones import between_flats, is_pressed, zones

ANGLE_LIMIT_DEG = 0.1
"""How far the sum of the hits may be from the turning of the surface: no press brake holds more."""


@dataclass(frozen=True, slots=True, eq=False)
class BendLine:
    """One hit: its name, the place of its ruling (over the given patches), signed angle, and how far its facet is off.

    radius_mm: inside radius at the c0 end and at the c1 end; None where it is not known.
    reach_mm: distance of the line from the first ruling, across the rulings of the neutral surface, at c0 and at c1.
    ends: of the line in the flat frame, shape (2, 2), from c0 to c1.
    """

    name: str
    place: float
    angle_rad: float
    fold: bool
    facet_mm: float
    radius_mm: list[float | None]
    reach_mm: Values
    ends: Points2

    @property
    def side(self) -> Literal["up", "down"]:
        """Return the way it bends, seen in the flat frame."""
        return "up" if self.angle_rad > 0.0 else "down"


@dataclass(frozen=True, slots=True)
class Forming:
    """Bend lines as marks, their table, and what was measured of them."""

    marks: tuple[Mark, ...] = ()
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    rows: tuple[dict[str, object], ...] = ()


def formed(bent: Bent, neutral: RuledSurface, development: Development, spec: BendSpec) -> Forming:
    """Return the bend lines of a part on the development of its neutral surface.

    Raises NoSolutionError where no `MOST_TURNS` hits keep the angle or the facet error asked for.
    """
    lines = bend_lines(bent, neutral, development, spec)
    marks = tuple(_mark(line) for line in lines)
    rows = tuple(_row(bent, line, following) for line, following in zip_longest(lines, lines[1:]))
    return Forming(marks, _metrics(bent, lines), tuple(_crossings(bent, lines)), rows)


def folded(bent: Bent, neutral: RuledSurface, development: Development) -> Forming:
    """Return the folds between patches as bend lines, for a part without bend lines of its own."""
    lines = _lines(bent, neutral, development, folds_of(bent), FOLD_NAME)
    return Forming(tuple(_mark(line) for line in lines), (), (), tuple(_row(bent, line, None) for line in lines))


def standing(bent: Bent, neutral: RuledSurface, development: Development) -> Forming:
    """Return the bends between flat faces, one hit each, and the folds, for a part without bend lines of its own.

    The table says what of the part is not rolled; its angles are added up where that is all of it.
    """
    every = between_flats(bent)
    bends = [zone for zone in every if is_pressed(bent, zone)]
    if not bends:
        return folded(bent, neutral, development)
    hits = [_in_one(bent, zone) for zone in bends]
    lines = [
        *_lines(bent, neutral, development, hits, BEND_NAME),
        *_lines(bent, neutral, development, folds_of(bent), FOLD_NAME),
    ]
    lines.sort(key=lambda line: line.place)
    metrics = _metrics(bent, lines) if len(bends) == len(every) else ()
    rows = tuple(_row(bent, line, following) for line, following in zip_longest(lines, lines[1:]))
    return Forming(tuple(_mark(line) for line in lines), metrics, (), rows)


def _in_one(bent: Bent, zone: Run) -> "Hit":
    """Return the hit that makes a whole bend, in the middle of its turning."""
    (place,) = places(bent.bends, zone, np.array([0.5]))
    return float(place), run_angle(zone), False, float(facet_errors(bent, zone, 1)[0])


BEND_NAME, FOLD_NAME = "bend", "fold"


# Where


def bend_lines(bent: Bent, neutral: RuledSurface, development: Development, spec: BendSpec) -> list[BendLine]:
    """Return the hits in the order of v."""
    found: list[Hit] = []
    for run in runs(bent.bends):
        if is_fold(run[0]):
            found.append((float(run[0].piece), run_angle(run), True, 0.0))
            continue
        for zone in zones(bent, run, spec):
            found += [(place, step, False, off) for place, step, off in _hits(bent, zone, spec)]
    return _lines(bent, neutral, development, found, spec.name)


Hit = tuple[float, float, bool, float]
"""Place, signed angle in rad, whether it is a fold, and how far its facet is off in mm."""


def folds_of(bent: Bent) -> list[Hit]:
    """Return the folds between patches."""
    return [
        (float(stretch.piece), stretch.angle_rad, True, 0.0) for stretch in bent.bends.stretches if is_fold(stretch)
    ]


def _lines(
    bent: Bent, neutral: RuledSurface, development: Development, found: Sequence[Hit], name: str
) -> list[BendLine]:
    """Return hits with their radii, their distances across the rulings, and their lines in the flat."""
    if not found:
        return []
    at = np.array([place for place, *_ in found])
    rulings = flat_rulings(neutral, development, [bent.v_of(place) for place in at])
    fold_radius: list[float | None] = [bent.material.bend_radius_min_mm] * 2
    return [
        BendLine(f"{name}-{i + 1}", *hit, fold_radius if hit[2] else radii, reach, ends)
        for i, (hit, radii, reach, ends) in enumerate(
            zip(found, radii_at(bent, at), across(bent, at), rulings, strict=True)
        )
    ]


def _hits(bent: Bent, run: Run, spec: BendSpec) -> list[tuple[float, float, float]]:
    """Return place, signed angle and facet error of every hit of a run."""
    angle = run_angle(run)
    if spec.max_angle is not None:
        count = equal_turns(abs(angle), float(spec.max_angle))
    else:
        count = _count_by_facet(bent, run, float(spec.facet_error or 0))
    middles = places(bent.bends, run, (np.arange(count) + 0.5) / count)
    off = facet_errors(bent, run, count)
    return [(float(place), angle / count, float(error)) for place, error in zip(middles, off, strict=True)]


def _count_by_facet(bent: Bent, run: Run, wanted_mm: float) -> int:
    """Return the least number of hits found that keeps every facet within `wanted_mm`; its error falls as 1 / N^2."""
    count = max(ceil(abs(run_angle(run)) / LARGEST_STEP), 1)
    while count <= MOST_TURNS:
        reached = float(facet_errors(bent, run, count).max())
        if reached <= wanted_mm:
            return count
        count = max(count + 1, int(count * (reached / wanted_mm) ** 0.5 * CAUTIOUS))
    raise NoSolutionError("bend lines by facet error", reached=reached, wanted=wanted_mm, unit="mm")


LARGEST_STEP = np.pi / 2.0
CAUTIOUS = 0.95
"""Where the radius varies, the count by the square root overshoots: come near from below."""


def facet_errors(bent: Bent, run: Run, count: int) -> Values:
    """Return how far the facets about `count` hits are off the middle surface, mm: rho (1 - cos(delta / 2)).

    What is flat between two steps bends with neither: a step reaches from where its turning begins to where it ends.
    """
    begins, ends = (places(bent.bends, run, (np.arange(count) + share) / count) for share in (JUST, 1.0 - JUST))
    reach = across(bent, ends, bent.sheet.middle_mm) - across(bent, begins, bent.sheet.middle_mm)
    step = abs(run_angle(run)) / count
    off: Values = reach.max(axis=1) / (step * (1.0 - 2.0 * JUST)) * (1.0 - cos(step / 2.0))
    return off


JUST = 1e-9
"""Share of a step by which its ends are looked for inside it, where the part turns."""


def flat_rulings(neutral: RuledSurface, development: Development, v: list[float]) -> list[Points2]:
    """Return the ends of the flat rulings at the part's v, each of shape (2, 2), from c0 to c1."""
    found = [neutral.place_of(value) for value in v]
    u = np.array([0.0, 1.0])
    return [development.pieces[piece].positions(u, np.full(2, local)) for piece, local in found]


# What


def _mark(line: BendLine) -> Mark:
    path = ArcPath(line.ends, np.zeros(2), closed=False)
    return Mark(line.name, path, "BEND_UP" if line.side == "up" else "BEND_DOWN")


def _row(bent: Bent, line: BendLine, following: BendLine | None) -> dict[str, object]:
    """Return a line of the side table; pitch: to the next line, at c0 and at c1."""
    row: dict[str, object] = {
        "name": line.name,
        "v": bent.v_of(line.place),
        "from": line.ends[0].tolist(),
        "to": line.ends[1].tolist(),
        "angle_deg": degrees(line.angle_rad),
        "side": line.side,
        "radius_mm": line.radius_mm,
        "facet_error_mm": line.facet_mm,
        "fold": line.fold,
    }
    if following is not None:
        row["pitch_mm"] = (following.reach_mm - line.reach_mm).tolist()
    return row


def with_pieces(rows: Sequence[dict[str, object]], marks: Sequence[Mark]) -> list[dict[str, object]]:
    """Return the side table with the pieces of each line that lie on the part: its ends are those of the ruling."""
    return [
        row | {"pieces": [mark.path.vertices.tolist() for mark in marks if mark.name == row["name"]]} for row in rows
    ]


def _metrics(bent: Bent, lines: list[BendLine]) -> tuple[Metric, ...]:
    """Return the number of hits, what their angles lack of the surface's turning, pitch and facet error."""
    total = sum(abs(line.angle_rad) for line in lines)
    lack = abs(total - chord_turning(bent.surface.patches))
    pitches = [float((b.reach_mm - a.reach_mm).min()) for a, b in pairwise(lines)]
    return (
        Metric("bend_lines", float(len(lines)), "", "proved"),
        Metric("bend_angle_error_deg", degrees(lack), "deg", "sampled", ANGLE_LIMIT_DEG),
        Metric("bend_pitch_min_mm", min(pitches, default=None), "mm"),
        Metric("bend_facet_error_mm", max((line.facet_mm for line in lines), default=None), "mm"),
    )


# Crossings


def _crossings(bent: Bent, lines: list[BendLine]) -> list[Finding]:
    """Refuse bend lines that cross inside the part: a hit across another would bend what is bent already."""
    pairs = crossing_pairs(np.array([line.ends for line in lines]).reshape(-1, 2, 2))
    if not pairs:
        return []
    i, j = pairs[0]
    message = f"{len(pairs)} pairs of bend lines cross inside the part, {lines[i].name} and {lines[j].name} first"
    return [Finding("bend-lines-cross", message, True, {"v": bent.v_of(lines[i].place)})]


def crossing_pairs(segments: Array) -> list[tuple[int, int]]:
    """Return the pairs of segments, shape (n, 2, 2), that cross at an inner point of both.

    By the sides on which the ends of each lie of the other.  Ends within `TOUCH` of the longest segment count as on
    it: rulings meet at an apex.
    """
    if len(segments) == 0:
        return []
    start, step = segments[:, 0], segments[:, 1] - segments[:, 0]
    length = norm(step)
    near = TOUCH * float(length.max())

    def sides(points: Array) -> Array:
        """Distances of every point (column) from every line (row), mm, left positive."""
        heights = cross2(step[:, None], points[None] - start[:, None])
        return np.divide(heights, length[:, None], out=np.zeros_like(heights), where=length[:, None] > 0.0)

    a, b = sides(segments[:, 0]), sides(segments[:, 1])
    apart = (np.minimum(a, b) < -near) & (np.maximum(a, b) > near)
    i, j = np.nonzero(np.triu(apart & apart.T, 1))
    return [(int(x), int(y)) for x, y in zip(i, j, strict=True)]


TOUCH = 1e-9
"""As a share of the longest line: rounding of positions at a common apex, a thousand times over."""
