"""A triangle mesh: where its vertices lie and which three make each triangle.

Nothing is promised but that the numbers name vertices: what a file holds may be in pieces, turned inside out, or worse;
`topology` and `repair` say what it is.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points3, Triples


@dataclass(frozen=True, slots=True, eq=False)
class Mesh(ArrayValue):
    """Triangles in space.

    vertices: shape (n, 3), mm.
    faces: shape (m, 3), numbers of vertices, counter-clockwise seen from the outside.
    """

    vertices: Points3
    faces: Triples

    def check(self) -> None:
        """Raise ValueError where a face names a vertex that is not there, or a vertex is not finite."""
        if self.faces.size and not (self.faces.min() >= 0 and self.faces.max() < len(self.vertices)):
            raise ValueError("a face names a vertex that is not there")
        if not np.all(np.isfinite(self.vertices)):
            raise ValueError("a vertex is not finite")
