"""A surface as constructed, and the certificate without which nothing is unrolled."""

from dataclasses import dataclass

from stages.geometry.plane import PlaneCurve
from stages.geometry.ruled import RuledPatch
from stages.model.material import Part
from stages.model.tolerances import Class


@dataclass(frozen=True, slots=True)
class RuledSurface:
    """Ruled patches that follow each other along common rulings; v runs over [i, i + 1] on patch i.

    size_mm: the diagonal of the bounding box, D.
    """

    part: Part
    patches: tuple[RuledPatch, ...]
    size_mm: float


@dataclass(frozen=True, slots=True)
class Plate:
    """A plane part: closed edges in its own plane, outline counter-clockwise, holes clockwise, mm."""

    part: Part
    outline: tuple[PlaneCurve, ...]
    holes: tuple[tuple[PlaneCurve, ...], ...]
    size_mm: float


Surface = RuledSurface | Plate


@dataclass(frozen=True, slots=True)
class Certificate:
    """What verify found: the surface itself, its class, and whether that is proved.  Only `verify` makes one."""

    surface: Surface
    reached: Class
    proved: bool
