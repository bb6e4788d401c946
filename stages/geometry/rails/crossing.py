"""Where two arcs of F = 0 cross: F, F_t and F_s vanish together.

Along an arc on which both parameters rise F_t - F_s keeps its sign but for such points, at which it changes; Newton's
method on F_t = F_s = 0 finds them to rounding, where Newton's method on F would keep half the digits.  Symmetric rails
have them: one moved along has one at each of its inflections.

Two crossings between neighbouring knots of an arc are not seen.
"""

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.curves.curves import Curve
from stages.geometry.rails.mismatch import mismatch_series, scale


def crossings(a: Curve, b: Curve, w: Values, t: Values) -> Array:
    """Return the crossings inside the arc of these knots, (t, s) in rising order, shape (n, 2)."""
    F = mismatch_series(a, b, t, w - t, 1)
    steep = F[1, 0] - F[0, 1]
    k = np.flatnonzero(steep[:-1] * steep[1:] <= 0.0)
    pairs = np.stack([t, w - t], axis=1)
    found = [crossing(a, b, pairs[i : i + 2]) for i in k]
    places = sorted({(float(place[0]), float(place[1])) for place in found if place is not None})
    inner = [place for place in places if w[0] + APART < sum(place) < w[-1] - APART]
    kept = [place for i, place in enumerate(inner) if i == 0 or sum(place) - sum(inner[i - 1]) > APART]
    return np.array(kept).reshape(-1, 2)


APART = 1e-9
"""Crossings nearer to each other, or to the end of the arc, are one."""


def crossing(a: Curve, b: Curve, corners: Array) -> Values | None:
    """Return the crossing (t, s) inside a box of parameters by its corners, shape (2, 2); None if there is none."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    place = (low + high) / 2.0
    margin = MARGIN * (high - low).max()
    for _ in range(STEPS):
        F = mismatch_series(a, b, place[:1], place[1:], 2)[..., 0]
        hesse = np.array([[2.0 * F[2, 0], F[1, 1]], [F[1, 1], 2.0 * F[0, 2]]])
        gradient = np.array([F[1, 0], F[0, 1]])
        step = np.linalg.lstsq(hesse, -gradient, rcond=None)[0]
        place = place + step
        if not ((place >= low - margin) & (place <= high + margin)).all():
            return None
        if np.abs(step).max() <= SETTLED:
            break
    if not ((place >= low - SAME) & (place <= high + SAME)).all():
        return None
    size = float(scale(a.jet(place[:1], 1), b.jet(place[1:], 1))[0])
    return np.clip(place, 0.0, 1.0) if abs(F[0, 0]) <= CROSSED * size else None


STEPS = 12
SETTLED = 1e-14
MARGIN = 0.5
"""How far outside the box Newton's steps may lead, as a share of it."""
SAME = 1e-9
"""How far outside it a crossing may lie by rounding."""
CROSSED = 1e-13
"""F as a share of |r'||p||c'| that is rounding of zero; between two arcs that only pass each other it is more."""
