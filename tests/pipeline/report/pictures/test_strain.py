"""Strain as colours: the scale ends at the limit of the class, and a strained mesh is painted by it."""

from io import BytesIO

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image

from pipeline.report.pictures.canvas import BLUE, VERMILLION
from pipeline.report.pictures.part import part_picture
from pipeline.report.pictures.strain import colours, vertex_strains
from stages.construct import construct
from stages.model.surface import MeshSurface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests.caps import cap, part, pole_strain, rim_strain
from tests.near import assert_near

TOL = Tolerances("leather")


def test_the_ends_of_the_scale_are_full_and_its_middle_white() -> None:
    shown = colours(np.array([-5.0, -1.0, 0.0, 1.0, 5.0]))
    wanted = [to_rgb(BLUE), to_rgb(BLUE), (1.0, 1.0, 1.0), to_rgb(VERMILLION), to_rgb(VERMILLION)]
    assert_near(shown, np.array(wanted), bound=1e-12, why="colours as named")


def test_a_cap_is_blue_at_its_pole_and_orange_at_its_rim() -> None:
    half = 0.4
    made = construct(part(cap(half, cells=16)), TOL).product
    assert isinstance(made, MeshSurface)
    judged = verify(made, TOL).product
    assert judged is not None
    assert judged.flat is not None
    strains = vertex_strains(made, judged.flat)
    pole = int(np.argmax(made.mesh.vertices[:, 2]))
    assert_near(
        strains[pole], pole_strain(half), bound=0.2 * abs(pole_strain(half)), why="256 cells: 1/8 of the radius"
    )
    rim = float(np.median(strains[made.loops[0]]))
    assert_near(rim, rim_strain(half), bound=0.4 * rim_strain(half), why="triangles reach 1/8 of the radius inwards")
    pattern = unroll(judged, TOL).product
    painted, plain = (
        np.asarray(Image.open(BytesIO(part_picture(made, pattern, [], None, "leather", flat=flat)))).astype(int)
        for flat in (judged.flat, None)
    )
    warm = [int(((page[..., 0] - page[..., 2]) > 60).sum()) for page in (painted, plain)]
    assert warm[0] > 10 * max(warm[1], 100)
