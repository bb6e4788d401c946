"""Strips of the paper's patches as a job file describes them: patch after patch (Theorem 3.1), or through points."""

from collections.abc import Iterator
from typing import Annotated

from msgspec import Meta, field

from stages.model.caps import MOST_PIECES
from stages.model.curves import Table, Trouble
from stages.model.quintics import (
    QuinticCone,
    QuinticCylinder,
    QuinticPlanar,
    QuinticRuled,
    bad_fraction,
    zero_normals,
    zero_tangents,
)
from stages.model.scalars import Curvature, Direction, Length, Number, Point, is_zero


class NextPatch(Table, frozen=True, kw_only=True):
    """The new end of a further patch of a `quintic-strip`; which keys it needs depends on the first patch.

    After a cylinder: p1 t1 n1 k1 alpha1 s1 g.  After a cone: p1 t1 n1 k1 alpha1 beta1.  After a ruled patch: the same
    as after a cone plus q1 and the second directrix's values with `_hat`.
    """

    p1: Point
    t1: Direction
    n1: Direction
    k1: Curvature
    alpha1: Length
    s1: Number | None = None
    g: Number | None = None
    beta1: Length | None = None
    q1: Point | None = None
    t1_hat: Direction | None = None
    n1_hat: Direction | None = None
    k1_hat: Curvature | None = None
    alpha1_hat: Length | None = None
    beta1_hat: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a zero tangent or normal."""
        yield from zero_tangents(self, "t1")
        yield from zero_normals(self, "1")


HAT_KEYS = ("q1", "t1_hat", "n1_hat", "k1_hat", "alpha1_hat", "beta1_hat")
NEXT_KEYS: dict[type[Table], tuple[str, ...]] = {
    QuinticCylinder: ("s1", "g"),
    QuinticCone: ("beta1",),
    QuinticRuled: ("beta1", *HAT_KEYS),
    QuinticPlanar: ("beta1", *HAT_KEYS),
}
"""The keys of `NextPatch` that a patch after one of these kinds needs, beside those that every patch has."""


class Station(Table, frozen=True, kw_only=True):
    """A point that a strip runs through, with unit tangent, unit normal and curvature of its first edge there."""

    point: Point
    tangent: Direction
    normal: Direction = field(default_factory=lambda: (Number(0), Number(0), Number(0)))
    k: Curvature = field(default_factory=lambda: Curvature(0))

    def troubles(self) -> Iterator[Trouble]:
        """Yield a zero tangent, and a zero normal where the curvature is not 0."""
        yield from zero_tangents(self, "tangent")
        if is_zero(self.normal) and self.k != 0:
            yield Trouble("normal", "the normal has length 0 but k is not 0", "give the normal, or k = 0")


class QuinticStrip(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-strip"):
    """Theorem 3.1: patches joined with equal derivatives (`first`, `next`); or a strip `through` given points, G2.

    through: the points in order, each with the end data of (2.2); shape parameters of least strain energy.
    ruling: the ruling, the same everywhere, for a cylinder; apex and fraction: for a cone, as in `quintic-cone`.
    """

    first: QuinticCylinder | QuinticCone | QuinticRuled | QuinticPlanar | None = None
    next: Annotated[tuple[NextPatch, ...], Meta(min_length=1, max_length=MOST_PIECES)] | None = None
    through: Annotated[tuple[Station, ...], Meta(min_length=2, max_length=MOST_PIECES)] | None = None
    ruling: Point | None = None
    apex: Point | None = None
    fraction: tuple[Number, Number] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield keys of both ways to describe a strip, and what each way lacks or cannot use."""
        if self.through is not None:
            yield from self._through_troubles(self.through)
            return
        for key in ("ruling", "apex", "fraction"):
            if getattr(self, key) is not None:
                yield Trouble(key, "not used without through", "leave it out")
        if self.first is None or self.next is None:
            missing = "first" if self.first is None else "next"
            yield Trouble(missing, "missing", "give first and next, or through with a ruling or an apex")
        else:
            yield from self._next_troubles(self.first, self.next)
        if isinstance(self.first, QuinticRuled) and self.first.directrix_geodesic:
            yield Trouble("first.directrix_geodesic", "no patch of Theorem 3.1", "join it to others as a strip's piece")

    def _through_troubles(self, stations: tuple[Station, ...]) -> Iterator[Trouble]:
        for key in ("first", "next"):
            if getattr(self, key) is not None:
                yield Trouble(key, "given beside through", "either first and next, or through")
        for i in range(1, len(stations)):
            if stations[i].point == stations[i - 1].point:
                yield Trouble(f"through[{i}].point", "the point repeats the one before", "leave one of them out")
        if (self.ruling is None) == (self.apex is None):
            yield Trouble("ruling", "exactly one of ruling and apex", "a ruling for a cylinder, an apex for a cone")
        if self.ruling is not None and is_zero(self.ruling):
            yield Trouble("ruling", "the ruling has length 0", "give the vector along which the rulings run")
        if self.fraction is not None and self.apex is None:
            yield Trouble("fraction", "not used without an apex", "leave it out")
        yield from bad_fraction(self.range_kept())

    def range_kept(self) -> tuple[Number, Number]:
        """Return which part of the way to the apex is kept."""
        return self.fraction or (Number(0), Number(1))

    @staticmethod
    def _next_troubles(first: Table, following: tuple[NextPatch, ...]) -> Iterator[Trouble]:
        wanted = NEXT_KEYS[type(first)]
        kind = first.__struct_config__.tag
        for i, patch in enumerate(following):
            for key in ("s1", "g", "beta1", *HAT_KEYS):
                given = getattr(patch, key) is not None
                if given and key not in wanted:
                    yield Trouble(f"next[{i}].{key}", f"not used after a {kind}", f"it takes {', '.join(wanted)}")
                if not given and key in wanted:
                    yield Trouble(f"next[{i}].{key}", f"missing after a {kind}", f"it takes {', '.join(wanted)}")
