"""How far points are off the faces of a strip: roughly, by a lattice on it, or by feet near known ones.

For whoever moves points about and asks again and again (`bestfit`); feet that are sought on the whole surface are those
of `feet`.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from stages.geometry.arrays import Array, Points2, Points3, Values, Vector3, cross3, dot, norm, unit
from stages.geometry.ruled.feet import Feet, at_places, off_faces
from stages.geometry.ruled.nearest import by_rulings, nearest_within
from stages.geometry.ruled.strip import Jet, Strip, jet, size

ACROSS, ALONG = 13, 121
"""Places of the lattice across the strip and, at least, along it.  It gives starts; nothing is measured against it."""
HALVINGS = 20
"""Of the step of the lattice: a foot that is off by 1e-8 of a patch leaves its distance as it is, to 1e-16."""


class Off(NamedTuple):
    """How far points are off, mm, in which directions of length 1, shape (n, 3), and the v of their feet."""

    distance: Values
    along: Points3
    v: Values

    @property
    def rms(self) -> float:
        """Return the root of the mean of the squares, mm."""
        return root_mean_square(self.distance)


@dataclass(frozen=True, eq=False)
class Target:
    """What points are fitted to: a strip, heights above it, mm, and a lattice on it."""

    strip: Strip
    heights: Values

    @cached_property
    def scale(self) -> float:
        """Return the size of the strip, mm."""
        return size(self.strip)

    @property
    def per_patch(self) -> int:
        """Return how many places of the lattice there are along each patch."""
        return max(-(-ALONG // len(self.strip.patches)), 3)

    @cached_property
    def step(self) -> float:
        """Return the longest step of the lattice along the strip, in v."""
        return float(np.diff(self.strip.knots).max()) / (self.per_patch - 1)

    @cached_property
    def places(self) -> Points2:
        """Return the places (u, v) of the lattice."""
        v = np.concatenate([np.linspace(a, b, self.per_patch) for a, b in pairwise(self.strip.knots)])
        u, v = (one.ravel() for one in np.meshgrid(np.linspace(0.0, 1.0, ACROSS), v))
        return np.stack([u, v], axis=1)

    @cached_property
    def lattice(self) -> Jet:
        """Return the surface at the places of the lattice."""
        return jet(self.strip, *self.places.T)

    @cached_property
    def tree(self) -> cKDTree:
        """Return what finds the nearest point of the lattice."""
        return cKDTree(self.lattice.s)

    @cached_property
    def normals(self) -> Points3:
        """Return the normals there, of length 1."""
        return np.asarray(unit(cross3(self.lattice.s_u, self.lattice.s_v)))

    @cached_property
    def reach(self) -> Values:
        """Return how far each place of the lattice stands for the surface about it, mm."""
        return np.asarray(np.maximum(norm(self.lattice.s_u) / (ACROSS - 1), norm(self.lattice.s_v) * self.step))

    @cached_property
    def axes(self) -> tuple[Vector3, Array]:
        """Return middle and principal axes, in rows, of the surface, by area."""
        area = norm(cross3(self.lattice.s_u, self.lattice.s_v))
        return principal_axes(self.lattice.s, area / area.sum())

    def rough(self, points: Points3, _: Values | None = None) -> Off:
        """Return how far points are off the planes at the nearest places of the lattice; off the places if beside."""
        _, which = self.tree.query(points)
        normal = self.normals[which]
        away = points - self.lattice.s[which] - self.heights[:, None] * normal
        height = dot(away, normal)
        beside = norm(away - height[:, None] * normal) > self.reach[which]
        along = np.where(beside[:, None], unit(away), normal)
        return Off(np.where(beside, norm(away), height), along, self.places[which, 1])

    def near(self, points: Points3, v: Values | None = None) -> Off:
        """Return how far points are off, by feet within a step of the rulings given or of the nearest of many."""
        beside = by_rulings(self.strip, points)[0][:, 1] if v is None else v
        ends = self.strip.knots[[0, -1]]
        low, high = np.clip(beside - self.step, *ends), np.clip(beside + self.step, *ends)
        return self.at(points, at_places(self.strip, points, nearest_within(self.strip, points, low, high, HALVINGS)))

    def at(self, points: Points3, feet: Feet) -> Off:
        """Return how far points are off, by their feet."""
        return Off(*off_faces(self.strip, feet, points, self.heights), feet.place[:, 1])


def principal_axes(points: Points3, weights: Values) -> tuple[Vector3, Array]:
    """Return the middle of weighted points and their principal axes, in rows, right-handed."""
    middle = weights @ points
    away = points - middle
    axes = np.linalg.eigh((away * weights[:, None]).T @ away)[1].T
    return middle, axes * np.array([[1.0], [1.0], [np.sign(np.linalg.det(axes))]])


def root_mean_square(values: Values) -> float:
    """Return the root of the mean of the squares."""
    return float(np.sqrt(np.mean(values**2)))
