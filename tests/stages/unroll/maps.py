"""Flat maps, honest and with a fault planted, and what is measured of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development, FlatPiece
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.surface import RuledSurface, whole_spans
from stages.model.tolerances import Tolerances
from stages.unroll.distortion import Distortion, measure
from tests.parts import (
    AUMANN_CUBIC,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    part,
    patches,
)

HONEST = 1e-11
"""What an honest map may show, as asked; random patches with up to 50 panels reach 7e-13."""
SEEN = 10 * HONEST
"""A fault must show above this."""
TOL = Tolerances()
SHAPES: dict[str, Table] = {
    "tangent surface": QUINTIC_TANGENT, "aumann": AUMANN_CUBIC, "oblique cone": OBLIQUE_CONE,
    "cylinder": EXAMPLE_2_CYLINDER, "plane, singular end rulings": EXAMPLE_1, "elliptic cylinder": ELLIPTIC_CYLINDER,
    "mitred cylinder": MITRED_CYLINDER, "cone to its apex": RIGHT_FRUSTUM | {"radius1": 0},
    "cone from its apex": RIGHT_FRUSTUM | {"radius0": 0},
}  # fmt: skip
FAULTY = ["tangent surface", "aumann", "oblique cone"]
PLATE: Table = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [0, 3, 0]]}, "c1": {"line": [[4, 0, 0], [4, 3, 0]]}}
"""A rectangle of 4 by 3 mm whose flat pattern lies as it is: its distortion is that of whatever is done to it after."""


def surface(made: tuple[RuledPatch, ...]) -> RuledSurface:
    return RuledSurface(part(PLATE), made, 1.0, whole_spans(len(made)))


def distortion(made: Development) -> Distortion:
    return measure(surface(tuple(piece.patch for piece in made.pieces)), made, TOL)


def value(found: Distortion, name: str) -> float:
    (metric,) = (metric for metric in found.metrics if metric.name == name)
    assert isinstance(metric.value, float)
    return metric.value


def where(found: Distortion, name: str) -> dict[str, object]:
    (metric,) = (metric for metric in found.metrics if metric.name == name)
    assert metric.where is not None
    return dict(metric.where)


def of(table: Table) -> Development:
    return develop(patches(table))


def deformed(matrix: list[list[float]]) -> Distortion:
    return distortion(changed(of(PLATE), linear(matrix)))


Change = Callable[[Array], Array]


@dataclass(frozen=True, slots=True)
class Changed:
    """A flat map followed by a map of the plane onto itself; `only` leaves positions or chords as they were."""

    honest: FlatPiece
    change: Change
    only: str = "both"

    @property
    def patch(self) -> RuledPatch:
        return self.honest.patch

    @property
    def breaks(self) -> Array:
        return self.honest.breaks

    def positions(self, u: Array, v: Array) -> Array:
        honest = self.honest.positions(u, v)
        return honest if self.only == "chords" else self.change(honest)

    def chords(self, u0: Array, v0: Array, u: Array, v: Array) -> Array:
        if self.only == "positions":
            return self.honest.chords(u0, v0, u, v)
        begin = self.honest.positions(u0, v0)
        return self.change(begin + self.honest.chords(u0, v0, u, v)) - self.change(begin)

    def velocities(self, u: Array, v: Array) -> Array:
        return self.honest.velocities(u, v)


def changed(made: Development, change: Change, only: str = "both") -> Development:
    """Return the flat map followed by a map of the plane."""
    return Development(tuple(Changed(piece, change, only) for piece in made.pieces))


def linear(matrix: list[list[float]]) -> Change:
    rows = np.array(matrix)
    return lambda points: points @ rows.T
