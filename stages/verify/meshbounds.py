"""How far a mesh is from developable: equivalent warp and strain, each with the least and the largest that it may be.

Warp: the curvature averaged over a region is uncertain by `DEVIATIONS` standard deviations of what the mesh's noise
makes of it (found by adding that noise once more), and by what a fit of one degree less changes it, times how much
better the fit of full degree is.  Fits of degree 6 to twice the neighbours (`closer`) are ten times as sure on clean
meshes and take four times as long: they are for doubts that decide.  Strain: averaged over a cell of triangles it is
uncertain by as many standard errors; where chords had to be taken for the lengths on the surface, also by what these
would have differed.

The largest warp is that over the large regions, which are the surest, and over those smaller ones that are warped
more without a doubt.
"""

from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Values
from stages.geometry.mesh.arap import Sheet, strain_tensors
from stages.geometry.mesh.curvature import Regions, defects, means, regions, ruling_lengths, shares, spread
from stages.geometry.mesh.fit import DEGREE, WIDE_DEGREE, Stars, SurfaceFit, fitted, stars
from stages.geometry.mesh.flat import noise, resting
from stages.geometry.mesh.lengths import chords, curved, mended
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import Edges

DEVIATIONS = 3.0
"""Of ten large regions one is further off by chance in one mesh of forty."""
DISBELIEF = 3.0
"""Before a mesh is refused: noise counts for more where it is bent more than elsewhere, and the spread of all regions
does not tell; on a coarse oblique cone with noise of 1e-7 a mean was off by 8.6 of its deviations."""
CELL = 64
"""Triangles to a cell of strain, at least half of that: standard errors a tenth of the scatter."""
MARGIN = 3.0
"""The change from degree 3 to 4, times the ratio of what they leave, is what degree 4 leaves to this factor."""
LOW = 0.25
"""Quartile of the residuals that is taken for noise: where the surface is sharp they are not noise."""
SEED = 1
"""Of the noise that is added: the same mesh gets the same verdict."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A quantity: the least, the likely and the largest value, and the vertex where it is likely largest."""

    least: float
    value: float
    largest: float
    vertex: int | None = None

    @property
    def values(self) -> tuple[float, float, float]:
        """Return the least, the likely and the largest value."""
        return self.least, self.value, self.largest


UNKNOWN = Bound(0.0, np.inf, np.inf)


@dataclass(frozen=True, slots=True)
class Studied:
    """A mesh with all that was found of it.

    around, fit: the neighbours and the fits of `degree` that the curvature is taken from.
    """

    mesh: Mesh
    edges: Edges
    around: tuple[Stars, ...]
    fit: SurfaceFit
    flat: MeshMap
    degree: int = DEGREE


@dataclass(frozen=True, slots=True, eq=False)
class Curvatures(ArrayValue):
    """The Gaussian curvature averaged over regions.

    centres: their middle vertices.  radii: mm.  mean, doubt: 1/mm2, and how far off it may be.
    rulings: how long those through the centres are, mm.  scale: 0 for the largest regions.
    """

    centres: Indices
    radii: Values
    mean: Values
    doubt: Values
    rulings: Values
    scale: Indices


def closer(studied: Studied) -> Studied:
    """Return the same with fits of a higher degree."""
    around = stars(studied.mesh, studied.edges, WIDE_DEGREE)
    return replace(studied, around=around, fit=fitted(studied.mesh, around, WIDE_DEGREE), degree=WIDE_DEGREE)


def defect_sum(studied: Studied) -> float:
    """Return the integral of the curvature over all vertices inside, rad."""
    return float(_defects(studied, studied.mesh, studied.fit).sum())


def _defects(studied: Studied, mesh: Mesh, fit: SurfaceFit) -> Values:
    edges = studied.edges
    lengths = curved(mesh.vertices, edges.ends, fit)[0]
    return defects(mesh, edges, mended(lengths, chords(mesh.vertices, edges.ends), edges.of_half))


def curvatures(studied: Studied) -> Curvatures:
    """Return the curvature of every region that fits into the mesh, and how far off it may be."""
    flat = studied.flat.positions
    found = regions(studied.edges, flat)
    if not len(found.centres):
        return Curvatures(found.centres, *(np.zeros(0),) * 4, scale=found.scale)
    mean, doubt = _means(studied, found)
    length = ruling_lengths(studied.mesh, studied.edges, flat, studied.fit.normals, found)
    return Curvatures(found.centres, found.radii, mean, doubt, length, found.scale)


def _means(studied: Studied, found: Regions) -> tuple[Values, Values]:
    """Return the mean curvature of every region and how far off it may be, 1/mm2."""
    area = shares(studied.mesh, studied.edges, studied.flat.lengths)
    mean = means(found, _defects(studied, studied.mesh, studied.fit), area)
    noisier, lower = _noisier(studied), fitted(studied.mesh, studied.around, studied.degree - 1)
    moved = means(found, _defects(studied, noisier, fitted(noisier, studied.around, studied.degree)), area) - mean
    rougher = means(found, _defects(studied, studied.mesh, lower), area) - mean
    better = float(np.median(studied.fit.residual / np.maximum(studied.fit.coarser, np.finfo(np.float64).tiny)))
    return mean, DEVIATIONS * spread(found, moved) + min(MARGIN * better, 1.0) * np.abs(rougher)


