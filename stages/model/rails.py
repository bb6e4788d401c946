"""The kind `rails`: a developable strip between any two curves in space, as a job file asks for it."""

from collections.abc import Iterator
from typing import Literal

from msgspec import field

from stages.model.curves import CurveSpec, PlanePoint, Table, Trouble, negatives, plane_curves
from stages.model.scalars import FULL_TURN, Angle, Length


class Rails(Table, frozen=True, kw_only=True, tag_field="kind", tag="rails"):
    """A developable strip between two rails, both open or both closed.

    Open rails run from first point to last as given; of closed ones the seam and the sense are found.
    folds: whether the strip may fold along rulings where nothing smooth leads on.
    max_warp: folds of at most this angle are always allowed.
    min_radius: above 0, a strip without cones is taken where there is one, else the best; it is refused if it has a
    cone (with its apex on a rail it bends to nothing) or if it bends more sharply along a rail.
    """

    rail_a: CurveSpec
    rail_b: CurveSpec
    folds: Literal["allow", "forbid"] = "forbid"
    max_warp: Angle = field(default_factory=Angle)
    min_radius: Length = field(default_factory=Length)

    def troubles(self) -> Iterator[Trouble]:
        """Yield rails in the plane, one rail twice, and an open rail with a closed one."""
        yield from plane_curves(self, "rail_a", "rail_b")
        if self.rail_a == self.rail_b:
            yield Trouble("rail_b", "the same curve as rail_a", "the two rails must differ")
        yield from negatives(self, "max_warp", "min_radius")
        a, b = closes(self.rail_a), closes(self.rail_b)
        if a is not None and b is not None and a != b:
            words = {True: "closed", False: "open"}
            message = f"rail_a is {words[a]} and rail_b is {words[b]}"
            yield Trouble("rail_b", message, "both must be open, or both closed (last point = first)")


def closes(curve: CurveSpec) -> bool | None:
    """Return whether a curve ends where it begins; None where its data alone do not say so."""
    if curve.circle is not None or curve.ellipse is not None:
        return True
    if curve.arc is not None:
        return bool((curve.arc.end - curve.arc.start) % FULL_TURN == 0)
    if curve.helix is not None:
        return False
    ends = _ends(curve)
    return None if ends is None else ends[0] == ends[1]


def _ends(curve: CurveSpec) -> tuple[PlanePoint, PlanePoint] | None:
    """Return the first and the last point of a curve that names them."""
    points = curve.bezier or curve.points or curve.polyline or curve.line
    if points is not None:
        return points[0], points[-1]
    spline = curve.bspline
    if spline is not None:
        n, knots = spline.degree, spline.knots
        clamped = len(set(knots[: n + 1])) == 1 and len(set(knots[-n - 1 :])) == 1
        return (spline.points[0], spline.points[-1]) if clamped else None
    if curve.chain is not None:
        first, last = _ends(curve.chain[0]), _ends(curve.chain[-1])
        return None if first is None or last is None else (first[0], last[1])
    return None
