"""The least pitch of bend lines: between neighbours, on the edge where they come closest."""

import pytest

from stages.construct import construct
from stages.geometry.flat.development import develop
from stages.model.forming import BendSpec
from stages.model.material import Material
from stages.model.scalars import Angle
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.forming import Forming, formed
from stages.unroll.thickness import neutral
from tests.near import assert_relative
from tests.parts import Table, part

TOL = Tolerances()


def hits(radius1: int) -> Forming:
    """Return hits of at most 30 deg on a right cone or cylinder of radius 300 at c0."""
    table: Table = {"kind": "cone", "radius0": 300, "radius1": radius1, "height": 400}
    made = construct(part(table, Material(thickness_mm=0.5, bend_radius_min_mm=0.2)), TOL).product
    assert isinstance(made, RuledSurface)
    sheet = neutral(made, TOL)
    return formed(sheet.bent, sheet.surface, develop(sheet.surface.patches), BendSpec(max_angle=Angle(30)))


@pytest.mark.parametrize("radius1", [300, 150, 450])
def test_the_least_pitch_is_that_of_the_narrower_edge(radius1: int) -> None:
    found = hits(radius1)
    pitches = [row["pitch_mm"] for row in found.rows[:-1]]
    assert len(pitches) > 5
    for at_c0, at_c1 in pitches:  # type: ignore[misc]
        assert_relative(at_c1 / at_c0, radius1 / 300, bound=1e-9, why="a cone is like itself")
    (least,) = [metric.value for metric in found.metrics if metric.name == "bend_pitch_min_mm"]
    assert least == min(min(row) for row in pitches)  # type: ignore[call-overload]
