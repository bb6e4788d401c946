"""Two-sided Hausdorff distance between the exact edges of a contour and a path of lines and arcs.

Edges to path: dense exact points of the edges, each with its exact distance to the pieces near it.  Path to edges:
dense exact points of the path, each with its distance to the polygon of the edges' points.  Pieces and chords near a
point are found through points on them, by a k-d tree where they are many.  Only a few candidates are looked at, so a
distance may come out too large, never too small; where it comes out above the accuracy, all are looked at.

Both samplings are dense enough that no arc rises over its chord by more than `DENSITY` of the accuracy.  A chord point
is that close to a point of its curve, and along a chord the distance to the other curve bends no faster than those
curves do; so between the samples the true value exceeds the measured one by at most three such heights, to second
order.  That is the `bound_mm` reported; it is a measurement, not a proof.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Indices, Numbers, Points2, Values, dot, norm
from stages.geometry.flat.sampling import Resolved, dense_points
from stages.geometry.paths.arcpath import ArcPath, along, distances, piece_count, radii, split, sweeps
from stages.geometry.paths.overlap import QUARTER_BULGE

DENSITY = 0.01
HEIGHTS = 3.0
CANDIDATES = 3
"""Points whose pieces are tried for each query; at a joint the two neighbours are among them."""

FEW_PAIRS = 100_000
"""Up to so many pairs of queries and points all are compared: a few ms, where loading the tree takes a quarter of a
second.  It goes by the sizes alone, so that a contour is measured alike in every job."""

LONGEST_STEP = 1.0 / 24.0
"""Lines have no height over their chord; they are sampled at this share of their length all the same."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """Largest distance found, and what it can be at most between the samples, in mm."""

    value_mm: float
    bound_mm: float


def hausdorff(edges: Sequence[Resolved], path: ArcPath, *, accuracy: float) -> Deviation:
    """Return the two-sided distance between the edges and the path; samples are as dense as `accuracy` mm asks.

    The result may be larger than `accuracy`; it is then less sharp, by the share that it is larger.

    Raises NoSolutionError if an edge cannot be sampled that well.
    """
    height = DENSITY * accuracy
    exact = [dense_points(edge, accuracy=height) for edge in edges]
    gentle = split(path, max_bulge=QUARTER_BULGE)
    piece, points = _path_points(gentle, height)
    there = _to_path(np.concatenate(exact), gentle, piece, points, accuracy)
    back = _to_polygons(points, exact, accuracy)
    value = float(max(there.max(), back.max()))
    return Deviation(value, value + HEIGHTS * height)


def nearest(points: Points2, path: ArcPath, *, accuracy: float) -> Values:
    """Return the distance of each point to the path in mm; not too small, and exact up to about `accuracy` mm."""
    gentle = split(path, max_bulge=QUARTER_BULGE)
    return _to_path(points, gentle, *_path_points(gentle, DENSITY * accuracy), accuracy)


def _path_points(path: ArcPath, height: float) -> tuple[Indices, Points2]:
    """Return points along the path and the pieces they lie on, ends of each piece included."""
    sweep = np.abs(sweeps(path))
    curved = sweep > 0.0
    radius = np.where(curved, radii(path), 1.0)
    step = 4.0 * np.arcsin(np.sqrt(np.minimum(height / radius / 2.0, 0.5)))
    count = np.ceil(np.maximum(np.where(curved, sweep / step, 0.0), 1.0 / LONGEST_STEP)).astype(np.int64)
    piece = np.repeat(np.arange(piece_count(path)), count + 1)
    within = np.arange(piece.size) - np.repeat(np.cumsum(count + 1) - count - 1, count + 1)
    return piece, along(path, piece, within / count[piece])


def _to_path(queries: Points2, path: ArcPath, piece: NDArray[np.int64], points: Array, accuracy: float) -> Values:
    """Return the distance of each query to the pieces of the points nearest to it, in mm."""
    near = _candidates(queries, points)
    found: Values = np.min([distances(queries, path, piece[near[:, k]]) for k in range(CANDIDATES)], axis=0)
    far = np.flatnonzero(found > accuracy)
    for i in range(piece_count(path) if far.size else 0):
        found[far] = np.minimum(found[far], distances(queries[far], path, np.full(far.size, i)))
    return found


def _to_polygons(queries: Points2, polygons: Sequence[Array], accuracy: float) -> Values:
    """Return the distance of each query to the chords at the polygon point nearest to it, in mm."""
    start = np.concatenate([polygon[:-1] for polygon in polygons])
    end = np.concatenate([polygon[1:] for polygon in polygons])
    near = _candidates(queries, (start + end) / 2.0)
    found: Values = np.min([_to_chords(queries, start[n], end[n]) for n in near.T], axis=0)
    for i in np.flatnonzero(found > accuracy):
        found[i] = _to_chords(queries[i : i + 1], start, end).min()
    return found


def _candidates(queries: Points2, points: Array) -> Numbers:
    """Return the numbers of the `CANDIDATES` points, shape (k, 2), nearest to each query, in any order."""
    if len(queries) * len(points) <= FEW_PAIRS:
        squares = ((queries[:, None] - points) ** 2).sum(axis=2)
        return np.argpartition(squares, CANDIDATES - 1)[:, :CANDIDATES]
    from scipy.spatial import KDTree

    return np.asarray(KDTree(points).query(queries, k=CANDIDATES)[1])


def _to_chords(points: Array, start: Array, end: Array) -> Array:
    """Return the distance of each point to its chord, or of one point to all chords, in mm."""
    chord = end - start
    square = dot(chord, chord)
    fraction = np.divide(dot(points - start, chord), square, out=np.zeros_like(square), where=square > 0.0)
    return norm(points - start - fraction.clip(0.0, 1.0)[:, None] * chord)
