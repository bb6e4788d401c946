"""Meshes of bent sheet as CAD programs write them: plane flanges, bends in coarse facets, few vertices inside.

A profile is a run of legs, straight ones by their length and bends by radius and angle.  A region of the plane (x along
the rulings, y along the profile) is cut into bands, one for each flange and one for each facet of a bend; every band is
divided into triangles on its outline's own points.  The flat region is the closed form that the pattern must have.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from stages.geometry.arrays import Array, Points2, Points3, Triples
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of


@dataclass(frozen=True)
class Flat:
    """A straight leg, after a fold of so many degrees."""

    length: float
    fold_deg: float = 0.0


@dataclass(frozen=True)
class Bend:
    """A circular leg; positive angles turn left."""

    radius: float
    angle_deg: float

    @property
    def length(self) -> float:
        """Along the arc."""
        return self.radius * abs(float(np.radians(self.angle_deg)))


Legs = Sequence[Flat | Bend]


def run_length(legs: Legs) -> float:
    """Return the length of a profile."""
    return sum(leg.length for leg in legs)


def lifted(legs: Legs, flat: Points2, left: float = 0.0) -> Points3:
    """Return flat points on the sheet, or so far left of it: rulings along z, the profile in the complex plane."""
    made = np.zeros((len(flat), 3))
    made[:, 2] = flat[:, 0]
    at, way, far = 0j, 1.0 + 0j, 0.0
    for i, leg in enumerate(legs):
        last = i == len(legs) - 1
        here = (flat[:, 1] >= far - 1e-12 * bool(i == 0)) & ((flat[:, 1] < far + leg.length) | last)
        s = flat[here, 1] - far
        if isinstance(leg, Flat):
            way *= np.exp(1j * np.radians(leg.fold_deg))
            place = at + way * (s + 1j * left)
            at = at + way * leg.length
        else:
            side = 1j * np.sign(leg.angle_deg)
            turned = np.exp(side * s / leg.radius)
            place = at + way * (leg.radius * side * (1.0 - turned) + 1j * left * turned)
            at = at + way * leg.radius * side * (1.0 - np.exp(side * leg.length / leg.radius))
            way = way * np.exp(side * leg.length / leg.radius)
        made[here, 0], made[here, 1] = place.real, place.imag
        far += leg.length
    return made


def rulings(legs: Legs, step_deg: float, *, aligned: bool = True) -> list[float]:
    """Return the places along the profile at which bands begin and end."""
    places, far = [0.0], 0.0
    for leg in legs:
        count = int(np.ceil(abs(leg.angle_deg) / step_deg - 1e-9)) if isinstance(leg, Bend) and aligned else 1
        places += (far + leg.length * np.arange(1, count + 1) / count).tolist()
        far += leg.length
    return places


def rectangle(width: float, legs: Legs) -> shapely.Polygon:
    """Return the whole strip of a width."""
    return shapely.box(0.0, 0.0, width, run_length(legs))


def bent(legs: Legs, region: shapely.Polygon, step_deg: float) -> Mesh:
    """Return the mesh of a region of a bent sheet, its outside on the left of the profile."""
    flat, faces = divided(legs, region, step_deg)
    return Mesh(lifted(legs, flat), faces)


def solid(legs: Legs, region: shapely.Polygon, step_deg: float, thickness: float) -> Mesh:
    """Return the closed mesh of a sheet with its thickness, on the right of the profile."""
    flat, faces = divided(legs, region, step_deg)
    n = len(flat)
    skin = Mesh(lifted(legs, flat), faces)
    rim = [
        corners
        for loop in boundary_loops(skin, edges_of(skin))
        for a, b in pairwise([*loop.tolist(), int(loop[0])])
        for corners in ([b, a, a + n], [b, a + n, b + n])
    ]
    vertices = np.vstack([skin.vertices, lifted(legs, flat, -thickness)])
    return Mesh(vertices, np.vstack([faces, faces[:, ::-1] + n, np.array(rim, dtype=np.int64)]))


def divided(legs: Legs, region: shapely.Polygon, step_deg: float) -> tuple[Array, Triples]:
    """Return flat points, and the triangles of the bands that a region is divided into."""
    places: dict[tuple[float, float], int] = {}
    points: list[tuple[float, float]] = []
    faces: list[list[int]] = []

    def number(x: float, y: float) -> int:
        key = (round(x, 7), round(y, 7))
        if key not in places:
            places[key] = len(points)
            points.append((x, y))
        return places[key]

    low, high = region.bounds[0] - 1.0, region.bounds[2] + 1.0
    for y0, y1 in pairwise(rulings(legs, step_deg)):
        band = shapely.intersection(region, shapely.box(low, y0, high, y1))
        for triangle in shapely.constrained_delaunay_triangles(band).geoms:
            corners = [number(float(x), float(y)) for x, y in shapely.orient_polygons(triangle).exterior.coords[:3]]
            if len(set(corners)) == 3:
                faces.append(corners)
    return np.array(points), np.array(faces, dtype=np.int64)
