"""What cutting a part takes: its mass, the length of its contours, and how often the beam pierces the sheet."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import fsum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stages.model.pattern import FlatPattern

MM3_PER_M3 = 1e9


@dataclass(frozen=True, slots=True)
class Figures:
    """Figures of one or more parts; mass_kg is None where thickness or density is not known."""

    mass_kg: float | None
    cut_length_mm: float
    pierces: int


def figures(pattern: "FlatPattern", area_mm2: float) -> Figures:
    """Return the figures of one copy: mass from the exact area, the rest from the lines and arcs that are cut."""
    from stages.geometry.paths.arcpath import length

    paths = [contour.path for contour in (pattern.outer, *pattern.inner)]
    paths += [mark.path for mark in pattern.marks if mark.layer == "CUT_SLIT"]
    thickness, density = pattern.thickness_mm, pattern.density_kg_m3
    mass = None if thickness is None or density is None else area_mm2 * thickness * density / MM3_PER_M3
    return Figures(mass, fsum(length(path) for path in paths), len(paths))


def total(parts: Sequence[Figures]) -> Figures:
    """Return the sum over some parts."""
    masses = [part.mass_kg for part in parts if part.mass_kg is not None]
    mass = fsum(masses) if len(masses) == len(parts) else None
    return Figures(mass, fsum(part.cut_length_mm for part in parts), sum(part.pierces for part in parts))
