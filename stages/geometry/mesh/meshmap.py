"""A mesh laid into the plane, as `flat` hands it back: the value alone, without what it takes to make one."""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.arrays import Array, ArrayValue, Points2

Kind = Literal["curved", "chord"]


@dataclass(frozen=True, slots=True, eq=False)
class MeshMap(ArrayValue):
    """A mesh in the plane.

    positions: of the vertices, mm.
    lengths: of the edges in the order of `edges_of`, mm.
    strains: principal strains of every triangle against these lengths, shape (m, 2), the larger first.
    noise_mm: median of the standard deviations of the heights of vertices over the fits around them.
    kind: whether the lengths are those on the fitted surface or those of the chords.
    reached_mm: how far the last step moved a vertex at most.
    """

    positions: Points2
    lengths: Array
    strains: Array
    noise_mm: float
    kind: Kind
    reached_mm: float
