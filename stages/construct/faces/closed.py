"""Closed faces cut open, whatever they are ruled by: round ones (`seams`), and splines that close on themselves.

    opened(face, form) -> (face, form)

A spline begins somewhere on its closed rails, and a strip of it has to begin where the face is cut open: of the
rulings that can be a seam those at its knots come first, the beginning before all.  The patches are then taken from
there on round, one divided exactly where the seam lies in it.

On a developable the tangent plane is the same along a ruling: that a point lies beside a ruling is seen across it, in
that plane, near the ruling.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeVar

import numpy as np

from stages.construct.faces.ruled import Rails
from stages.construct.faces.seams import SAMPLES, Compass, cut_open, seamed
from stages.construct.faces.strip import heights, seam_points, swept
from stages.construct.faces.trim import MEETS, closes
from stages.geometry.arrays import Values, Vector3, dot, norm, unit
from stages.geometry.curves.curves import Circular, Curve, restrict
from stages.geometry.ruled.pullback import lying_on
from stages.geometry.ruled.ruled import RuledPatch, part
from stages.geometry.ruled.strip import Strip, jet, size
from stages.model.cadface import CadCone, CadFace, CadSweep

FULL = 2.0 * np.pi
ON_KNOT = 1e-9
"""Of a patch: a seam this near to a knot or a share is there."""
SHARES = 8
"""Of a patch, at which a seam between knots is tried first: control points stay short fractions."""


def opened(face: CadFace, form: CadSweep | CadCone | Rails) -> tuple[CadFace, CadSweep | CadCone | Rails]:
    """Return a face with a seam, and its surface from there on; both as they are where it has one or needs none.

    Raises NoSeamError where no ruling crosses each rim once and no hole.
    """
    if seam_points(face) is not None:
        return face, form
    if isinstance(form, CadCone) or (isinstance(form, CadSweep) and isinstance(form.profile[0], Circular)):
        return seamed(face, form), form
    patches = form.patches if isinstance(form, Rails) else swept(form, face, heights(face, form.direction))
    count = len(patches)
    strip = Strip(patches, np.arange(count + 1.0))
    if not closes(strip):
        return face, form
    cut = cut_open(face, _round(strip), lambda _: [FULL * v / count for v in _tried(count)])
    if cut is None:
        return face, form
    return cut[0], begun_at(form, (cut[1] / FULL * count) % count)


def _tried(count: int) -> list[float]:
    """Return the v of rulings to be tried: at all knots, then at shares between them."""
    shares = np.arange(SHARES) / SHARES
    return [float(k + share) for share in shares for k in range(count)]


def _round(strip: Strip) -> Compass:
    """Return v of a closed strip as an angle."""
    count, within = len(strip.patches), MEETS * size(strip)

    def along(curve: Curve) -> Values:
        """Return the angles along a curve that lies on the strip."""
        v = lying_on(strip, curve, SAMPLES - 1, within_mm=within).table[:, 1]
        return np.asarray(np.unwrap(FULL * v / count))

    def beside(angle: float, point: Vector3) -> float:
        """Return how far a point is beyond a ruling in the sense of v, times the speed there, mm2."""
        here = jet(strip, np.array([0.5]), np.array([angle / FULL * count % count]))
        ruling = unit(here.s_u)
        across = here.s_v - dot(here.s_v, ruling)[:, None] * ruling
        return float(dot(point - here.s, across)[0])

    return Compass(along, beside, apex_of(strip.patches))


def apex_of(patches: Sequence[RuledPatch]) -> Vector3 | None:
    """Return the point that one of the rails is; None where both are curves."""
    t = np.linspace(0.0, 1.0, 9)
    for rail in ([patch.c0 for patch in patches], [patch.c1 for patch in patches]):
        points = np.concatenate([curve.jet(t, 0)[0] for curve in rail])
        if float(norm(points - points[0]).max()) <= A_POINT * float(norm(points).max()):
            apex: Vector3 = points[0]
            return apex
    return None


A_POINT = 1e-12
"""Of the distance from the origin: what rounding leaves of a point."""


def begun_at(form: CadSweep | Rails, v: float) -> CadSweep | Rails:
    """Return a closed surface from v on round; v counts its patches, or the curves of its profile."""
    if isinstance(form, Rails):
        return Rails(_from_on(form.patches, v, part))
    return CadSweep(_from_on(form.profile, v, restrict), form.direction)


Piece = TypeVar("Piece")


def _from_on(
    pieces: tuple[Piece, ...], v: float, stretch: Callable[[Piece, Fraction, Fraction], Piece]
) -> tuple[Piece, ...]:
    """Return pieces from v on round, one divided where v lies in it."""
    near = Fraction(round(v * SHARES), SHARES)
    exact = near if abs(v - near) <= ON_KNOT else Fraction(v)
    i, place = int(exact) % len(pieces), exact - int(exact)
    if place == 0:
        return (*pieces[i:], *pieces[:i])
    after, before = (stretch(pieces[i], *ends) for ends in ((place, Fraction(1)), (Fraction(0), place)))
    return (after, *pieces[i + 1 :], *pieces[:i], before)
