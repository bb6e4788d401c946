"""The surface on which the paper's directrix is a geodesic: the strap along it.

Nothing in Theorems 2.1 to 3.1 makes a directrix a geodesic.  The rectifying developable does: its tangent planes hold
tangent and binormal, so that the directrix unrolls to a straight line.
"""

from dataclasses import replace

from stages.construct import theorems
from stages.construct.built import Built
from stages.construct.curves import chain
from stages.construct.quintic import directrix, ends_of
from stages.construct.straps import strap
from stages.model.curves import CurveSpec
from stages.model.envelopes import Strap
from stages.model.quintics import QuinticRuled
from stages.model.scalars import Coordinate, Length
from stages.model.tolerances import Tolerances


def geodesic(spec: QuinticRuled, tol: Tolerances) -> Built:
    """Return the strap of that half width along the first directrix, its shape parameters settled."""
    start, end = ends_of(spec, "", normalise=tol.normalise)
    points = tuple(tuple(Coordinate(x) for x in point) for point in directrix(start, end).exact)
    centre = CurveSpec(bezier=points)
    metrics, findings = theorems.end_metrics([("0", start), ("1", end)], tol)
    built = strap(Strap(centre=centre, half_width=spec.half_width or Length(0)), chain(centre), tol)
    return replace(built, measured=(*metrics, *built.measured), findings=(*findings, *built.findings))
