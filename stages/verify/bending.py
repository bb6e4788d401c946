"""The sharpest bend of a part, held against what the material allows: smallest inside radius, largest strain.

The radius rho of the surface as given is smallest at an end of a ruling, along which it is linear.  Which face of the
sheet that surface is decides what lies about it (`stages.model.sheetface`): the inside radius is rho less the distance
to the inside face, and the outer fibre is strained by t / (2 rho_m), rho_m the radius of the middle surface.  Bends
towards N = p x S_v and away from it are looked at apart: the face that is inside differs.  Sampled over the patch.

Folds between patches have no radius of their own and do not count.
"""

from dataclasses import dataclass
from math import inf, isfinite

from stages.errors import NoSolutionError
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.tightest import Edge, Tight, apexes, tightest
from stages.geometry.ruled.turning import Turning, turning
from stages.model.material import Material
from stages.model.report import Evidence, Finding, Metric, Where
from stages.model.sheetface import Layers, layers
from stages.model.surface import RuledSurface
from stages.verify import sampled

KNOWN_DIGITS = 13
"""Of a radius, which is measured to some 1e-13 of itself: one that is a material's limit may not fail by rounding."""

UNBENT = 1e-9
"""A part whose largest curvature is below this share of 1/D leaves its plane by less than a nanometre per metre: it has
no radius at all."""


@dataclass(frozen=True, slots=True)
class Sharpest:
    """Radii in mm at the sharpest bend: of the surface as given, the middle surface and the inside face; its place.

    inside_mm is below 0 where the sheet is too thick for the bend.
    """

    given_mm: float
    middle_mm: float
    inside_mm: float
    where: Where

    @classmethod
    def at(cls, given_mm: float, middle_mm: float, inside_mm: float, where: Where) -> "Sharpest":
        """Return a bend by its radii, of which those digits are kept that are known."""
        given, middle, inside = (float(f"{radius:.{KNOWN_DIGITS}g}") for radius in (given_mm, middle_mm, inside_mm))
        return cls(given, middle, inside, where)


def bending(surface: RuledSurface) -> tuple[tuple[Metric, Metric], list[Finding]]:
    """Return the smallest inside radius in mm, the largest strain of the outer fibre, and what the material says.

    Both are None where the part is bent nowhere, the strain also where no thickness is known.
    """
    flat, proved = is_planar(surface.patches)
    if flat:
        return nowhere("proved" if proved else "sampled"), []
    try:
        bends = turning(surface.patches)
    except NoSolutionError:  # a fold inside, or a normal that vanishes: refused elsewhere, its curvature still counts
        bends = None
    found = sharpest(surface, bends)
    if not isinstance(found, Sharpest):
        return nowhere("sampled"), [found] if isinstance(found, Finding) else []
    material = surface.part.material
    points = frozenset() if bends is None else apexes(bends)
    judged = sharpest(surface, bends, points) if points and found.given_mm == 0.0 else found
    # at an apex no strain is defined: that of the other edges counts
    bend = judged if isinstance(judged, Sharpest) else None
    metrics = _metrics(found, bend, material)
    checked = [] if bend is None else _judged(bend, material)
    return metrics, [*checked, *_apex_findings(found, judged), *_unchecked(material)]


def judged_bend(found: Sharpest, material: Material) -> tuple[tuple[Metric, Metric], list[Finding]]:
    """Return smallest inside radius and largest strain of the sharpest bend, and what the material says of it."""
    return _metrics(found, found, material), [*_judged(found, material), *_unchecked(material)]


def _metrics(found: Sharpest, bend: Sharpest | None, material: Material) -> tuple[Metric, Metric]:
    """Return the inside radius of the sharpest bend, and the strain of that which is judged (None: no strain)."""
    strain = None if bend is None or material.thickness_mm is None else _strain(material.thickness_mm, bend.middle_mm)
    shown = strain if strain is not None and strain < inf else None
    return (
        Metric("min_bend_radius_mm", max(found.inside_mm, 0.0), "mm", "sampled", None, found.where),
        Metric("outer_fibre_strain", shown, "", "sampled", material.max_strain, None if bend is None else bend.where),
    )


def _judged(bend: Sharpest, material: Material) -> list[Finding]:
    """Hold the sharpest bend against the material."""
    strain = None if material.thickness_mm is None else _strain(material.thickness_mm, bend.middle_mm)
    radius = _radius_findings(max(bend.inside_mm, 0.0), material, bend)
    return [*radius, *_strain_findings(strain, material, bend.where)]


