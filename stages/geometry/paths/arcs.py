"""Lines and circular arcs by start, end and sweep, in arrays of any shape: lengths, areas, directions, points on them.

Points have x, y along their last axis; a sweep, in rad and positive counter-clockwise, belongs to each piece, 0 to a
line.  All is computed from the chord and the sweep, never from the centre, which is so far away for a nearly straight
arc that differences from it lose all digits.
"""

import numpy as np

from stages.geometry.arrays import Array, Indices, Points2, Values, cross2, norm

FLAT_BULGE = 1e-15
"""An arc flatter than this is a line: its height over the chord is under the rounding of the chord's ends."""

SMALL_SWEEP = 0.1
"""Below this the area of a segment is summed as a series: its next term is 1e-14, the closed form loses 1e-13."""

SEGMENT_SERIES = (1.0 / 25200.0, 1.0 / 840.0, 1.0 / 30.0, 1.0)
"""Of 12 (a - sin a) / (8 a sin^2(a/2)) in powers of a^2, highest first."""

ROUNDING = 1e-9
"""What a count of equal parts may be over a whole number by rounding alone."""

QUARTER = np.pi / 2.0
WIDEST_STEP = np.pi / 3.0
"""A polygon never takes a longer step than this along an arc, however coarse it may be."""


def bends(bulges: Array) -> Array:
    """Return bulges, those of lines in all but name set to 0."""
    return np.where(np.abs(bulges) < FLAT_BULGE, 0.0, bulges)


def sweeps(bulges: Array) -> Array:
    """Return the signed sweeps of pieces with those bulges, rad."""
    sweep: Array = 4.0 * np.arctan(bends(bulges))
    return sweep


def lengths(start: Array, end: Array, sweep: Array) -> Array:
    """Return the length of each piece in mm; exact."""
    long: Array = norm(end - start) / np.sinc(np.abs(sweep) / 2.0 / np.pi)
    return long


def curvatures(start: Array, end: Array, bulge: Array) -> Array:
    """Return the signed curvature of each piece in 1/mm, positive counter-clockwise; 0 for a piece of no length."""
    chord = norm(end - start)
    return np.divide(4.0 * bulge, chord * (1.0 + bulge**2), out=np.zeros_like(chord), where=chord > 0.0)


def radii(start: Array, end: Array, bulge: Array) -> Array:
    """Return the radius of each piece in mm; infinite for straight ones."""
    straight = bulge == 0.0
    safe = np.where(straight, 1.0, np.abs(bulge))
    return np.where(straight, np.inf, norm(end - start) * (1.0 / safe + safe) / 4.0)


def steps(sweep: Values, radius: Values, accuracy: float) -> Indices:
    """Return into how many equal parts arcs are cut so that chord and tangent stay within `accuracy`."""
    step = np.minimum(4.0 * np.arcsin(np.sqrt(accuracy / (radius + accuracy) / 2.0)), WIDEST_STEP)
    curved = sweep > 0.0
    return np.where(curved, np.ceil(sweep / np.where(curved, step, 1.0) - ROUNDING), 1.0).clip(1.0).astype(np.int64)


def areas(start: Array, end: Array, sweep: Array, about: Array) -> Array:
    """Return the area in mm2 that the line from a point sweeps over along each piece, counter-clockwise; exact."""
    chord = norm(end - start)
    # a circular segment of sweep a over the chord c: c^2 (a - sin a) / (8 sin^2(a/2)); by series where that cancels
    small = np.abs(sweep) < SMALL_SWEEP
    safe = np.where(small, 1.0, sweep)
    closed_form = (safe - np.sin(safe)) / (8.0 * np.sin(safe / 2.0) ** 2)
    series = sweep / 12.0 * np.polyval(np.array(SEGMENT_SERIES), np.where(small, sweep, 0.0) ** 2)
    swept: Array = 0.5 * cross2(start - about, end - about) + chord**2 * np.where(small, series, closed_form)
    return swept


def directions(start: Array, end: Array, sweep: Array) -> tuple[Array, Array]:
    """Return the direction angles at the start and at the end of each piece, in rad."""
    chord = end - start
    along = np.arctan2(chord[..., 1], chord[..., 0])
    half = sweep / 2.0
    return along - half, along + half


def between(start: Array, end: Array, sweep: Array, fraction: Array) -> Array:
    """Return the points at `fraction` of the sweep of the pieces, in mm; exact for any sweep, 0 included."""
    half = sweep / 2.0
    # the chord from the start to the point at f has length chord * sin(f a/2) / sin(a/2), turned by (f - 1) a/2
    scale = fraction * np.sinc(fraction * half / np.pi) / np.sinc(half / np.pi)
    points: Array = start + turned(end - start, (fraction - 1.0) * half) * scale[..., None]
    return points


def furthest(start: Array, end: Array, sweep: Array) -> tuple[Indices, Points2]:
    """Return the points at which arcs are furthest out along x and y, mm, with the pieces that they lie on.

    Of pieces in a row: start and end of shape (pieces, 2).
    """
    first, _ = directions(start, end, sweep)
    # an arc is furthest out where its direction is a multiple of 90 degrees
    turn = np.where(sweep[:, None] >= 0.0, 1.0, -1.0) * (np.arange(4) * QUARTER - first[:, None])
    turn = np.mod(turn, 2.0 * np.pi)
    piece, quarter = np.nonzero(turn < np.abs(sweep)[:, None])
    share = turn[piece, quarter] / np.abs(sweep)[piece]
    return piece, between(start[piece], end[piece], sweep[piece], share)


def turned(vectors: Array, angle: Array) -> Array:
    """Return the vectors turned by the angles in rad, counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
