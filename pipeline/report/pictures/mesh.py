"""A formed part that is a mesh, as it looks: its triangles shaded and painted from back to front, its edges in blue.

Triangles by the depth of their middles: right for a surface without self-intersection whose triangles are small beside
their distance.
"""

import numpy as np

from pipeline.report.pictures.canvas import BLUE, Box, Canvas, caption, fitted, scale_bar, size_text
from pipeline.report.pictures.net import best_view
from pipeline.report.pictures.surface import MARGINS, SHADE, triad
from pipeline.report.shades import BACK_RGB, FRONT_RGB, LIGHT
from stages.geometry.arrays import Array, Points3, Vector3, cross3, dot, norm, unit
from stages.model.surface import MeshSurface

EDGE_WIDTH = 1.4


def mesh_view(surface: MeshSurface) -> Points3:
    """Return the frame of the picture, rows right, up and towards the viewer."""
    return best_view(_areas(surface.mesh.vertices[surface.mesh.faces]))


def mesh_sight(surface: MeshSurface, frame: Points3) -> tuple[float, float]:
    """Return width and height of the mesh as seen, mm."""
    extent = np.ptp(surface.mesh.vertices @ frame[:2].T, axis=0)
    return float(extent[0]), float(extent[1])


def draw_mesh(
    canvas: Canvas,
    box: Box,
    surface: MeshSurface,
    frame: Points3,
    *,
    size_mm: Vector3 | None,
    paint: Array | None = None,
    legend: str = "",
) -> None:
    """Draw the formed mesh with axes, scale and size; paint: colours of its triangles, and what they show."""
    seen = surface.mesh.vertices @ frame.T
    fit = fitted(seen[:, :2], box.inset(*MARGINS))
    corners = seen[surface.mesh.faces]
    order = np.argsort(corners[:, :, 2].mean(axis=1), kind="stable")
    normals = unit(_areas(corners[order]))
    front = normals[:, 2] >= 0.0
    facing = np.where(front[:, None], normals, -normals)
    bright = 1.0 - SHADE * (1.0 - np.clip(dot(facing, LIGHT / norm(LIGHT)), 0.0, 1.0))
    plain = np.where(front[:, None], FRONT_RGB, BACK_RGB)
    fill = (plain if paint is None else paint[order]) * bright[:, None]
    canvas.polygons(list(fit.place(corners[order][:, :, :2])), fill, fill, 0.3)
    canvas.lines([fit.place(seen[np.append(loop, loop[:1]), :2]) for loop in surface.loops], BLUE, EDGE_WIDTH)
    triad(canvas, np.array([box.left + 0.5, box.bottom + 0.42]), frame)
    scale_bar(canvas, box.right - 0.3, box.bottom + 0.28, fit.scale, min(1.4, box.width / 4.0))
    caption(canvas, box, f"Formed surface{legend}", size_text(size_mm))


def _areas(corners: Array) -> Points3:
    """Return the area vectors of triangles, shape (m, 3, 3) -> (m, 3)."""
    return cross3(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
