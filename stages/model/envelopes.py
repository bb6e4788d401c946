"""Bands along a curve as a job file describes them: straps and ribbons.

The rulings are not given: they follow from the planes that the band is to touch along its curve.
"""

from collections.abc import Iterator
from typing import Annotated

from msgspec import Meta

from stages.model.caps import MOST_POINTS
from stages.model.curves import CurveSpec, Table, Trouble, not_positive, plane_curves
from stages.model.meshes import MeshNormals
from stages.model.scalars import Direction, Length, is_zero


class Strap(Table, frozen=True, kw_only=True, tag_field="kind", tag="strap"):
    """A straight strip bent along a curve in space, its centre line: the rectifying developable."""

    centre: CurveSpec
    half_width: Length

    def troubles(self) -> Iterator[Trouble]:
        """Yield a centre curve that is not in space and a width that is not above 0."""
        yield from plane_curves(self, "centre")
        yield from not_positive(self, "half_width")


class Ribbon(Table, frozen=True, kw_only=True, tag_field="kind", tag="ribbon"):
    """A band along a curve that touches the surface with these normals there.

    normals: one for each of the curve's `points`; for a curve of another sort at equal steps of its parameter, first
        and last at its ends.  Between them the C2 cubic spline, made perpendicular to the curve.  Or the file of a
        mesh that the curve lies on, whose normals are taken.
    width: in all, half of it on either side; widths: left and right of travel, the normals being up.  Both across the
        curve in the flat.
    """

    curve: CurveSpec
    normals: Annotated[tuple[Direction, ...], Meta(min_length=2, max_length=MOST_POINTS)] | MeshNormals
    width: Length | None = None
    widths: tuple[Length, Length] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield normals that are too few, too many or zero, and widths that make no band."""
        yield from plane_curves(self, "curve")
        if not isinstance(self.normals, MeshNormals):
            yield from self._list_troubles(self.normals)
        if (self.width is None) == (self.widths is None):
            yield Trouble("width", "exactly one of width and widths", "width in all, or widths = [left, right]")
        yield from not_positive(self, "width")
        if self.widths is not None and (min(self.widths) < 0 or max(self.widths) == 0):
            yield Trouble("widths", "a negative width, or none at all", "at least 0 each, one of them above 0")

    def _list_troubles(self, normals: tuple[Direction, ...]) -> Iterator[Trouble]:
        points = self.curve.points
        if points is not None and len(points) != len(normals):
            yield Trouble("normals", f"{len(normals)} normals for {len(points)} points", "one for each point")
        for i, normal in enumerate(normals):
            if is_zero(normal):
                yield Trouble(f"normals[{i}]", "the vector has length 0", "give the direction across the surface")

    @property
    def sides(self) -> tuple[float, float]:
        """Return the widths left and right of the curve, mm."""
        left, right = self.widths or (self.width or 0, self.width or 0)
        share = 1.0 if self.widths else 0.5
        return share * float(left), share * float(right)
