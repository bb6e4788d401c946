"""What of a mark lies on the part: lines are cut off at the outline, at notches and at holes.

    on_part(marks, outer, inner) -> tuple[Mark, ...]

A path is divided at the polygon of the contours that will be cut, which is within `CLIP_MM` of them.  A mark that runs
along an edge or ends on it is off that polygon by no more than what lines and arcs may be off their exact curves, and
is left as it is; what reaches farther is cut off at the polygon.  Arcs stay arcs.

What leaves the part by less than twice the chord is not seen, nor a hole that is no wider than four times the chord.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, floor
from typing import TYPE_CHECKING

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.paths.arcpath import ArcPath, along, length, piece_count, polygon, radii, sweeps
from stages.geometry.paths.biarc import ZERO_LENGTH_MM
from stages.model.pattern import Contour, Mark
from stages.model.report import Finding

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

CLIP_MM = 0.01
"""How near a contour a mark ends that is cut off there."""
TWO_CURVES = 2.0
"""A mark and the outline are each within the chord of their exact curves."""

Stretches = list[tuple[float, float]]
"""Stretches of a path, in order and apart: i + s is at the share s of the sweep of piece i."""


def on_part(marks: Sequence[Mark], outer: Contour, inner: Sequence[Contour]) -> tuple[Mark, ...]:
    """Return the marks as far as they lie on the part; one that is divided as several of its name."""
    if not marks:
        return ()
    part, around = _regions(outer, inner)
    return tuple(Mark(mark.name, path, mark.layer) for mark in marks for path in _left(mark.path, part, around))


def left_off(given: Sequence[Mark], kept: Sequence[Mark]) -> tuple[Finding, ...]:
    """Say of which marks something was cut off, and how much."""
    found = []
    for name in dict.fromkeys(mark.name for mark in given):
        whole, rest = (sum(length(mark.path) for mark in marks if mark.name == name) for marks in (given, kept))
        if whole - rest > ZERO_LENGTH_MM:
            message = f"{name}: {whole - rest:.4g} mm of {whole:.4g} mm would lie off the part or over a hole: left off"
            found.append(Finding("mark-clipped", message, where={"feature": name}))
    return tuple(found)


def _regions(outer: Contour, inner: Sequence[Contour]) -> "tuple[BaseGeometry, BaseGeometry]":
    """Return the part, and the part with everything that may count as on its edge."""
    import shapely

    rings = [polygon(contour.path, accuracy=min(outer.chord_mm, CLIP_MM)) for contour in (outer, *inner)]
    part = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
    around = part.buffer(TWO_CURVES * outer.chord_mm + CLIP_MM)
    shapely.prepare(part)
    shapely.prepare(around)
    return part, around


def _left(path: ArcPath, part: "BaseGeometry", around: "BaseGeometry") -> list[ArcPath]:
    """Return what is left of a path: all of it, if it leaves the part nowhere by more than its own accuracy."""
    beyond = _outside(path, around)
    if not beyond:
        return [path]
    off = [(a, b) for a, b in _outside(path, part) if any(a <= high and low <= b for low, high in beyond)]
    count = float(piece_count(path))
    ends = [0.0, *(end for stretch in off for end in stretch), count]
    kept = [(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a]
    if path.closed and len(kept) > 1 and (kept[0][0], kept[-1][1]) == (0.0, count):
        kept = [*kept[1:-1], (kept[-1][0], count + kept[0][1])]
    made = [_stretch(path, a, b) for a, b in kept]
    return [one for one in made if length(one) > ZERO_LENGTH_MM]


def _outside(path: ArcPath, region: "BaseGeometry") -> Stretches:
    """Return where a path is outside a region."""
    import shapely

    at = _ends_of_chords(path)
    piece = np.minimum(at.astype(np.int64), piece_count(path) - 1)
    points = along(path, piece, at - piece)
    lines = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1))
    found: Stretches = []
    for i in np.flatnonzero(~shapely.covers(region, lines)):
        left = shapely.difference(lines[i], region)
        start, step, whole = points[i], float(at[i + 1] - at[i]), float(lines[i].length)
        for one in getattr(left, "geoms", [left]):
            ends: Array = np.asarray(one.coords)[[0, -1]] if not one.is_empty else np.zeros((0, 2))
            shares = sorted(min(float(share), 1.0) for share in np.hypot(*(ends - start).T) / whole)
            found += [(float(at[i]) + low * step, float(at[i]) + high * step) for low, high in pairwise(shares)]
    return _merged(found)


def _ends_of_chords(path: ArcPath) -> Values:
    """Return places along a path, those between pieces among them, such that the chords keep within `CLIP_MM`."""
    sweep, radius = np.abs(sweeps(path)), radii(path)
    # the height of a chord over an arc by the angle a is r a^2 / 8 at most
    widest = np.sqrt(8.0 * CLIP_MM / np.where(sweep > 0.0, radius, CLIP_MM))
    counts = np.maximum(np.ceil(sweep / widest), 1.0).astype(np.int64)
    places: Values = np.concatenate([i + np.arange(count) / count for i, count in enumerate(counts)])
    return np.append(places, float(counts.size))


def _merged(stretches: Stretches) -> Stretches:
    """Return stretches with those that touch as one."""
    merged: Stretches = []
    for low, high in sorted(stretches):
        if merged and low <= merged[-1][1] + JOINED:
            merged[-1] = (merged[-1][0], max(high, merged[-1][1]))
        else:
            merged.append((low, high))
    return merged


JOINED = 1e-9
"""Stretches that are nearer than this share of a piece are one: ends of chords, known to rounding."""


def _stretch(path: ArcPath, low: float, high: float) -> ArcPath:
    """Return the part of a path between two places; one that is closed goes on from its beginning."""
    places = [low, *(float(i) for i in range(floor(low) + 1, ceil(high))), high]
    begins = [(floor(a) % piece_count(path), a - floor(a), b - a) for a, b in pairwise(places)]
    piece, share, width = (np.array(column) for column in zip(*begins, strict=True))
    vertices = along(path, piece, share)
    last = along(path, piece[-1:], share[-1:] + width[-1:])
    bulges = np.tan(sweeps(path)[piece] * width / 4.0)
    return ArcPath(np.concatenate([vertices, last]), np.append(bulges, 0.0), closed=False)