def _apex_findings(found: Sharpest, judged: Sharpest | Finding | None) -> list[Finding]:
    """Say that the part ends in an apex; its other edges are what the material is asked about."""
    if judged is found:
        return []
    rest = ""
    if isinstance(judged, Sharpest):
        rest = f" (along the other edges the inside radius is at least {max(judged.inside_mm, 0.0):.4g} mm)"
    message = f"rulings meet in an apex, where the sheet is bent to radius 0{rest}: cut the tip off, or crease it"
    return [Finding("sharp-apex", message, False, found.where)]


def nowhere(evidence: Evidence) -> tuple[Metric, Metric]:
    """Return the metrics of a part that is bent nowhere, or that has no face such as the job names."""
    return Metric("min_bend_radius_mm", None, "mm", evidence), Metric("outer_fibre_strain", None, "", evidence)


def sharpest(
    surface: RuledSurface, bends: Turning | None, beside: frozenset[Edge] = frozenset()
) -> Sharpest | Finding | None:
    """Return the sharpest bend, None where there is none; a finding where the face does not exist on the surface.

    bends: how it turns, None where that is not known.  beside: edges that do not count.
    """
    thickness = surface.part.material.thickness_mm or 0.0
    face = surface.part.spec.face
    if bends is None:
        return _unsigned(surface, thickness)
    sheet = layers(face, bends, thickness)
    if isinstance(sheet, Finding):
        v = float((sheet.where or {}).get("v", 0.0))
        piece = min(int(v), len(surface.patches) - 1)
        return Finding(sheet.code, sheet.message, True, {"v": surface.v_of(piece, v - piece)})
    both = [(sign, found) for sign in (1.0, -1.0) if (found := tightest(bends, sign, beside)) is not None]
    every = [_radii(surface, sign, tight, sheet) for sign, tight in both if _bends(tight, surface.size_mm)]
    return min(every, key=lambda bend: bend.inside_mm, default=None)


def _bends(tight: Tight, size_mm: float) -> bool:
    return tight.curvature * size_mm > UNBENT


def _radii(surface: RuledSurface, sign: float, tight: Tight, sheet: Layers) -> Sharpest:
    radius = 1.0 / tight.curvature
    where: Where = {"v": surface.v_of(tight.piece, tight.v), "u": tight.u}
    return Sharpest.at(radius, radius - sign * sheet.middle_mm, radius - sign * sheet.inside_mm(sign), where)


def _unsigned(surface: RuledSurface, thickness: float) -> Sharpest | None:
    """Return the sharpest bend either way, the surface taken for the middle one."""
    found = [sampled.largest_curvature(patch, i) for i, patch in enumerate(surface.patches)]
    worst = max(found, key=lambda extreme: extreme.value)
    if worst.value * surface.size_mm <= UNBENT:
        return None
    radius = 1.0 / worst.value
    where: Where = {"v": surface.v_of(worst.piece, worst.v)}
    if worst.u is not None:
        where["u"] = worst.u
    return Sharpest.at(radius, radius, radius - thickness / 2.0, where)


def _strain(thickness: float, middle_mm: float) -> float:
    return thickness / (2.0 * middle_mm) if middle_mm > 0.0 else inf


def _radius_findings(inside: float, material: Material, found: Sharpest) -> list[Finding]:
    least = material.bend_radius_min_mm
    if least is not None and inside < least:
        message = f"bends to an inside radius of {inside:.4g} mm, the material allows {least:.4g} mm"
        return [Finding("bend-radius", message, True, found.where)]
    if least is None and found.inside_mm < 0.0:
        message = (
            f"the surface bends to a radius of {found.given_mm:.4g} mm: the inside face, {-found.inside_mm:.4g} mm "
            "beyond the centre, would fold over itself"
        )
        return [Finding("inside-radius", message, False, found.where)]
    return []


def _strain_findings(strain: float | None, material: Material, where: Where) -> list[Finding]:
    if material.max_strain is None or strain is None or strain <= material.max_strain:
        return []
    by = f"by {strain:.3%}" if isfinite(strain) else "without bound (the middle of the sheet has no radius left)"
    message = f"the outer fibre stretches {by}, the material allows {material.max_strain:.3%}"
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
