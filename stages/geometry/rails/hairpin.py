"""A smooth curve that runs along a straight line and back: as good as a line, and without a tangent where it turns.

Where a curve of length L turns back within a width of q L, its tangent turns by pi while its parameter goes on by some
q.  Below `NARROW` that is less than what knots along an arc of F = 0 are apart (`linked.SHORTEST`): such an end looks
like a corner at one place and like a bend at the next, and lattices as fine as that would not tell.  As a chain of
straight pieces the same rail is plain.

By the points and tangents at evenly spaced places: it may miss a turn between two of them, never find one too many.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.curves.curves import Curve

NARROW = 1e-6
"""Of its length: a micrometre to the metre."""

PLACES = 65
"""At which a piece is looked at: of a full ellipse both ends of either axis."""


@dataclass(frozen=True, slots=True)
class Hairpin:
    """How far a curve that turns back reaches, and how far it is off a straight line, mm; its parameter at a turn."""

    long_mm: float
    off_mm: float
    v: float


def hairpin(curve: Curve) -> Hairpin | None:
    """Return where and how narrowly a smooth curve turns back along a straight line; None if it does not."""
    v = np.linspace(0.0, 1.0, PLACES)
    points, tangents = curve.jet(v, 1)
    reach = points - points[0]
    far = reach[int(np.argmax(norm(reach)))]
    long = float(norm(far))
    if long == 0.0:
        return None
    along = far / long
    off = float(norm(reach - (reach @ along)[:, None] * along).max())
    pace = tangents @ along
    # at an end of the axis of an ellipse it is rounding
    ahead = np.sign(np.where(np.abs(pace) > NARROW * np.abs(pace).max(), pace, 0.0))
    back = np.flatnonzero(ahead == -ahead[np.flatnonzero(ahead)[:1]])
    if not back.size or off > NARROW * long:
        return None
    return Hairpin(long, off, float(v[back[0] - 1]))
