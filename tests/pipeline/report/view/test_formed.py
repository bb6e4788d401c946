"""The formed part for the page: what is read back is the surface, to the deviation that is stated."""

import base64
from typing import Any

import numpy as np
import pytest

from pipeline.report.pictures.net import Net, net
from pipeline.report.view.arrays import encoded_numbers, encoded_points, rounding_mm
from pipeline.report.view.cells import COLUMNS, cells
from pipeline.report.view.formed import formed, ruled_part, sagitta_mm, triangles
from pipeline.run import PartRun
from stages.construct import construct
from stages.geometry.arrays import Array
from stages.geometry.ruled.ruled import at
from stages.model.surface import MeshSurface, RuledSurface
from stages.model.tolerances import Tolerances
from stages.verify import verify
from tests import caps
from tests.near import assert_near, assert_relative
from tests.parts import part as asked
from tests.parts import passage

RADIUS, LONG = 300.0, 800.0
HALF_PIPE = {
    "kind": "cylinder",
    "directrix": {"arc": {"center": [0, 0, 0], "radius": 300, "normal": [1, 0, 0], "start": 0, "end": 180}},
    "direction": [1, 0, 0],
    "length": 800,
}
CONE = {"kind": "cone", "radius0": 300, "radius1": 0, "height": 400, "sweep": 200}
DRILLED = {"name": "fix", "kind": "drill", "at": [0.5, 0.25], "diameter": 80}
PLATE = {"kind": "flat", "outline": {"polyline": [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]}}
QUADS = 120
SAGITTA = RADIUS * (1.0 - np.cos(np.pi / QUADS / 2.0))
"""How far the middle of one quad is inside the pipe."""


def surface_of(table: dict[str, object], **keys: object) -> tuple[RuledSurface, dict[str, Any]]:
    made = passage(table, **keys)
    assert isinstance(made.surface, RuledSurface)
    return made.surface, ruled_part(made.surface, made.pattern, None)


def read_back(packed: dict[str, Any], size: int) -> Array:
    """Return the points of a document as the page reads them."""
    steps = np.frombuffer(base64.b64decode(packed["points"]), "<u2").reshape(-1, size)
    return np.asarray(np.array(packed["low"]) + packed["step"] * steps)


def floats(text: str) -> Array:
    return np.frombuffer(base64.b64decode(text), "<f4").astype(np.float64)


@pytest.mark.parametrize("table", [HALF_PIPE, CONE], ids=["pipe", "cone with its apex"])
def test_what_is_shown_is_within_the_stated_deviation_of_the_surface(table: dict[str, object]) -> None:
    surface, document = surface_of(table)
    rails = read_back(document, 3).reshape(-1, 2, 3)
    u, share = np.random.default_rng(8).random((2, 500))
    row = np.random.default_rng(9).integers(0, len(rails) - 1, 500)
    v = floats(document["v"])
    ends = rails[row] + share[:, None, None] * (rails[row + 1] - rails[row])
    shown = ends[:, 0] + u[:, None] * (ends[:, 1] - ends[:, 0])
    there = at(surface.patches[0], u, v[row] + share * (v[row + 1] - v[row]))
    away = np.linalg.norm(shown - there, axis=1).max()
    assert 0.1 * document["deviation_mm"] < away <= document["deviation_mm"]


def test_the_deviation_of_a_pipe_is_the_sagitta_of_one_quad() -> None:
    surface, document = surface_of(HALF_PIPE)
    assert_relative(sagitta_mm(surface, net(surface)), SAGITTA, bound=1e-6, why="v is rounded to 9 decimals")
    assert document["deviation_mm"] < SAGITTA + 1.4e-5 * np.pi * RADIUS


def test_a_coarser_net_states_its_larger_deviation() -> None:
    surface, _ = surface_of(HALF_PIPE)
    fine = net(surface)
    coarse = Net(fine.v[::2], fine.points[::2], fine.joined[::2], fine.rulings[:0], None)
    ratio = sagitta_mm(surface, coarse) / sagitta_mm(surface, fine)
    assert_near(ratio, 4.0, bound=1e-3, why="sagittas go with the square of the step")


def test_points_are_read_back_to_half_a_step_in_each_coordinate() -> None:
    points = np.random.default_rng(1).normal(size=(200, 3)) * [1000.0, 10.0, 1.0] + 5e5
    away = np.linalg.norm(read_back(encoded_points(points), 3) - points, axis=1).max()
    assert 0.0 < away <= rounding_mm(points) < 1.4e-5 * float(np.ptp(points[:, 0]))


def test_a_point_is_read_back_as_it_is() -> None:
    assert (read_back(encoded_points(np.full((3, 2), 7.25)), 2) == np.full((3, 2), 7.25)).all()


