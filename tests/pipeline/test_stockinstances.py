"""Stock from published instances: bins with shapes, holes and zones."""

import json
from pathlib import Path

import pytest

from stages.geometry.paths.arcpath import area
from tests.pipeline.stockjobs import ROW, SIDE, drawing, job, outline, refused


def ring(*points: tuple[float, float]) -> list[list[float]]:
    return [[x, y] for x, y in points]


SQUARE = {"type": "simple_polygon", "data": ring((0, 0), (0, 500), (700, 500), (700, 0), (0, 0))}
HOLES = [ring((0, 100), (50, 100), (50, 150)), ring((200, 200), (220, 200), (220, 220))]
HOLED = {"type": "polygon", "data": {"outer": ring(*SIDE), "inner": HOLES}}
CORNER = {"type": "simple_polygon", "data": ring((0, 0), (90, 0), (90, 70), (0, 70))}
BINS = [
    {"id": 0, "cost": 3, "stock": 2, "shape": SQUARE, "zones": []},
    {"id": 7, "cost": 1, "stock": 1, "shape": HOLED, "zones": [{"quality": 1, "shape": CORNER}]},
]


def instance(folder: Path, bins: object) -> None:
    (folder / "set.json").write_text(json.dumps({"name": "set", "items": [], "bins": bins}))


def test_the_pieces_of_an_instance_are_stock(tmp_path: Path) -> None:
    instance(tmp_path, BINS)
    made = job(tmp_path, ROW.format("set.json"))
    plain, holed = made.stock
    assert [plain.id, plain.quantity, plain.price, plain.width_mm, plain.edge_gap_mm] == ["skin-0", 2, 3.0, 700.0, 5.0]
    assert plain.outline is not None
    assert area(plain.outline) == 350_000.0
    assert [holed.id, holed.kind, len(holed.defects)] == ["skin-7", "hide", 2]
    assert [(zone.quality, area(zone.outline)) for zone in holed.zones] == [(1, 6300.0)]
    told = 'stock "skin-7": defects[0] touch or cross the edge: what they cover of it is left out'
    assert made.notes == (told,)


def test_one_piece_of_an_instance_keeps_the_name_that_the_job_gives_it(tmp_path: Path) -> None:
    instance(tmp_path, BINS)
    row = ROW.format("set.json") + "entry = 7\nquantity = 4\nprice = 9\n"
    (sheet,) = job(tmp_path, row).stock
    assert (sheet.id, sheet.quantity, sheet.price, sheet.width_mm) == ("skin", 4, 9.0, 900.0)
    nameless = ROW.format("set.json").replace('id = "skin"\n', "")
    assert [sheet.id for sheet in job(tmp_path, nameless).stock] == ["set-0", "set-7"]


def test_another_file_of_stock_is_another_job(tmp_path: Path) -> None:
    instance(tmp_path, BINS)
    first = job(tmp_path, ROW.format("set.json")).digest
    instance(tmp_path, BINS[:1])
    assert job(tmp_path, ROW.format("set.json")).digest != first


BAD_INSTANCES: dict[str, tuple[object, str]] = {
    "no piece": ([], "stock[0].file: bins: an array of 0 where objects belong (at least one)"),
    "no shape": ([{"id": 3}], "stock[0].file: bin 3: shape: a shape of type nothing (null)"),
    "two points": (
        [{"id": 3, "shape": {"type": "simple_polygon", "data": [[0, 0], [1, 1]]}}],
        "stock[0].file: bin 3: shape: an array of 2 where points belong",
    ),
    "a point in words": (
        [{"id": 3, "shape": {"type": "simple_polygon", "data": [[0, 0], [1, "far"], [2, 2]]}}],
        'stock[0].file: bin 3: shape: point 1: "far" is not a number with a unit',
    ),
    "points in line": (
        [{"id": 3, "shape": {"type": "simple_polygon", "data": [[0, 0], [1, 1], [2, 2]]}}],
        'stock[0].file: "skin" outline: the curve encloses no area',
    ),
    "a quality in words": (
        [{"id": 3, "shape": SQUARE, "zones": [{"quality": "bad", "shape": CORNER}]}],
        'stock[0].file: bin 3: zones[0]: quality is "bad" (a whole number is needed)',
    ),
    "a stock of none": ([{"id": 3, "shape": SQUARE, "stock": 0}], "stock[0].file: bin 3: stock is 0"),
    "a stock of true": ([{"id": 3, "shape": SQUARE, "stock": True}], "stock[0].file: bin 3: stock is true"),
    "a stock beyond all": ([{"id": 3, "shape": SQUARE, "stock": 10**9}], "(a whole number from 1 to 100000)"),
}


@pytest.mark.parametrize("name", BAD_INSTANCES)
def test_an_instance_that_is_none_is_refused(tmp_path: Path, name: str) -> None:
    bins, wanted = BAD_INSTANCES[name]
    instance(tmp_path, bins)
    assert wanted in refused(tmp_path, ROW.format("set.json"))


def test_layers_and_names_go_with_the_right_sort_of_file(tmp_path: Path) -> None:
    instance(tmp_path, BINS)
    drawing(tmp_path, outline)
    assert "stock[0].layers: set.json has no layers" in refused(tmp_path, ROW.format("set.json") + "layers = {}\n")
    assert "stock[0].entry: the pieces of skin.dxf have no names" in refused(
        tmp_path, ROW.format("skin.dxf") + "entry = 1\n"
    )
