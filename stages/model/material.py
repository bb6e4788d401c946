"""The sheet that parts are made of, and a part together with it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from stages.geometry.mesh.mesh import Mesh
from stages.model.cadface import CadBody
from stages.model.kfactor import KFactor
from stages.model.meshes import MeshNormals
from stages.model.part import PartSpec
from stages.model.process import Process
from stages.model.report import Finding


@dataclass(frozen=True, slots=True)
class Material:
    """What is known of the sheet; None: not known, and what depends on it is not computed or checked.

    bend_radius_min_mm: smallest inside radius it can be bent to.
    max_strain: largest strain of the outer fibre, as a fraction.
    yield_strength_mpa, youngs_modulus_gpa: for an estimate of springback.
    """

    name: str = ""
    thickness_mm: float | None = None
    density_kg_m3: float | None = None
    bend_radius_min_mm: float | None = None
    max_strain: float | None = None
    k_factor: KFactor = field(default_factory=KFactor)
    yield_strength_mpa: float | None = None
    youngs_modulus_gpa: float | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """A part as asked for, its material, and how it is cut: what the stages start from.

    body: what the file holds that the part is described by, in mm; None: the specification says it all.
    meshes: those that the specification points at besides, in mm.
    remarks: what was found out about that file before construct.
    """

    spec: PartSpec
    material: Material = Material()
    process: Process = field(default_factory=Process)
    body: Mesh | CadBody | None = None
    remarks: tuple[Finding, ...] = ()
    meshes: Mapping[MeshNormals, Mesh] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the name of the part."""
        return self.spec.name
