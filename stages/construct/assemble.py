"""Each kind of ruled surface: its patches, what its theorem asks for, and what is found wrong.

One function per kind, chosen by the type of its specification.  Those of cones, cylinders and ruled surfaces are loaded
with this module, the others where they are called: a job has few kinds.
"""

from collections.abc import Mapping
from dataclasses import replace

from stages.construct.apex import apex_findings
from stages.construct.built import Built
from stages.construct.curves import Chain, chain, largest_gap, ruled_patches
from stages.construct.cutcone import cut_cone, cut_frustum
from stages.construct.plain import cone_patches, cylinder_patches, directrix_of, frustum
from stages.construct.quintic import vector
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.developables import BezierPair, Slope, Tangent
from stages.model.ducts import Tee, Transition
from stages.model.envelopes import Ribbon, Strap
from stages.model.meshes import MeshNormals
from stages.model.part import Cone, Cylinder, Ruled, Strip, SurfaceSpec
from stages.model.quintics import (
    QuinticCone,
    QuinticCylinder,
    QuinticPlanar,
    QuinticRuled,
)
from stages.model.quinticstrip import QuinticStrip
from stages.model.rails import Rails
from stages.model.report import Finding
from stages.model.tolerances import Tolerances


def patches_of(spec: SurfaceSpec, tol: Tolerances, meshes: Mapping[MeshNormals, Mesh]) -> Built:
    """Return the patches of a ruled kind; meshes: those that it points at."""
    match spec:
        case QuinticRuled() | QuinticPlanar() | QuinticCylinder() | QuinticCone() | QuinticStrip():
            from stages.construct.paper import paper_kind

            return paper_kind(spec, tol)
        case Ruled():
            c0, c1 = chain(spec.c0), chain(spec.c1)
            return Built(ruled_patches(c0, c1), findings=(*_open("c0", c0, tol), *_open("c1", c1, tol)))
        case Cone() if spec.directrix is None:
            return Built((frustum(spec),)) if not _is_cut(spec) else _made(cut_frustum(spec, frustum(spec)))
        case Cone():
            link = directrix_of(spec)
            return _joined("directrix", link, _cone(spec, link), tol)
        case Cylinder() if spec.saddle is not None:
            from stages.construct.saddles import saddled_cylinder

            patches, findings = saddled_cylinder(spec, spec.saddle)
            return Built(patches, findings=findings)
        case Cylinder():
            link = directrix_of(spec)
            return Built(cylinder_patches(spec, link), findings=_open("directrix", link, tol))
        case BezierPair():
            from stages.construct.bezierpair import bezier_pair

            pair, refusals = bezier_pair(spec)
            return Built((pair,), findings=refusals)
        case Tangent() | Slope() | Strap() | Ribbon():
            return _along_curve(spec, tol, meshes)
        case Rails():
            from stages.construct.railkind import rail_strip

            return rail_strip(spec, tol)
        case Transition():
            from stages.construct.transition import transition

            patches, findings = transition(spec)
            return Built(patches, findings=findings)
        case Tee():
            from stages.construct.saddles import tee

            patches, findings = tee(spec)
            return Built(patches, findings=findings)
        case Strip():
            from stages.construct.pieces import strip_of

            return strip_of([patches_of(piece, tol, meshes) for piece in spec.pieces], tol)
    raise ValueError(f"no construction for {type(spec).__name__}")


def _along_curve(spec: Tangent | Slope | Strap | Ribbon, tol: Tolerances, meshes: Mapping[MeshNormals, Mesh]) -> Built:
    """Return the patches of a kind that one curve carries."""
    match spec:
        case Tangent():
            from stages.construct.tangent import tangent_surface

            link = chain(spec.edge)
            patches, refusals = tangent_surface(spec, link, tol)
            return Built(patches, findings=(*_open("edge", link, tol), *refusals))
        case Slope():
            from stages.construct.slope import slope

            link = chain(spec.curve)
            patches, measured, refusals = slope(spec, link, tol)
            return Built(patches, measured, (*_open("curve", link, tol), *refusals))
        case Strap():
            from stages.construct.straps import strap

            link = chain(spec.centre)
            return _joined("centre", link, strap(spec, link, tol), tol)
        case Ribbon():
            from stages.construct.ribbons import ribbon

            link = chain(spec.curve)
            return _joined("curve", link, ribbon(spec, link, tol, meshes), tol)


def _cone(spec: Cone, link: Chain) -> Built:
    """Return a cone over a directrix, cut by planes or by fractions of the way to its apex."""
    if _is_cut(spec):
        return _made(cut_cone(spec, link.curves))
    return Built(cone_patches(spec, link), findings=apex_findings(link.curves, vector(spec.apex or ())))


def _is_cut(spec: Cone) -> bool:
    return spec.start_plane is not None or spec.end_plane is not None


def _made(made: tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]) -> Built:
    return Built(made[0], findings=made[1])


def _joined(key: str, link: Chain, built: Built, tol: Tolerances) -> Built:
    """Return what was built over a chain, with the finding that the chain is open if it is."""
    return replace(built, findings=(*_open(key, link, tol), *built.findings))


def _open(key: str, link: Chain, tol: Tolerances) -> tuple[Finding, ...]:
    gap = largest_gap(link)
    if gap <= tol.join_mm:
        return ()
    return (Finding("chain-open", f"{key}: the pieces of the chain are {gap:.4g} mm apart", fatal=True),)
