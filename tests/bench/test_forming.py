"""How long the neutral surface, bend lines and sensitivity take, each with its result asserted.

Goal: the sensitivity within three developments of the neutral surface.
"""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from stages.construct import construct
from stages.geometry.flat.development import develop
from stages.model.forming import BendSpec
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.scalars import Angle
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.forming import formed
from stages.unroll.sensitivity import sensitivity
from stages.unroll.thickness import neutral
from tests.parts import EXAMPLE_2_CYLINDER, OBLIQUE_CONE, QUINTIC_TANGENT, Table, part

PARTS: dict[str, tuple[Table, float]] = {
    "example 2, cylinder": (EXAMPLE_2_CYLINDER, 0.05), "tangent surface": (QUINTIC_TANGENT, 3.0),
    "oblique cone": (OBLIQUE_CONE, 0.05),
}  # fmt: skip


def given(name: str) -> RuledSurface:
    table, thickness = PARTS[name]
    sheet = Material(thickness_mm=thickness, k_factor=KFactor(0.4, given=True))
    made = construct(part(table, sheet, face="plus"), Tolerances()).product
    assert isinstance(made, RuledSurface)
    return made


@pytest.mark.parametrize("name", PARTS)
def test_the_neutral_surface(name: str, benchmark: BenchmarkFixture) -> None:
    made = benchmark(neutral, given(name), Tolerances())
    assert made.surface is not made.bent.surface


@pytest.mark.parametrize("name", PARTS)
def test_the_development_of_the_neutral_surface(name: str, benchmark: BenchmarkFixture) -> None:
    unrolled = neutral(given(name), Tolerances())
    made = benchmark(develop, unrolled.surface.patches)
    assert len(made.pieces) == len(unrolled.surface.patches)


@pytest.mark.parametrize("name", PARTS)
def test_the_sensitivity(name: str, benchmark: BenchmarkFixture) -> None:
    made = benchmark(sensitivity, neutral(given(name), Tolerances()).bent)
    assert set(made) == {"per_0_1_mm_thickness", "per_0_01_k", "per_1_percent_radius"}


@pytest.mark.parametrize("name", PARTS)
def test_bend_lines_by_ten_degrees(name: str, benchmark: BenchmarkFixture) -> None:
    unrolled = neutral(given(name), Tolerances())
    flat = develop(unrolled.surface.patches)
    made = benchmark(formed, unrolled.bent, unrolled.surface, flat, BendSpec(max_angle=Angle(10)))
    assert all(metric.passed for metric in made.metrics)
