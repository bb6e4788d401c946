"""Which face of the sheet a surface is, and so where the sheet lies about it.

Distances along the normal N of p x S_v, from the surface as given: the sheet reaches from `minus_mm` to `plus_mm`.
`inner` is the face on the concave side, `outer` the one on the convex side: on a surface that bends towards N the inner
face is the plus face.  A surface that bends both ways has neither, and takes `plus` or `minus`; one that does not bend
unrolls alike whatever its face.
"""

from dataclasses import dataclass
from itertools import pairwise

from stages.geometry.mesh.bends import MeshBends
from stages.geometry.ruled.turning import FLAT, FOLD, Turning
from stages.model.face import Face
from stages.model.report import Finding


@dataclass(frozen=True, slots=True)
class Layers:
    """Offsets of both faces of the sheet from the surface as given, mm, towards N positive."""

    minus_mm: float
    plus_mm: float

    @property
    def thickness_mm(self) -> float:
        """Return the thickness, mm."""
        return self.plus_mm - self.minus_mm

    @property
    def middle_mm(self) -> float:
        """Return the offset of the middle surface, mm."""
        return (self.plus_mm + self.minus_mm) / 2.0

    def inside_mm(self, sign: float) -> float:
        """Return the offset of the face that is inside where the surface bends towards sign * N, mm."""
        return self.plus_mm if sign > 0.0 else self.minus_mm

    def neutral_mm(self, sign: float, k: float) -> float:
        """Return the offset of the neutral surface where it bends towards sign * N: K t from the inside face, mm."""
        return self.inside_mm(sign) - sign * k * self.thickness_mm


def layers(face: Face, bends: Turning, thickness_mm: float) -> Layers | Finding:
    """Return where the sheet lies, or the finding that the surface has no inner and outer face."""
    towards = sum(stretch.angle_rad for stretch in bends.stretches) >= 0.0
    both = bends_both_ways(bends) if face in ("inner", "outer") else None
    return about(face, thickness_mm, towards=towards) if both is None else both


def mesh_layers(face: Face, bends: MeshBends, thickness_mm: float) -> Layers | Finding:
    """Return where the sheet lies about a mesh, N its normals; or the finding that it has no inner and outer face."""
    towards, away = bends.turned
    if face in ("inner", "outer") and bends.towards and bends.away and min(towards, away) > LITTLE * (towards + away):
        less = bends.towards if towards < away else bends.away
        x, y, z = less.place
        message = (
            f"the mesh bends both ways, so it has no inner and outer face: most of it bends the other way than at "
            f'({x:.6g}, {y:.6g}, {z:.6g}); face = "plus" or "minus" names the side of its normals'
        )
        return Finding("face-changes-side", message, True, {"x": x, "y": y, "z": z})
    return about(face, thickness_mm, towards=towards >= away)


LITTLE = 0.02
"""Share of the bending of a mesh that may go the other way: errors of its fitted curvatures do."""


def about(face: Face, thickness_mm: float, *, towards: bool) -> Layers:
    """Return where the sheet lies about a surface that has both faces; towards: whether it bends towards N."""
    side = face if face not in ("inner", "outer") else "plus" if (face == "inner") == towards else "minus"
    low = {"middle": -0.5, "plus": -1.0, "minus": 0.0}[side] * thickness_mm
    return Layers(low, low + thickness_mm)


def bends_both_ways(bends: Turning) -> Finding | None:
    """Return the finding that a surface has no concave side, with the places where its curvature changes sign."""
    signs = [(s.piece + s.low, s.angle_rad) for s in bends.stretches]
    ways = [sum(max(sign * angle, 0.0) for _, angle in signs) for sign in (1.0, -1.0)]
    if min(ways) <= FOLD:
        return None
    clear = [(v, angle > 0.0) for v, angle in signs if abs(angle) > FLAT]
    changes = [b for (_, a_way), (b, b_way) in pairwise(clear) if a_way != b_way]
    where = ", ".join(f"{v:.6g}" for v in changes[:MOST_NAMED]) + (" ..." if len(changes) > MOST_NAMED else "")
    message = (
        f"the surface bends both ways, so it has no inner and outer face: its curvature changes sign at v = {where}; "
        'face = "plus" or "minus" names the side of p x c0\''
    )
    return Finding("face-changes-side", message, True, {"v": changes[0]})


MOST_NAMED = 8
"""Places named in a message; the bend table has them all."""
