"""The surface of faces that make one blank in any direction: each on its own patches, hinged along straight edges.

Which face of the sheet `inner` or `outer` means is decided here for all faces together: every bend must have the same
side of the sheet inside.
"""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from msgspec.structs import replace as with_fields

from stages.construct.faces.based import Based, based, places
from stages.construct.faces.features import on_faces
from stages.construct.faces.hinges import ENDS, Meeting, curve_of, meeting
from stages.errors import NoSolutionError
from stages.geometry.arrays import norm
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import RuledPatch, size_of
from stages.geometry.ruled.turning import FOLD, turning
from stages.model.cadface import CadBody, CadFace
from stages.model.material import Part
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import BranchedSurface, Hinge, RuledSurface, Surface, Trim
from stages.model.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class Hinged:
    """A hinge, how far apart its two edges are in space, mm, and whether it closes a ring."""

    hinge: Hinge
    found: Meeting
    gap_mm: float
    closes: bool


def branched(part: Part, body: CadBody, tol: Tolerances) -> Outcome[Surface | None]:
    """Return faces that were found to be one blank as a branched surface, or None with the reason.

    Raises NoSeamError, OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    sides = _numbered(body.faces)
    hinged = [_hinged(sides, body, k) for k in range(len(body.joints))]
    patches = tuple(patch for side in sides for patch in side.patches)
    features = on_faces(part.spec, sides, tol)
    sided = one_sided(part, sides)
    found = (*part.remarks, *features.findings, *([sided] if isinstance(sided, Finding) else []))
    metrics = (*_metrics(sides, hinged, tol), _planar(patches), *features.metrics)
    report = StageReport("construct", part.name, metrics, found, _detail(sides, hinged))
    if isinstance(sided, Finding) or not report.passed:
        return Outcome(None, report)
    faces = tuple(_face(sided, side) for side in sides)
    numbers = tuple(side.face.index for side in sides)
    hinges = tuple(one.hinge for one in hinged)
    return Outcome(BranchedSurface(part, faces, numbers, hinges, size_of(patches), features.features), report)


def _numbered(faces: tuple[CadFace, ...]) -> tuple[Based, ...]:
    """Return faces on their strips, v running on from one to the next."""
    sides: list[Based] = []
    for face in faces:
        side = based(face, sum(len(one.patches) for one in sides))
        if side is None:
            raise ValueError(f"face {face.index} was joined and is not ruled")
        sides.append(side)
    return tuple(sides)


def _face(part: Part, side: Based) -> RuledSurface:
    """Return one face as a trimmed surface."""
    spans = tuple((Fraction(side.first + i), Fraction(side.first + i + 1)) for i in range(len(side.patches)))
    outer, *inner = side.loops.curves
    return RuledSurface(part, side.patches, size_of(side.patches), spans, trim=Trim(outer, tuple(inner)))


def _hinged(sides: tuple[Based, ...], body: CadBody, k: int) -> Hinged:
    """Return a joint of the body by the edges of its faces."""
    joint = body.joints[k]
    one, other = sides[joint.one], sides[joint.other]
    found = meeting(one, other, (joint.one, joint.other), joint.ends)
    if found is None:
        raise ValueError(f"faces {one.face.index} and {other.face.index} were joined and share no edge")
    there = places(other, curve_of(other, found.of_other), ENDS)
    gap = float(norm(found.ends - there[::-1]).max())
    return Hinged(Hinge(joint.one, joint.other, found.of_one, found.of_other), found, gap, k >= len(sides) - 1)


# What is measured


def _metrics(sides: tuple[Based, ...], hinged: list[Hinged], tol: Tolerances) -> tuple[Metric, ...]:
    gap = max(hinged, key=lambda one: one.gap_mm)
    turn = max(hinged, key=lambda one: one.found.angle_rad)
    return (
        Metric("edge_distance_mm", max(side.loops.distance_mm for side in sides), "mm", "sampled", tol.join_mm),
        Metric("join_gap_mm", gap.gap_mm, "mm", "sampled", tol.join_mm, _where(sides, gap)),
        Metric("join_normal_deg", float(np.degrees(turn.found.angle_rad)), "deg", where=_where(sides, turn)),
    )


def _where(sides: tuple[Based, ...], one: Hinged) -> dict[str, float | int | str]:
    return {"face": sides[one.hinge.one].face.index, "other": sides[one.hinge.other].face.index}


def _planar(patches: tuple[RuledPatch, ...]) -> Metric:
    planar, proved = is_planar(patches)
    return Metric("planar", planar, "", "proved" if proved else "sampled")


def _detail(sides: tuple[Based, ...], hinged: list[Hinged]) -> dict[str, object]:
    faces = [{"face": s.face.index, "name": s.face.name, "sort": s.face.sort, "v": s.first} for s in sides]
    joins = [
        {
            "faces": [sides[one.hinge.one].face.index, sides[one.hinge.other].face.index],
            "length_mm": one.found.length_mm,
            "gap_mm": one.gap_mm,
            "normal_deg": float(np.degrees(one.found.angle_rad)),
            "closes_a_ring": one.closes,
        }
        for one in hinged
    ]
    return {"faces": faces, "joins": joins}


# What is refused


def one_sided(part: Part, sides: tuple[Based, ...]) -> Part | Finding:
    """Return the part with its face as the side of the normals; a finding where bends have different sides inside."""
    if part.spec.face not in ("inner", "outer"):
        return part
    bends = [(side.face.index, _bend(side)) for side in sides]
    up, down = ([index for index, angle in bends if sign * angle > FOLD] for sign in (1.0, -1.0))
    if up and down:
        message = (
            f"face {up[0]} bends towards its outward normal and face {down[0]} away from it, so the blank has no inner "
            'and outer face: face = "plus" or "minus" names the side of the outward normals'
        )
        return Finding("face-changes-side", message, True, {"face": up[0], "other": down[0]})
    side = "plus" if (part.spec.face == "inner") == (not down) else "minus"
    return replace(part, spec=with_fields(part.spec, face=side))


def _bend(side: Based) -> float:
    """Return the angle through which a face bends, rad, positive towards its outward normal; 0 where it is not known.

    Verify and unroll say of such a face what is not known.
    """
    try:
        return float(sum(stretch.angle_rad for stretch in turning(side.patches).stretches))
    except NoSolutionError:
        return 0.0
