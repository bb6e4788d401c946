"""Closed paths that enclose all that the exact edges of a contour enclose, and little more.

The edges are traced, by lines and arcs or by chords, within a part of the accuracy; how far each edge really is from
its pieces is measured; then every piece moves out by what its own edge needs, and corners stay corners (`grown`).  An
edge that is followed exactly does not move, unless it runs on smoothly into one that does.

Why that is enough: let P be the path and d_e the distance of edge e to its pieces P_e.  Then all edges lie in the union
of the region inside P and of the discs of radius d_e about the points of P_e.  That union lies inside the path of the
pieces moved out by d_e; so does, since a closed curve inside a region without holes keeps all it encloses inside, what
the edges enclose.  d_e is measured at dense points with what may lie between them (`hausdorff`).

At a sharp corner the moved pieces cross far out, and beside a corner a short one may be cut off; the result is measured
both ways, and where it is further off than the accuracy allows, all is traced finer.
"""

from collections.abc import Callable, Sequence

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Mask, Numbers, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.sampling import Resolved, dense_points, resolved
from stages.geometry.paths import clearance, enclosed
from stages.geometry.paths.arcpath import ArcPath, area, joint_turns
from stages.geometry.paths.grown import grown
from stages.geometry.paths.hausdorff import DENSITY, HEIGHTS, hausdorff, nearest

Trace = Callable[[Sequence[PlaneCurve], float], tuple[ArcPath, Numbers]]
"""Closed path within an accuracy in mm of some edges, and of each piece the number of its edge."""

TRACED = 0.44
"""Share of the accuracy for tracing: moved out by as much, the path is off by up to twice that, and the measurement of
both takes 3 % of the accuracy each."""

FURTHEST = 0.94
"""Share of the accuracy that a corner may move."""

FINER = 0.5
ROUNDS = 8
"""At 1/256 of the accuracy a corner of half a degree is kept; sharper ones are needles that no machine cuts."""

KEPT = 1e-9
"""An edge this close to its pieces, as a share of its size, is followed exactly."""

GRID_SHARE = 0.01
ROUNDING_MM = 1e-9
"""What coordinates lose in a file, with room: every piece that moves at all moves by as much more."""

CHUNK = 1024
"""Points asked at a time: each is compared with all pieces."""


def outside(edges: Sequence[PlaneCurve], trace: Trace, *, accuracy: float) -> ArcPath:
    """Return a closed path within `accuracy` mm of the edges with nothing of what they enclose on its right.

    Raises NoSolutionError where a corner is too sharp for it, or an edge cannot be traced.
    """
    within, reached = TRACED * accuracy, float("inf")
    for _ in range(ROUNDS):
        path, edge = trace(edges, within)
        shifts = np.array([_shift(edges[number], path, edge == number, within) for number in range(len(edges))])
        moved = grown(path, shifts[edge])
        reached = _reached(edges, path, moved, accuracy) if moved is not None else reached
        if moved is not None and reached <= accuracy:
            return moved
        within *= FINER
    raise NoSolutionError("a path outside of a sharp corner", reached=reached, wanted=accuracy, unit="mm")


def _shift(edge: PlaneCurve, path: ArcPath, own: Mask, accuracy: float) -> float:
    """Return how far the pieces of one edge must move, mm; 0 where they follow it exactly, or there are none."""
    pieces = np.flatnonzero(own)
    if pieces.size == 0:
        return 0.0
    known = resolved(edge, accuracy=GRID_SHARE * accuracy)
    ends = np.append(pieces, (pieces[-1] + 1) % path.bulges.size)
    part = ArcPath(path.vertices[ends], np.append(path.bulges[pieces], 0.0), closed=False)
    height = DENSITY * accuracy
    far = float(nearest(dense_points(known, accuracy=height), part, accuracy=accuracy).max())
    size = float(norm(known.points - known.points[0]).max())
    return 0.0 if far <= KEPT * size else far + HEIGHTS * height + ROUNDING_MM


def _reached(edges: Sequence[PlaneCurve], path: ArcPath, moved: ArcPath, accuracy: float) -> float:
    """Return how far the moved path and the edges are apart, mm; of a corner that is too far out only that."""
    corner = _furthest(path, moved)
    if corner > FURTHEST * accuracy:
        return corner / FURTHEST
    known = [resolved(edge, accuracy=GRID_SHARE * accuracy) for edge in edges]
    return hausdorff(known, moved, accuracy=accuracy).bound_mm


def _furthest(path: ArcPath, moved: ArcPath) -> float:
    """Return how far corners that the path turns left at have moved, mm; at others the edges are nearer."""
    left = joint_turns(path) > 0.0
    return float(norm(moved.vertices - path.vertices)[left].max(initial=0.0))


def beyond(edges: Sequence[Resolved], path: ArcPath, *, accuracy: float) -> float:
    """Return how far the edges reach to the right of a closed path, mm, at points as dense as `accuracy` asks."""
    points = np.concatenate([dense_points(edge, accuracy=DENSITY * accuracy) for edge in edges])
    pieces = clearance.pieces(path)
    within = np.concatenate([enclosed.inside(points[k : k + CHUNK], pieces) for k in range(0, len(points), CHUNK)])
    right = points[within != (area(path) > 0.0)]
    return float(nearest(right, path, accuracy=accuracy).max()) if right.size else 0.0
