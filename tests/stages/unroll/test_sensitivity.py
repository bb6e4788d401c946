"""Changes of the flat dimensions: closed forms, and against neutral surfaces unrolled again."""

import numpy as np
import pytest

from stages.construct import construct
from stages.geometry.flat.development import develop
from stages.model.face import Face
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.sensitivity import DIMENSIONS, sensitivity
from stages.unroll.sides import surface_figures
from stages.unroll.thickness import Neutral, neutral
from tests.near import assert_near
from tests.parts import AUMANN_CUBIC, CIRCLE, EXAMPLE_1, OBLIQUE_CONE, RIGHT_FRUSTUM, Table, part

PIPE: Table = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 5}
FULL_ROUND = 2.0 * np.pi


def unrolled(table: Table, thickness: float | None, k: float, face: Face) -> Neutral:
    sheet = Material(thickness_mm=thickness, k_factor=KFactor(k, given=True))
    made = construct(part(table, sheet, face=face), Tolerances()).product
    assert isinstance(made, RuledSurface)
    return neutral(made, Tolerances())


def rows(table: Table, thickness: float = 0.5, k: float = 0.4, face: Face = "middle") -> list[dict[str, float]]:
    made = sensitivity(unrolled(table, thickness, k, face).bent)
    assert list(made) == ["per_0_1_mm_thickness", "per_0_01_k", "per_1_percent_radius"]
    return [made[key] for key in made]  # type: ignore[misc]


@pytest.mark.parametrize(
    ("face", "by_thickness"), [("inner", 0.4), ("middle", 0.4 - 0.5), ("outer", 0.4 - 1.0), ("plus", 0.4)]
)
def test_a_pipe_in_closed_form(face: Face, by_thickness: float) -> None:
    """Length theta (r + K t), with r the given radius less 0, t/2 or t."""
    by_t, by_k, by_r = rows(PIPE, face=face)
    lengths = {"c0": 1.0, "c1": 1.0, "height": 1.0, "area": 5.0, "width": 0.0, "start": 0.0, "end": 0.0}
    middle = 2.0 + {"inner": 0.25, "middle": 0.0, "outer": -0.25, "plus": 0.25}[face]
    for name, share in lengths.items():
        assert_near(by_t[name], share * FULL_ROUND * by_thickness * 0.1, bound=1e-11, why="differences over 0.05 mm")
        assert_near(by_k[name], share * FULL_ROUND * 0.5 * 0.01, bound=1e-11, why="differences over 0.005")
        assert_near(by_r[name], share * FULL_ROUND * middle * 0.01, bound=1e-11, why="differences over 0.5 %")
        for row in (by_t, by_k, by_r):
            assert row["uncertainty"][name] <= 1e-11  # type: ignore[index]


@pytest.mark.parametrize("table", [AUMANN_CUBIC, OBLIQUE_CONE, RIGHT_FRUSTUM])
def test_thickness_and_k_change_what_unrolling_again_changes(table: Table) -> None:
    thickness, k, step = 0.02, 0.4, 0.005
    by_t, by_k, _ = rows(table, thickness, k, "plus")

    def figures(t: float, k: float) -> dict[str, float]:
        patches = unrolled(table, t, k, "plus").surface.patches
        pieces = develop(patches).pieces
        v = np.linspace(0.0, 1.0, 2001)
        outline = np.concatenate([piece.positions(np.full_like(v, u), v) for piece in pieces for u in (0.0, 1.0)])
        (edges, area), (width, height) = surface_figures(patches), np.ptp(outline, axis=0)
        return edges.by_name() | {"area": area, "width": float(width), "height": float(height)}

    for row, per, (high, low) in (
        (by_t, 0.1 / (2 * step), (figures(thickness + step, k), figures(thickness - step, k))),
        (by_k, 0.01 / (2 * step), (figures(thickness, k + step), figures(thickness, k - step))),
    ):
        for name in DIMENSIONS:
            bound = 1e-9 if name not in ("width", "height") else 2e-3 * abs(row["c0"]) + 1e-6
            wanted = per * (high[name] - low[name])
            assert_near(row[name], wanted, bound=bound + row["uncertainty"][name] * 16, why="boxes of sampled edges")  # type: ignore[index]


def test_a_radius_larger_by_one_percent_is_a_cone_opened_by_one_percent() -> None:
    """A right cone: the same slant, every radius of curvature and the sector angle larger by 1 %."""
    _, _, by_r = rows(RIGHT_FRUSTUM, 0.001, 0.5)
    assert_near(by_r["c0"], 0.01 * FULL_ROUND * 3.0, bound=1e-9, why="first order, differences over 0.5 %")
    assert_near(by_r["c1"], 0.01 * FULL_ROUND * 1.5, bound=1e-9, why="first order, differences over 0.5 %")
    area = np.pi * (3.0 + 1.5) * np.hypot(4.0, 1.5)
    assert_near(by_r["area"], 0.01 * area, bound=1e-9, why="a sector's area goes with its angle")
    assert by_r["start"] == by_r["end"] == 0.0


def test_what_does_not_bend_depends_on_nothing() -> None:
    assert list(sensitivity(unrolled(EXAMPLE_1, 1.0, 0.4, "inner").bent)) == ["note"]
    assert list(sensitivity(unrolled(PIPE, None, 0.5, "middle").bent)) == ["note"]


def test_a_flat_part_of_a_strip_keeps_its_width_when_radii_grow() -> None:
    """10 mm of plane, then a quarter of a pipe."""
    chain = [{"line": [[0, 0, 0], [10, 0, 0]]}, {"arc": {"center": [10, 2, 0], "radius": 2, "start": -90, "end": 0}}]
    table = {"kind": "cylinder", "directrix": {"chain": chain}, "direction": [0, 0, 1], "length": 5}
    _, _, by_r = rows(table, 0.1, 0.5)
    assert_near(by_r["c0"], 0.01 * np.pi, bound=1e-11, why="a quarter of 2 pi 2")
