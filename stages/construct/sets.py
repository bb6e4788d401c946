"""Parts of several blanks that are welded together: each blank a part of its own, and the edges that meet.

    parts_of(part) -> its blanks, named `<part>.<n>`; the part itself where it is one blank
    seams_of(part) -> the pairs of edges that must be of one length

An elbow lies in the xz plane: its axis begins at the origin along z and turns towards +x about (bend_radius, 0, 0).
Gore k touches that arc at the bend angle 2 (k - 1) mitre, where its axis has the arc's direction; its ends are planes
through the bend's own axis.  The gores lie where they are in the finished elbow, so that mating edges are one curve.

A tee with its main's opening is the branch and a plate: the saddle of the one goes around the outline of the other.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import cos, radians, sin

from msgspec.structs import replace as with_fields

from stages.model.curves import CurveSpec, EllipseSpec, Table
from stages.model.ducts import Elbow, MainOpening, Tee, is_set
from stages.model.faces import FaceFile
from stages.model.material import Part
from stages.model.meshes import MeshFile
from stages.model.part import Cylinder, PartSpec, Plane
from stages.model.scalars import Coordinate, Length, Number, coordinate


@dataclass(frozen=True, slots=True)
class Edges:
    """Edges of one blank, one after the other: of a ruled part c0, c1, start or end; of a plate the outline."""

    blank: str
    edges: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Seam:
    """Two runs of edges that are welded to each other."""

    one: Edges
    other: Edges


def parts_of(part: Part) -> tuple[Part, ...]:
    """Return the blanks that a part is made of."""
    if isinstance(part.spec.surface, MeshFile):
        from stages.construct.meshes.surface import blanks

        return blanks(part)
    if isinstance(part.spec.surface, FaceFile):
        from stages.construct.faces.surface import face_blanks

        return face_blanks(part)
    if not is_set(part.spec.surface):
        return (part,)
    specs = [
        with_fields(part.spec.blank(n, OUTLINE if isinstance(one, MainOpening) else STRIP), surface=one)
        for n, one in enumerate(_blanks(part.spec.surface), 1)
    ]
    if isinstance(part.spec.surface, Elbow):
        specs = [*(_sewn_on(*pair) for pair in pairwise(specs)), specs[-1]]
    return tuple(replace(part, spec=spec) for spec in specs)


STRIP, OUTLINE = ("c0", "c1", "start", "end"), ("outline",)
"""The edges of a blank that is rolled, and of a plate."""


def _sewn_on(gore: PartSpec, after: PartSpec) -> PartSpec:
    """Return a gore whose seam at its end is sewn to that of the gore after it, unless it is to something else."""
    mate = next((f"{after.name}.{seam.called}" for seam in after.seam if seam.edge == "c0"), None)
    seams = (with_fields(one, mate=mate) if one.edge == "c1" and one.mate is None else one for one in gore.seam)
    return with_fields(gore, seam=tuple(seams))


def _blanks(surface: Table) -> tuple[Table, ...]:
    """Return the surfaces of the blanks of a set."""
    match surface:
        case Elbow():
            return tuple(gore(surface, k) for k in range(surface.gores))
        case Tee():
            return with_fields(surface, hole=False), MainOpening(tee=surface)
    raise ValueError(f"no set of blanks for {type(surface).__name__}")


def seams_of(part: Part) -> tuple[Seam, ...]:
    """Return the seams between the blanks of a part."""
    surface, name = part.spec.surface, part.name
    if not is_set(surface):
        return ()
    if isinstance(surface, Elbow):
        pairs = ((f"{name}.{n}", f"{name}.{n + 1}") for n in range(1, surface.gores))
        return tuple(Seam(Edges(one, ("c1",)), Edges(other, ("c0",))) for one, other in pairs)
    return (Seam(Edges(f"{name}.1", ("c1",)), Edges(f"{name}.2", ("outline",))),)


def gore(elbow: Elbow, k: int) -> Cylinder:
    """Return gore k of an elbow, counted from 0, as a cylinder between two planes."""
    mitre, radius = radians(elbow.mitre), float(elbow.diameter) / 2.0
    here = 2 * k * mitre
    throat = {"throat": True, "heel": False, "staggered": k % 2 == 0}[elbow.seam]
    inwards = (cos(here), 0.0, -sin(here))
    outset = radius if throat else -radius
    centre = tuple(float(elbow.bend_radius) * (x - y) for x, y in zip((1.0, 0.0, 0.0), inwards, strict=True))
    directrix = EllipseSpec(
        center=_point(centre),
        major=_point(tuple(outset * x for x in inwards)),
        minor=_point((0.0, outset, 0.0)),
    )
    return Cylinder(
        directrix=CurveSpec(ellipse=directrix),
        direction=_along(here),
        start_plane=_plane(elbow, here if k == 0 else here - mitre),
        end_plane=_plane(elbow, here if k == elbow.gores - 1 else here + mitre),
    )


def _plane(elbow: Elbow, angle: float) -> Plane:
    """Return the plane through the bend's axis at a bend angle."""
    return Plane(point=(Length(elbow.bend_radius), Length(0), Length(0)), normal=_along(angle))


def _along(angle: float) -> tuple[Number, Number, Number]:
    """Return the direction of the bend's arc at a bend angle."""
    return Number(sin(angle)), Number(0), Number(cos(angle))


def _point(values: tuple[float, ...]) -> tuple[Coordinate, ...]:
    return tuple(coordinate(Fraction(value), None) for value in values)
