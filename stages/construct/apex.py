"""Whether the apex of a cone lies on its directrix: there no ruling has a direction."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from stages.construct.curves import ends
from stages.construct.quintic import Vector
from stages.geometry.arrays import Values, Vector3, dot, floats, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric.extremum import maximum
from stages.model.report import Finding


def apex_findings(curves: Sequence[Curve], apex: Vector) -> tuple[Finding, ...]:
    """Refuse an apex on the directrix, naming the place."""
    for i, curve in enumerate(curves):
        least, v = _nearest(curve, floats(apex))
        if least <= ON_CURVE * float(norm(np.stack(ends(curve)) - floats(apex)).max()):
            return (Finding("apex-on-directrix", "the apex lies on the directrix", True, {"piece": i, "v": v}),)
    return ()


def _nearest(curve: Curve, point: Vector3) -> tuple[float, float]:
    """Return the least distance of a curve from a point, mm, and its place: sampled, then Gauss-Newton."""
    _, v = maximum(partial(_nearness, curve, point))
    for _ in range(NEWTON_STEPS):
        position, slope = curve.jet(np.array([v]), 1)[:, 0]
        speed = float(dot(slope, slope))
        v = min(max(v - float(dot(position - point, slope)) / speed, 0.0), 1.0) if speed > 0.0 else v
    return float(-_nearness(curve, point, np.array([v]))[0]), v


def _nearness(curve: Curve, point: Vector3, v: Values) -> Values:
    return -norm(curve.jet(v, 0)[0] - point)


NEWTON_STEPS = 3
"""The sampled place is good to 1e-8; on the curve each step squares that."""
ON_CURVE = 1e-9
"""An apex nearer to its directrix than this share of the cone's length lies on it: below, no ruling has a direction."""
