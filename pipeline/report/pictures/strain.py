"""Strain on a formed mesh as colours: orange where the sheet is stretched flat, blue where it is pressed together.

Shown is the principal strain of larger size, averaged over the triangles around every vertex.  The scale ends at the
limit of the class that the part is in, whatever it reaches, so that pictures of different parts can be compared; the
two ends are told apart by colour-blind eyes, and go darker alike in grey.
"""

from itertools import pairwise

import numpy as np

from pipeline.report.pictures.canvas import BLUE, GREY, VERMILLION, Box, Canvas
from stages.geometry.arrays import Array, Values
from stages.geometry.mesh.arap import strain_tensors
from stages.geometry.mesh.flat import resting
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import edges_of
from stages.model.surface import MeshSurface

LENGTH, HEIGHT, STEPS = 2.4, 0.09, 48
"""Of the scale, inches; and the colours it shows."""
TICKS = (-1.0, -0.5, 0.0, 0.5, 1.0)
PERCENT = 100.0


def vertex_strains(surface: MeshSurface, flat: MeshMap) -> Values:
    """Return at every vertex the principal strain of larger size, from the mean tensor of the triangles around it."""
    mesh = surface.mesh
    rest = resting(mesh, edges_of(mesh), flat.lengths)
    corners, count = mesh.faces.ravel(), len(mesh.vertices)
    weight = np.repeat(rest.area, mesh.faces.shape[1])
    total = np.bincount(corners, weight, minlength=count)
    tensors = np.repeat(strain_tensors(rest, flat.positions), mesh.faces.shape[1], axis=0)
    xx, xy, yy = (np.bincount(corners, weight * part, minlength=count) / total for part in tensors.T)
    mean, away = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    return np.asarray(np.where(mean >= 0.0, mean + away, mean - away))


def strain_colours(surface: MeshSurface, flat: MeshMap, limit: float) -> Array:
    """Return the colour of every triangle, shape (m, 3)."""
    return colours(vertex_strains(surface, flat)[surface.mesh.faces].mean(axis=1) / limit)


def colours(shares: Values) -> Array:
    """Return the colours of shares of the limit, shape (n, 3): white at 0, full from 1 and -1 on."""
    from matplotlib.colors import to_rgb

    ends = np.where((shares >= 0.0)[:, None], to_rgb(VERMILLION), to_rgb(BLUE))
    size = np.minimum(np.abs(shares), 1.0)[:, None]
    return np.asarray(1.0 + size * (ends - 1.0))


def draw_scale(canvas: Canvas, box: Box, limit: float) -> None:
    """Draw the scale with its numbers under the caption of a view."""
    left, top = box.left + 0.05, box.top - 0.42
    edges = np.linspace(0.0, LENGTH, STEPS + 1)
    cells = [
        np.array([[left + a, top], [left + b, top], [left + b, top - HEIGHT], [left + a, top - HEIGHT]])
        for a, b in pairwise(edges)
    ]
    fill = colours(np.linspace(-1.0, 1.0, STEPS))
    canvas.polygons(cells, fill, fill, 0.3)
    frame = np.array([[left, top], [left + LENGTH, top], [left + LENGTH, top - HEIGHT], [left, top - HEIGHT]])
    canvas.lines([np.vstack([frame, frame[:1]])], GREY, 0.6)
    for tick in TICKS:
        at = left + LENGTH * (tick + 1.0) / 2.0
        words = f"{tick * limit * PERCENT:+.3g} %" if tick else "0"
        canvas.text((at, top - HEIGHT - 0.04), words, 6.5, align=("center", "top"))
