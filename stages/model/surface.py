"""A surface as constructed, and the certificate without which nothing is unrolled."""

from dataclasses import dataclass
from fractions import Fraction

from stages.geometry.arrays import ArrayValue, Vector2
from stages.geometry.plane import PlaneCurve
from stages.geometry.ruled import RuledPatch
from stages.model.features import Feature
from stages.model.material import Part
from stages.model.tolerances import Class

Span = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True, eq=False)
class Placed(ArrayValue):
    """A hole, mark or notch where it lies on its surface: in u and v on ruled patches, in x and y (mm) on a plate.

    at: its place, if it has one.  curve: its curve otherwise, as smooth pieces end to end.
    distance_mm: how far from the surface, at most, it was given; None where it was given on the surface.
    """

    name: str
    spec: Feature
    at: Vector2 | None = None
    curve: tuple[PlaneCurve, ...] = ()
    distance_mm: float | None = None


@dataclass(frozen=True, slots=True)
class RuledSurface:
    """Ruled patches that follow each other along common rulings.

    size_mm: the diagonal of the bounding box, D.
    spans: the range of the part's v that each patch covers: [i, i + 1] on patch i unless the part has been divided.
    features: what is cut into it and drawn on it, by the part's v: on the whole part, also where this is a piece of it.
    divided: whether this is one blank of a part that was divided.
    """

    part: Part
    patches: tuple[RuledPatch, ...]
    size_mm: float
    spans: tuple[Span, ...]
    features: tuple[Placed, ...] = ()
    divided: bool = False

    def v_of(self, piece: int, local: float) -> float:
        """Return the part's v at the place `local` in [0, 1] of a patch."""
        low, high = self.spans[piece]
        return float(low) + local * float(high - low)


def whole_spans(count: int) -> tuple[Span, ...]:
    """Return the spans of the patches of an undivided part."""
    return tuple((Fraction(i), Fraction(i + 1)) for i in range(count))


@dataclass(frozen=True, slots=True)
class Plate:
    """A plane part: closed edges in its own plane, outline counter-clockwise, holes clockwise, mm."""

    part: Part
    outline: tuple[PlaneCurve, ...]
    holes: tuple[tuple[PlaneCurve, ...], ...]
    size_mm: float
    features: tuple[Placed, ...] = ()


Surface = RuledSurface | Plate


@dataclass(frozen=True, slots=True)
class Certificate:
    """What verify found: the surface itself, its class, and whether that is proved.  Only `verify` makes one."""

    surface: Surface
    reached: Class
    proved: bool
