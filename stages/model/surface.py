"""A surface as constructed, and the certificate without which nothing is unrolled."""

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import ArrayValue, Numbers, Vector2
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.nearest import OnMesh
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.features import Feature
from stages.model.material import Part
from stages.model.tolerances import Class

Span = tuple[Fraction, Fraction]


def no_pairs() -> Numbers:
    """Return no pairs of vertices, shape (0, 2)."""
    return np.zeros((0, 2), dtype=np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Placed(ArrayValue):
    """A hole, mark or notch where it lies on its surface: in u and v on ruled patches, in x and y (mm) on a plate.

    at: its place, if it has one.  curve: its curve otherwise, as smooth pieces end to end.
    distance_mm: how far from the surface, at most, it was given; None where it was given on the surface.
    on_mesh: on a mesh, instead of both: its place, or the points of its smooth pieces end to end.
    faces: on a branched surface, the face by its place there, for `at` or for each piece of `curve`.
    """

    name: str
    spec: Feature
    at: Vector2 | None = None
    curve: tuple[PlaneCurve, ...] = ()
    distance_mm: float | None = None
    on_mesh: tuple[OnMesh, ...] = ()
    faces: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Trim:
    """The outline of a part that lies inside its patches instead of filling them: closed loops of smooth curves.

    Each curve is an edge in the plane of u and the part's v (its numbers not mm), ending where the next one begins; the
    last one ends where the first begins.  Which way round a loop runs does not count.  u may leave [0, 1] by rounding.
    """

    outer: tuple[PlaneCurve, ...]
    inner: tuple[tuple[PlaneCurve, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class RuledSurface:
    """Ruled patches that follow each other along common rulings.

    size_mm: the diagonal of the bounding box, D.
    spans: the range of the part's v that each patch covers: [i, i + 1] on patch i unless the part has been divided.
    features: what is cut into it and drawn on it, by the part's v; of a piece of a part, all of the whole one's
        but for places on the cut at the piece's end.
    divided: whether this is one blank of a part that was divided.
    trim: its outline and holes, where they are not the four edges of the strip.
    tangencies: the part's v of the rulings where faces that were drawn one by one go over into each other.
    """

    part: Part
    patches: tuple[RuledPatch, ...]
    size_mm: float
    spans: tuple[Span, ...]
    features: tuple[Placed, ...] = ()
    divided: bool = False
    trim: Trim | None = None
    tangencies: tuple[float, ...] = ()

    def v_of(self, piece: int, local: float) -> float:
        """Return the part's v at the place `local` in [0, 1] of a patch."""
        low, high = self.spans[piece]
        return float(low) + local * float(high - low)

    def place_of(self, v: float) -> tuple[int, float]:
        """Return the patch at a place by the part's v, and the place on it in [0, 1]; of two patches the first."""
        piece = next((i for i, (_, high) in enumerate(self.spans) if v <= high), len(self.spans) - 1)
        low, high = self.spans[piece]
        return piece, min(max((v - float(low)) / float(high - low), 0.0), 1.0)


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


@dataclass(frozen=True, slots=True, eq=False)
class MeshSurface:
    """Triangles that make one disc, which may have holes; all of them run alike.

    loops: the vertices of its boundary loops, the surface on their left: the outer one, then the holes.
    seams: both sides of every cut that made it a disc, vertex by vertex and congruent, from one end to the other.
    size_mm: the diagonal of the bounding box.
    features: what is cut into it and drawn on it.
    slits: both sides of every cut that lets it lie flatter, from the boundary to where the cut ends; sewn together.
    kept: pairs of vertices, shape (k, 2): edges of which the pattern keeps the length.
    """

    part: Part
    mesh: Mesh
    loops: tuple[Numbers, ...]
    size_mm: float
    seams: tuple[tuple[Numbers, Numbers], ...] = ()
    features: tuple[Placed, ...] = ()
    slits: tuple[tuple[Numbers, Numbers], ...] = ()
    kept: Numbers = field(default_factory=no_pairs)

    @property
    def straight_loops(self) -> tuple[Numbers, ...]:
        """Return the boundary loops, the sides of every seam straight: both are congruent, so their zigzag cancels."""
        sides = [side[1:-1] for pair in self.seams for side in pair]
        inside = np.concatenate([np.zeros(0, dtype=np.int64), *sides])
        return tuple(loop[~np.isin(loop, inside)] for loop in self.loops)


@dataclass(frozen=True, slots=True)
class Hinge:
    """A straight edge at which two faces of a branched surface, by place, go over into each other.

    of_one, of_other: the edge in the trim of each: the loop (0 the outer one) and the curve in it; the two run opposite
    ways, each with its face on the left.
    """

    one: int
    other: int
    of_one: tuple[int, int]
    of_other: tuple[int, int]


@dataclass(frozen=True, slots=True)
class BranchedSurface:
    """Ruled faces that go over into each other along straight edges in any direction, laid flat as one blank.

    faces: each with a trim, outer loop counter-clockwise in u and v, holes clockwise; the part's v runs on from one to
    the next.  numbers: of the faces in their file.
    hinges: the k-th of the first ones lays face k + 1 against one before it; the others close rings that lie flat.
    features: what is cut into it and drawn on it.
    """

    part: Part
    faces: tuple[RuledSurface, ...]
    numbers: tuple[int, ...]
    hinges: tuple[Hinge, ...]
    size_mm: float
    features: tuple[Placed, ...] = ()


Surface = RuledSurface | Plate | MeshSurface | BranchedSurface


@dataclass(frozen=True, slots=True)
class Certificate:
    """What verify found: the surface itself, its class, and whether that is proved.  Only `verify` makes one.

    flat: of a mesh, the map into the plane on which its class was judged.
    """

    surface: Surface
    reached: Class
    proved: bool
    flat: MeshMap | None = None
