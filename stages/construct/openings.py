"""The opening of a tee's main as a plate: a template that is laid around the main, and what is cut out of it.

The plate lies in the development of the main, of the very diameter that the job gives: x along the main from where both
axes cross (or come nearest), y around it from its crown, seen from outside.  Marked are the line along the main above
the branch's axis, by which the template is laid on, and the point in which that axis leaves the main.

The template itself is not bent to a neutral surface of its own: its thickness is taken for nothing against the main.
"""

from fractions import Fraction
from math import asin, radians, sin, sqrt, tan

import numpy as np

from stages.construct.saddles import tee
from stages.geometry.arrays import Vector2, norm
from stages.geometry.curves.opening import Opening, opening
from stages.geometry.curves.plane import Segment
from stages.model.curves import CurveSpec, PlanePoint
from stages.model.ducts import Tee
from stages.model.features import CurveMark, PointMark
from stages.model.material import Part
from stages.model.report import Metric, Outcome, StageReport
from stages.model.scalars import coordinate
from stages.model.surface import Placed, Plate, Surface


def main_opening(part: Part, spec: Tee) -> Outcome[Surface | None]:
    """Return the opening that a tee's branch leaves in its main, or None where the branch misses the main."""
    missed = tuple(finding for finding in tee(spec)[1] if finding.code == "saddle-misses")
    if missed:
        return Outcome(None, StageReport("construct", part.name, (), missed))
    main, branch = float(spec.main) / 2.0, float(spec.branch) / 2.0
    edges = opening(main, branch, float(spec.offset), radians(spec.angle))
    points = np.concatenate([edge.at(np.linspace(0.0, 1.0, 65)) for edge in edges])
    size = float(norm(points.max(axis=0) - points.min(axis=0)))
    report = StageReport("construct", part.name, (Metric("planar", True, "", "proved"),))
    return Outcome(Plate(part, edges, (), size, _marks(edges[0])), report)


def _marks(edge: Opening) -> tuple[Placed, ...]:
    """Return the line along the main above the branch's axis, and the point in which that axis leaves the main."""
    y = edge.main * asin(edge.middle / edge.main)
    x = sqrt((edge.main - edge.middle) * (edge.main + edge.middle)) / tan(edge.angle)
    reach = edge.branch / sin(edge.angle)
    ends = np.array([x - reach, y]), np.array([x + reach, y])
    line = CurveMark(name="main-axis", curve=CurveSpec(line=(_place(ends[0]), _place(ends[1]))))
    centre = np.array([x, y])
    cross = PointMark(name="branch-axis", at=_place(centre))
    return Placed(line.name, line, None, (Segment(*ends),)), Placed(cross.name, cross, centre)


def _place(point: Vector2) -> PlanePoint:
    return tuple(coordinate(Fraction(float(x)), None) for x in point)
