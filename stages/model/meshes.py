"""A part that arrives as a triangle mesh in a file."""

from collections.abc import Iterator
from typing import Annotated, Literal

from msgspec import Meta

from stages.model.curves import Table, Trouble
from stages.model.scalars import Point

MeshUnit = Literal["mm", "cm", "m", "um", "in", "ft"]


class MeshFile(Table, frozen=True, kw_only=True, tag_field="kind", tag="mesh"):
    """A triangle mesh: STL, OBJ, PLY, OFF or 3MF; each piece of it that hangs together is a blank of its own.

    file: seen from the job file; names that begin with "sample:" are meshes that come with planish.
    units: of the file; absent: what the file says (3MF does), else the units of the job.
    recognise: planes, cylinders, cones and rulings are looked for, and what is found is unrolled by them.
    seam: points, in the units of the job, near which a closed or annular mesh is cut; absent: the shortest way.
    """

    file: Annotated[str, Meta(min_length=1, max_length=500)]
    units: MeshUnit | None = None
    recognise: bool = True
    seam: Annotated[tuple[Point, ...], Meta(min_length=2)] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a seam without length."""
        if self.seam is not None and len(set(self.seam)) == 1:
            yield Trouble("seam", "all its points coincide", "give at least two different points")
