"""A formed mesh, as it looks: the side of a sheet that faces the viewer has the colour of that side."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from pipeline.report.pictures.canvas import Box, Canvas, own_settings
from pipeline.report.pictures.mesh import draw_mesh, mesh_sight, mesh_view
from pipeline.report.pictures.surface import SHADE
from pipeline.report.shades import BACK_RGB, FRONT_RGB, LIGHT
from stages.construct import construct
from stages.geometry.arrays import Points3, norm
from stages.model.surface import MeshSurface
from stages.model.tolerances import Tolerances
from tests.caps import cap, part
from tests.near import assert_near

WIDE, HIGH = 4.0, 3.0


@pytest.fixture(scope="module")
def shallow() -> MeshSurface:
    made = construct(part(cap(0.05, cells=8)), Tolerances("leather")).product
    assert isinstance(made, MeshSurface)
    return made


def middle_colour(surface: MeshSurface, frame: Points3) -> np.ndarray:
    """Return the colour at the middle of a picture of the mesh, 0 to 1."""
    with own_settings():
        canvas = Canvas(WIDE, HIGH)
        draw_mesh(canvas, Box(0.0, 0.0, WIDE, HIGH), surface, frame, size_mm=None)
        page = np.asarray(Image.open(BytesIO(canvas.png())).convert("RGB")) / 255.0
    return page[page.shape[0] // 2, page.shape[1] // 2]


@pytest.mark.parametrize(("up", "side"), [(1.0, FRONT_RGB), (-1.0, BACK_RGB)])
def test_seen_from_one_side_a_sheet_has_its_colour_lit_as_it_lies(
    shallow: MeshSurface, up: float, side: np.ndarray
) -> None:
    """A shallow cap from above and from below: at its middle it faces the viewer."""
    towards = up * np.sign(rising(shallow))
    found = middle_colour(shallow, np.diag([1.0, towards, towards]))
    bright = 1.0 - SHADE * (1.0 - LIGHT[2] / float(norm(LIGHT)))
    assert_near(found, bright * side, bound=0.02, why="normals within 0.05 rad of the view; 1/255 a channel")


def rising(surface: MeshSurface) -> float:
    """Return twice the area of the mesh as seen from above, positive where its front is up."""
    corners = surface.mesh.vertices[surface.mesh.faces]
    return float(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].sum())


def test_it_is_looked_at_from_where_it_is_seen_widest(shallow: MeshSurface) -> None:
    wide, high = mesh_sight(shallow, mesh_view(shallow))
    assert min(wide, high) > 0.5 * max(wide, high)
