"""Where along a part its neutral surface lies by how much beside the given one: from its beginning to its end."""

import pytest

from stages.construct import construct
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.thickness import neutral
from tests.near import assert_near
from tests.parts import CIRCLE, Table, part

TOL = Tolerances()
PIPE: Table = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 5}
CONE: Table = {"kind": "cone", "radius0": 3, "radius1": 1, "height": 4}


@pytest.mark.parametrize("table", [PIPE, CONE])
def test_a_part_that_bends_one_way_has_one_offset_from_end_to_end(table: Table) -> None:
    sheet = Material(thickness_mm=0.5, k_factor=KFactor(0.4, given=True))
    made = construct(part(table, sheet, face="outer"), TOL).product
    assert isinstance(made, RuledSurface)
    thickness = neutral(made, TOL).detail["thickness"]
    assert isinstance(thickness, dict)
    (row,) = thickness["offsets"]
    assert row["v"] == [0.0, 1.0]
    assert_near(abs(row["offset_mm"]), 0.5 * (1.0 - 0.4), bound=1e-12, why="from the outside: t (1 - K)")
