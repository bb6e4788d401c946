"""A part that arrives as a triangle mesh in a file."""

from collections.abc import Iterator
from typing import Annotated, Literal

from msgspec import Meta

from stages.model.caps import MOST_PIECES, MOST_POINTS
from stages.model.curves import Table, Trouble
from stages.model.scalars import Point

MeshUnit = Literal["mm", "cm", "m", "um", "in", "ft"]
Polyline = Annotated[tuple[Point, ...], Meta(min_length=2, max_length=MOST_POINTS)]


class MeshFile(Table, frozen=True, kw_only=True, tag_field="kind", tag="mesh"):
    """A triangle mesh: STL, OBJ, PLY, OFF or 3MF; each piece of it that hangs together is a blank of its own.

    file: seen from the job file; names that begin with "sample:" are meshes that come with planish.
    units: of the file; absent: what the file says (3MF does), else the units of the job.
    recognise: planes, cylinders, cones and rulings are looked for, and what is found is unrolled by them.
    seam: points, in the units of the job, near which a closed or annular mesh is cut; absent: the shortest way.
    keep: lengths that the pattern keeps exactly: of the whole outline, or along the edges near lines of such points.
    cuts: lines of such points near which it is slit, from its boundary inwards; a part with cuts is not recognised.
    """

    file: Annotated[str, Meta(min_length=1, max_length=500)]
    units: MeshUnit | None = None
    recognise: bool = True
    seam: Polyline | None = None
    keep: Literal["none", "outline"] | Annotated[tuple[Polyline, ...], Meta(max_length=MOST_PIECES)] = "none"
    cuts: Annotated[tuple[Polyline, ...], Meta(max_length=MOST_PIECES)] = ()

    @property
    def kept_lines(self) -> tuple[tuple[Point, ...], ...]:
        """Return the lines near which lengths are kept, where lines are given."""
        return () if isinstance(self.keep, str) else self.keep

    def troubles(self) -> Iterator[Trouble]:
        """Yield lines without length."""
        lines = {f"keep[{i}]": line for i, line in enumerate(self.kept_lines)}
        lines |= {f"cuts[{i}]": line for i, line in enumerate(self.cuts)}
        if self.seam is not None:
            lines["seam"] = self.seam
        for key, line in lines.items():
            if len(set(line)) == 1:
                yield Trouble(key, "all its points coincide", "give at least two different points")


class MeshNormals(Table, frozen=True, kw_only=True):
    """A mesh that a curve lies on, to take its normals from.

    file: seen from the job file; names that begin with "sample:" are meshes that come with planish.
    units: of the file; absent: what the file says (3MF does), else the units of the job.
    """

    file: Annotated[str, Meta(min_length=1, max_length=500)]
    units: MeshUnit | None = None
