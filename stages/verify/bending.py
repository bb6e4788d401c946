"""The smallest bending radius of a surface, held against what the material allows.

rho is the radius of the middle surface across the rulings; the inside radius is rho - t / 2, the strain of the outer
fibre t / (2 rho).  Sampled over the patch: rho is linear along a ruling, so both edges are enough.
"""

from stages.geometry.planarity import is_planar
from stages.model.material import Material
from stages.model.report import Finding, Metric, Where
from stages.model.surface import RuledSurface
from stages.verify import sampled

STRAIGHT = 1e-9
"""A curvature below this share of 1/D bends the part by less than a nanometre per metre: flat."""


def smallest_radius(surface: RuledSurface) -> tuple[Metric, list[Finding]]:
    """Return the smallest inside bending radius in mm (None: nowhere bent), and what the material says to it."""
    flat, proved = is_planar(surface.patches)
    if flat:
        return Metric("min_bend_radius_mm", None, "mm", "proved" if proved else "sampled"), []
    found = [sampled.largest_curvature(patch, i) for i, patch in enumerate(surface.patches)]
    worst = max(found, key=lambda extreme: extreme.value)
    if worst.value * surface.size_mm <= STRAIGHT:
        return Metric("min_bend_radius_mm", None, "mm"), []
    material = surface.part.material
    middle = 1.0 / worst.value
    inside = max(middle - (material.thickness_mm or 0.0) / 2.0, 0.0)
    metric = Metric("min_bend_radius_mm", inside, "mm", "sampled", None, worst.where)
    findings = [*_radius_findings(inside, material, worst.where), *_strain_findings(middle, material, worst.where)]
    return metric, [*findings, *_unchecked(material)]


def _radius_findings(inside: float, material: Material, where: Where) -> list[Finding]:
    least = material.bend_radius_min_mm
    if least is None or inside >= least:
        return []
    message = f"bends to an inside radius of {inside:.4g} mm, the material allows {least:.4g} mm"
    return [Finding("bend-radius", message, True, where)]


def _strain_findings(middle: float, material: Material, where: Where) -> list[Finding]:
    if material.max_strain is None or material.thickness_mm is None:
        return []
    strain = material.thickness_mm / (2.0 * middle) if middle > 0.0 else float("inf")
    if strain <= material.max_strain:
        return []
    message = f"the outer fibre stretches by {strain:.3%}, the material allows {material.max_strain:.3%}"
    return [Finding("bend-strain", message, True, where)]


def _unchecked(material: Material) -> list[Finding]:
    """Say which limits of the material are not known, and so not checked."""
    known = {
        "smallest bend radius": material.bend_radius_min_mm,
        "largest strain": material.max_strain,
        "thickness": material.thickness_mm,
    }
    missing = [name for name, value in known.items() if value is None]
    if not missing:
        return []
    message = f"bending is measured but not fully checked: the material has no {', no '.join(missing)}"
    return [Finding("bending-not-checked", message)]