def warp(read: Curvatures) -> Bound:
    """Return the equivalent warp, rad; unknown where no region fits into the mesh."""
    if not len(read.centres):
        return UNKNOWN
    size = np.abs(read.mean)
    surely = size - DISBELIEF * read.doubt
    least, likely, most = (read.rulings * np.sqrt(np.maximum(k, 0.0)) for k in (surely, size, size + read.doubt))
    large = read.scale == 0
    counted = large | (least > likely[large].max())
    worst = int(np.argmax(np.where(counted, likely, -1.0)))
    return Bound(float(least.max()), float(likely[worst]), float(most[counted].max()), int(read.centres[worst]))


def _noisier(studied: Studied) -> Mesh:
    """Return the mesh with as much noise added across the surface as was found."""
    source = np.random.default_rng(SEED)
    heights = float(np.quantile(studied.fit.residual, LOW)) * source.standard_normal(len(studied.mesh.vertices))
    return Mesh(studied.mesh.vertices + heights[:, None] * studied.fit.normals, studied.mesh.faces)


@dataclass(frozen=True, slots=True, eq=False)
class CellStrains(ArrayValue):
    """Strain averaged over cells of triangles.

    size: the larger principal strain of each cell, (c,).  doubt: `DEVIATIONS` standard errors of it, (c,).
    cell: of each triangle, (m,).
    """

    size: Array
    doubt: Array
    cell: Indices


def cell_strains(rest: Sheet, positions: Points2) -> CellStrains:
    """Return the strain of triangles laid flat, averaged over cells of many."""
    tensors = strain_tensors(rest, positions)
    cell = cells(positions[rest.faces].mean(axis=1), CELL)
    count = np.bincount(cell)
    weight = rest.area / np.bincount(cell, rest.area)[cell]
    mean = np.stack([np.bincount(cell, weight * part) for part in tensors.T], axis=1)
    away = ((tensors - mean[cell]) ** 2).sum(axis=1)
    error = np.sqrt(np.bincount(cell, away) / np.maximum(count - 1, 1) / count)
    size = np.abs((mean[:, 0] + mean[:, 2]) / 2.0) + np.hypot((mean[:, 0] - mean[:, 2]) / 2.0, mean[:, 1])
    return CellStrains(size, DEVIATIONS * error, cell)


def strain(studied: Studied) -> Bound:
    """Return the largest principal strain, averaged over cells of many triangles."""
    mesh, flat = studied.mesh, studied.flat
    found = cell_strains(resting(mesh, studied.edges, flat.lengths), flat.positions)
    size, worst = found.size, int(np.argmax(found.size))
    doubt = found.doubt + _chord_error(studied) + _lengthening(studied)
    vertex = int(mesh.faces[np.flatnonzero(found.cell == worst)[0], 0])
    return Bound(max(float((size - doubt).max()), 0.0), float(size[worst]), float((size + doubt).max()), vertex)


def strain_rms(studied: Studied) -> float:
    """Return the root of the mean over the area of (e1^2 + e2^2) / 2, triangle by triangle, noise included."""
    area = resting(studied.mesh, studied.edges, studied.flat.lengths).area
    return float(np.sqrt(area @ (studied.flat.strains**2).mean(axis=1) / area.sum()))


def _chord_error(studied: Studied) -> float:
    """Return by how much of themselves the lengths would differ on the fitted surface, if they are chords."""
    straight = chords(studied.mesh.vertices, studied.edges.ends)
    longer = curved(studied.mesh.vertices, studied.edges.ends, studied.fit)[0] / straight - 1.0
    taken = studied.flat.lengths == straight
    return float(np.quantile(np.abs(longer[taken]), MOST)) if taken.mean() > 1.0 - MOST else 0.0


def _lengthening(studied: Studied) -> float:
    """Return by how much of themselves noise makes edges longer: s^2 / L^2 on average, s the deviation of each end."""
    height = noise(studied.fit)
    return MARGIN * float(np.quantile((height / studied.flat.lengths) ** 2, MOST)) if np.isfinite(height) else np.inf


MOST = 0.9
"""A share of the edges: single fits may be arbitrarily far off."""


def cells(places: Points2, most: int) -> Indices:
    """Return the cell of each place: halved at the median across the longer side until no cell has more than `most`."""
    cell = np.zeros(len(places), dtype=np.int64)
    stack, count = [np.arange(len(places))], 0
    while stack:
        part = stack.pop()
        if len(part) <= most:
            cell[part] = count
            count += 1
            continue
        axis = int(np.argmax(np.ptp(places[part], axis=0)))
        order = part[np.argsort(places[part, axis], kind="stable")]
        stack += [order[: len(order) // 2], order[len(order) // 2 :]]
    return cell
