"""Pictures of stock that is no plain sheet: outline, defects, zones, grain, rolls, copies that are turned over."""

import math
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from pipeline.report.pictures.part import sheet_picture
from pipeline.report.pictures.sheet import FILLS, MIRRORED
from pipeline.report.pictures.stock import ZONE_TINTS, frame_of, zone_tints
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath
from stages.model.sheet import Placement, Sheet, SheetLayout, Zone
from tests.stages.nest.shapes import rectangle

PARTS = {"bar": rectangle("bar", 100.0, 40.0).replace(label_at=np.array([50.0, 20.0]))}


def ring(*corners: tuple[float, float]) -> ArcPath:
    return ArcPath(np.array(corners, dtype=np.float64), np.zeros(len(corners)), closed=True)


OUTLINE = ring((50, 0), (450, 0), (500, 150), (400, 300), (0, 280), (20, 100))
ZONES = (
    Zone(ring((300, 20), (440, 20), (440, 120), (300, 120)), 2),
    Zone(ring((20, 200), (100, 200), (100, 400), (20, 400)), 5),
)
SCAR = ArcPath(np.array([[220.0, 240.0], [180.0, 240.0]]), np.ones(2), closed=True)
HIDE = Sheet("hide", 500.0, 300.0, 1, 6.0, None, "hide", outline=OUTLINE, defects=(SCAR,), zones=ZONES, grain_deg=10.0)
PLACED = (Placement("bar", 1, Rigid2(100.0, 50.0)),)


def shown(sheet: Sheet, *placed: Placement) -> np.ndarray:
    png = sheet_picture(SheetLayout(sheet, 1, placed or PLACED, 0.1), PARTS)
    return np.asarray(Image.open(BytesIO(png)).convert("RGB")).astype(np.int64)


def count(pixels: np.ndarray, colour: str) -> int:
    wanted = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return int((np.abs(pixels - wanted).max(axis=2) <= 1).sum())


def test_zones_are_tinted_the_worse_the_darker() -> None:
    assert zone_tints(HIDE) == {5: ZONE_TINTS[0], 2: ZONE_TINTS[1]}
    with_zones, without = shown(HIDE), shown(HIDE.replace(zones=()))
    for tint in ZONE_TINTS[:2]:
        assert count(with_zones, tint) > 1000 > count(without, tint)


def test_a_zone_is_shown_as_far_as_it_lies_on_the_stock() -> None:
    inside = HIDE.replace(zones=(Zone(ring((20, 200), (100, 200), (100, 278), (20, 278)), 5),))
    reaching, ending = (count(shown(sheet), ZONE_TINTS[0]) for sheet in (HIDE, inside))
    assert reaching < 1.2 * ending, "80 by 200 as drawn, some 80 by 83 of them on the stock"


@pytest.mark.parametrize("change", [{"defects": ()}, {"grain_deg": None}, {"grain_deg": 40.0}, {"edge_gap_mm": 0.0}])
def test_everything_that_is_known_of_the_stock_is_seen(change: dict[str, object]) -> None:
    assert not np.array_equal(shown(HIDE), shown(HIDE.replace(**change)))


def test_a_copy_that_is_turned_over_is_marked() -> None:
    same_place = Placement("bar", 1, Rigid2(200.0, 50.0, 0.0, mirrored=True))
    plain, over = shown(HIDE, *PLACED), shown(HIDE, same_place)
    assert MIRRORED == "⇄"
    assert count(plain, FILLS[0]) != count(over, FILLS[0])
    assert not np.array_equal(plain, over)


def test_a_roll_is_shown_as_far_as_it_is_used() -> None:
    roll = Sheet("roll", math.inf, 300.0, None, 5.0, kind="roll")
    layout = SheetLayout(roll, 1, PLACED, 0.1)
    assert frame_of(layout, PARTS).tolist() == [[0.0, 0.0], [205.0, 300.0]]
    assert shown(roll).shape[1] == 1320
    assert frame_of(replace(layout, sheet=HIDE), PARTS).tolist() == [[0.0, 0.0], [500.0, 300.0]]
    empty = sheet_picture(replace(layout, placements=()), PARTS)
    assert Image.open(BytesIO(empty)).size[0] == 1320


def test_a_hide_without_its_edge_gap_left_is_drawn_all_the_same() -> None:
    assert shown(HIDE.replace(edge_gap_mm=1000.0)).shape[1] == 1320
