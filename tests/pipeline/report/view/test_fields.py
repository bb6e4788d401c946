"""What a formed part can be coloured by: values at both ends of the rulings, and where their scale ends."""

import base64

import numpy as np
import pytest

from pipeline.report.pictures.net import net
from pipeline.report.view.fields import ROUND, bending_field, curvature_field, curvatures, ruled_fields, scale_end
from stages.geometry.arrays import Array
from stages.model.material import Material
from stages.model.surface import RuledSurface
from tests.near import assert_near, assert_relative
from tests.parts import UNKNOWN, Passage, passage

RADIUS, THICK, ALLOWED = 300.0, 8.0, 0.25
QUADS = 120
HALF_PIPE = {
    "kind": "cylinder",
    "directrix": {"arc": {"center": [0, 0, 0], "radius": 300, "normal": [1, 0, 0], "start": 0, "end": 180}},
    "direction": [1, 0, 0],
    "length": 800,
}
CONE = {"kind": "cone", "radius0": 300, "radius1": 0, "height": 400, "sweep": 200}
FRUSTUM = {"kind": "cone", "radius0": 300, "radius1": 120, "height": 400, "sweep": 200}
SHEET = Material(thickness_mm=THICK, max_strain=ALLOWED)


def floats(text: object) -> Array:
    return np.frombuffer(base64.b64decode(str(text)), "<f4").astype(np.float64)


def made(table: dict[str, object], material: Material = UNKNOWN, **keys: object) -> tuple[RuledSurface, Passage]:
    found = passage(table, material=material, **keys)
    assert isinstance(found.surface, RuledSurface)
    return found.surface, found


def strains(
    table: dict[str, object], face: str, material: Material = SHEET
) -> tuple[Array, dict[str, object], Passage]:
    surface, found = made(table, material, face=face)
    field = bending_field(surface, curvatures(surface, net(surface)))
    assert field is not None
    return floats(field["values"]), field, found


def test_curvature_of_a_pipe_is_one_over_its_radius() -> None:
    surface, _ = made(HALF_PIPE)
    field = curvature_field(curvatures(surface, net(surface)))
    assert_near(np.abs(floats(field["values"])), np.full(2 * (QUADS + 1), 1 / RADIUS), bound=1e-9, why="float32")
    assert field["limit"] == 5e-3


def test_curvature_at_an_apex_is_without_bound_and_does_not_set_the_scale() -> None:
    surface, _ = made(CONE)
    field = curvature_field(curvatures(surface, net(surface)))
    both = np.abs(floats(field["values"]).reshape(-1, 2))
    assert np.isinf(both[:, 1]).all()
    slant = np.hypot(300.0, 400.0)
    assert_relative(both[:, 0], np.full(len(both), 400.0 / slant / 300.0), bound=1e-6, why="cos of the half angle / r")
    assert field["limit"] == scale_end(2.0 * 400.0 / slant / 300.0)


@pytest.mark.parametrize(
    ("largest", "end"), [(0.0, 1.0), (1e-13, 1.0), (0.0021, 5e-3), (0.005, 5e-3), (0.9, 1.0), (1.0, 1.0), (30.0, 50.0)]
)
def test_a_scale_ends_at_the_next_of_one_two_five(largest: float, end: float) -> None:
    assert scale_end(largest) == end


@pytest.mark.parametrize(("face", "middle"), [("middle", 0.0), ("inner", 4.0), ("outer", -4.0)])
def test_a_pipe_is_strained_by_half_its_thickness_over_the_radius_of_its_middle(face: str, middle: float) -> None:
    values, field, _ = strains(HALF_PIPE, face)
    assert_relative(np.abs(values), np.full_like(values, THICK / 2.0 / (RADIUS + middle)), bound=1e-6, why="float32")
    assert field["limit"] == ALLOWED


@pytest.mark.parametrize("face", ["middle", "inner", "outer", "plus", "minus"])
@pytest.mark.parametrize("table", [HALF_PIPE, FRUSTUM], ids=["pipe", "frustum"])
def test_the_largest_strain_is_that_of_the_report(table: dict[str, object], face: str) -> None:
    values, _, found = strains(table, face)
    reported = found.value("verify", "outer_fibre_strain")
    assert isinstance(reported, float)
    assert_relative(np.abs(values).max(), reported, bound=1e-6, why="another way to it, and float32")


def test_the_side_that_the_sheet_is_bent_towards_is_pressed() -> None:
    surface, _ = made(HALF_PIPE, SHEET)
    bent = curvatures(surface, net(surface))
    (_, field) = ruled_fields(surface, net(surface))
    assert (floats(field["values"]) * bent.ravel() < 0.0).all()


def test_without_a_thickness_no_strain_is_told() -> None:
    surface, _ = made(HALF_PIPE)
    assert [field["name"] for field in ruled_fields(surface, net(surface))] == ["curvature"]


def test_without_a_limit_the_scale_is_round_and_says_so() -> None:
    _, field, _ = strains(HALF_PIPE, "middle", Material(thickness_mm=THICK))
    assert field["limit"] == 0.02
    assert field["limit_is"] == ROUND


def test_a_bend_that_is_too_sharp_for_the_sheet_is_strained_without_bound() -> None:
    values, _, _ = strains(HALF_PIPE, "outer", Material(thickness_mm=2.5 * RADIUS))
    assert np.isinf(values).all()
