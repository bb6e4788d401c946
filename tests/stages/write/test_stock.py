"""What of the stock is in the file of a sheet: outline and defects, a roll as far as it is used, no zones."""

import math

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, bounds
from stages.model.cutfile import Machine
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout, Zone
from stages.write import judged, write
from stages.write.drawing import sheet_drawing
from stages.write.readback import ReadFile, read
from tests.near import assert_near
from tests.stages.write.patterns import plate

SQUARE = ArcPath(np.array([[-50.0, -60.0], [450, -60], [450, 440], [-50, 440]]), np.zeros(4), closed=True)
DISC = ArcPath(np.array([[400.0, 400.0], [380.0, 400.0]]), np.ones(2), closed=True)
HIDE = Sheet("hide", 500.0, 500.0, 1, 5.0, kind="hide", outline=SQUARE, defects=(DISC,), zones=(Zone(DISC, 1),))
ROLL = Sheet("roll", math.inf, 400.0, 1, 5.0, kind="roll")


def cut(sheet: Sheet) -> ReadFile:
    part = plate()
    nest = Nesting((SheetLayout(sheet, 1, (Placement(part.part, 1, Rigid2(20.0, 20.0)),), 0.1),))
    outcome = write([part], nest, Machine())
    assert outcome.report.passed, outcome.report.findings
    return read(next(file.text for file in outcome.product if file.path.startswith("cut/")))


def test_a_hide_is_its_outline_and_its_defects_and_no_zones() -> None:
    back = cut(HIDE)
    stock = [entity for entity in back.entities if entity.layer.startswith("SHEET")]
    assert [(entity.layer, entity.closed) for entity in stock] == [("SHEET", True), ("SHEET_KEEPOUT", True)]
    assert [entity.layer for entity in back.entities][:2] == ["SHEET", "SHEET_KEEPOUT"], "before all parts"
    sizes = [area(entity.path) for entity in stock if entity.path is not None]
    assert_near(sizes, [250_000.0, 100.0 * np.pi], bound=1e-9, why="closed form")
    assert stock[0].path is not None
    assert bounds(stock[0].path) == (-50.0, -60.0, 450.0, 440.0), "where it was drawn"


def test_a_roll_ends_where_it_is_used_up() -> None:
    (edge,) = (entity.path for entity in cut(ROLL).entities if entity.layer == "SHEET")
    assert edge is not None
    right = bounds(plate().outer.path)[2] + 20.0 + 5.0
    assert_near(bounds(edge), [0.0, 0.0, right, 400.0], bound=1e-9, why="the part's right end and the edge gap")


@pytest.mark.parametrize("layer", ["SHEET", "SHEET_KEEPOUT"])
def test_an_outline_of_the_stock_that_is_lost_or_open_is_seen(layer: str) -> None:
    part = plate()
    layout = SheetLayout(HIDE, 1, (Placement(part.part, 1, Rigid2(20.0, 20.0)),), 0.1)
    drawn = sheet_drawing(layout, {part.part: part}, Machine())
    (file,) = (file for file in write([part], Nesting((layout,)), Machine()).product if file.path == drawn.path)
    assert judged([file], [drawn], {part.part: part}).passed
    fewer = type(drawn)(drawn.path, tuple(item for item in drawn.items if item.layer != layer), drawn.labels)
    report = judged([file], [fewer], {part.part: part})
    assert "readback-content" in {finding.code for finding in report.findings}