def test_whole_numbers_take_four_bytes_where_two_are_too_few() -> None:
    for largest, size in ((65535, 2), (65536, 4)):
        packed = encoded_numbers(np.array([0, largest]))
        assert packed["bytes"] == size
        assert np.frombuffer(base64.b64decode(str(packed["numbers"])), f"<u{size}").tolist() == [0, largest]


def test_both_rails_lie_flat_as_the_pattern_does() -> None:
    _, document = surface_of(HALF_PIPE)
    flat = read_back(document["flat"], 2).reshape(-1, 2, 2)
    v = floats(document["v"])
    across = np.stack([np.zeros_like(v), np.pi * RADIUS * v], axis=1)
    expected = np.stack([across, across + np.array([LONG, 0.0])], axis=1)
    assert_near(flat, expected, bound=1e-5 * np.pi * RADIUS, why="rounding to whole steps")


def test_a_hole_takes_its_area_out_of_the_net() -> None:
    _, document = surface_of(HALF_PIPE, hole=[DRILLED])
    assert [line["kind"] for line in document["lines"]] == ["hole"]
    ring = floats(document["lines"][0]["places"]).reshape(-1, 2) * [np.pi * RADIUS / QUADS, LONG]
    whole = np.unpackbits(np.frombuffer(base64.b64decode(document["cells"]["whole"]), "u1"), bitorder="little")
    corners = floats(document["cells"]["corners"]).reshape(-1, 3, 2) * [np.pi * RADIUS / QUADS, LONG]
    cell = np.pi * RADIUS / QUADS * LONG / COLUMNS
    left = whole.sum() * cell + _areas(corners).sum()
    gone = np.pi * RADIUS * LONG - left
    assert_relative(gone, abs(_areas(ring[None])[0]), bound=1e-4, why="float32 places; triangles fill what is left")
    assert_relative(gone, np.pi * 40.0**2, bound=0.02, why="a drill of 40 mm in 60 pieces on a pipe of 300")


def _areas(rings: Array) -> Array:
    x, y = rings[..., 0], rings[..., 1]
    return np.asarray(np.sum(x * np.roll(y, -1, axis=-1) - np.roll(x, -1, axis=-1) * y, axis=-1) / 2.0)


def test_triangles_of_cut_cells_run_alike_and_none_reaches_over_a_ruling() -> None:
    ring = np.array([[0.5, 0.1], [7.3, 0.2], [6.1, 0.9], [1.2, 0.8], [0.5, 0.1]])
    left = cells(ring, [], np.ones(9, dtype=np.bool_))
    corners = left.corners.reshape(-1, 3, 2)
    areas = _areas(corners)
    assert areas.min() >= 0.0
    assert_near(areas.sum() + left.whole.sum() / COLUMNS, abs(_areas(ring[None])[0]), bound=1e-12, why="exact cells")
    rows = corners[areas > 1e-12][:, :, 0]
    assert (np.floor(rows.min(axis=1)) + 1.0 >= rows.max(axis=1)).all()


def test_rulings_that_coincide_bound_no_cell() -> None:
    joined = np.array([True, False, True])
    left = cells(None, [], joined)
    assert left.whole.sum(axis=1).tolist() == [COLUMNS, 0, COLUMNS]


def test_a_mesh_is_its_triangles_with_the_strain_of_every_vertex() -> None:
    made = construct(caps.part(caps.cap(0.4, cells=8)), Tolerances("leather")).product
    assert isinstance(made, MeshSurface)
    judged = verify(made, Tolerances("leather")).product
    assert judged is not None
    document: dict[str, Any] = triangles(made, judged.flat, 0.03)
    assert_near(
        read_back(document, 3), made.mesh.vertices, bound=document["deviation_mm"], why="nothing but rounding of places"
    )
    (field,) = document["fields"]
    values = floats(field["values"])
    assert len(values) == len(made.mesh.vertices)
    assert values.min() < 0.0 < values.max()
    assert field["limit"] == 0.03


def test_a_plate_and_what_was_not_constructed_have_no_formed_view() -> None:
    plate = passage(PLATE)
    for surface in (plate.surface, None):
        assert formed(PartRun(asked(PLATE), (), surface, None)) is None


def test_a_refused_part_is_shown_without_its_flat_places() -> None:
    surface, _ = surface_of(HALF_PIPE)
    document: Any = formed(PartRun(asked(HALF_PIPE), (), surface, None), 0.3)
    assert document["flat"] is None
    assert document["lines"] == []
    assert_near(floats(document["v"])[document["worst"]], 0.3, bound=1e-7, why="its own ruling")
