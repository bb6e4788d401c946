"""Where a mesh bends most, as `bending` measures it: the values alone, without what it takes to measure them."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SharpVertex:
    """The vertex where a mesh bends most one way: its curvature along the bend, 1/mm, and its place."""

    curvature: float
    vertex: int
    place: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class MeshBends:
    """Where a mesh bends most towards its normals and away from them, None where it does not; and how much it does.

    turned: integrals of both curvatures over the mesh, mm: angle times width.
    """

    towards: SharpVertex | None
    away: SharpVertex | None
    turned: tuple[float, float]

    @property
    def ways(self) -> tuple[tuple[float, SharpVertex], ...]:
        """Return the ways in which it bends, +1 towards its normals, with the vertex where it bends most."""
        both = ((1.0, self.towards), (-1.0, self.away))
        return tuple((sign, sharp) for sign, sharp in both if sharp is not None)
