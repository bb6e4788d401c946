"""Whether ruled patches lie in one plane: exactly where the control points are exact, else to rounding."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from stages.geometry.curves.curves import Bezier, RationalBezier, homogeneous
from stages.geometry.ruled.ruled import RuledPatch


def is_planar(patches: Sequence[RuledPatch]) -> tuple[bool, bool]:
    """Return whether all patches lie in one plane, and whether that is proved (exact control points)."""
    if all(patch.exact for patch in patches):
        return _exactly_planar([point for patch in patches for point in _control_points(patch)]), True
    v = np.linspace(0.0, 1.0, 65)
    points = np.concatenate([c.jet(v, 0)[0] for patch in patches for c in (patch.c0, patch.c1)])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[2] <= PLANAR * spread[0]), False


PLANAR = 1e-12
"""Sampled points whose third principal extent is below this share of the first lie in a plane up to rounding."""


def _control_points(patch: RuledPatch) -> list[tuple[Fraction, ...]]:
    """Return the control points of both directrices: a rational curve is plane where they are, its weights positive."""
    curves = [c for c in (patch.c0, patch.c1) if isinstance(c, Bezier | RationalBezier)]
    return [(x / w, y / w, z / w) for c in curves for x, y, z, w in homogeneous(c)]


def _exactly_planar(points: Sequence[Sequence[Fraction]]) -> bool:
    """Return whether the points lie in one plane: every triple product with two spanning differences vanishes."""
    rows = [[x - o for x, o in zip(point, points[0], strict=True)] for point in points[1:]]
    a = next((row for row in rows if any(row)), None)
    if a is None:
        return True
    normals = (_cross(a, row) for row in rows)
    normal = next((n for n in normals if any(n)), None)
    return normal is None or all(sum(x * y for x, y in zip(normal, row, strict=True)) == 0 for row in rows)


def _cross(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
