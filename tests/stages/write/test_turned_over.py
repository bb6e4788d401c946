"""Copies that lie with their lower side up: what bends up in the flat frame bends down as their sheet is seen."""

import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.model.cutfile import Machine
from stages.model.sheet import Placement, Sheet, SheetLayout
from stages.write.drawing import sheet_drawing
from tests.readers.drawings import bent


@pytest.mark.parametrize(
    ("mirrored", "pair", "layers"),
    [
        (False, False, ["BEND_UP", "BEND_DOWN"]),
        (True, False, ["BEND_DOWN", "BEND_UP"]),
        (True, True, ["BEND_UP", "BEND_DOWN"]),
    ],
    ids=["as it is", "turned over", "mirror image"],
)
def test_bends_are_on_the_layer_of_the_way_they_are_seen_to_bend(mirrored: bool, pair: bool, layers: list[str]) -> None:
    copy = Placement("strap", 1, Rigid2(100.0, 10.0, 0.0, mirrored=mirrored))
    layout = SheetLayout(Sheet("s", 200.0, 100.0), 1, (copy,), 0.1)
    drawing = sheet_drawing(layout, {"strap": bent().replace(pair=pair)}, Machine())
    assert [item.layer for item in drawing.items] == ["SHEET", *layers, "CUT_OUTER"]
