"""The loader of the benchmark: what the files say is what the nest gets, and nothing is left out."""

from math import inf
from pathlib import Path

import msgspec
import pytest

from stages.geometry.paths.arcpath import area
from tests.bench.nest.instances import FOLDER, Instance, from_json, load, on_sheets
from tests.bench.nest.layouts import net_area, net_area_of_sheet
from tests.near import assert_near

ITEM = {"id": 3, "demand": 2, "shape": {"type": "simple_polygon", "data": [[0, 0], [0, 3], [4, 3], [4, 0], [0, 0]]}}
HOLED = {"type": "polygon", "data": {"outer": [[0, 0], [9, 0], [9, 9], [0, 9]], "inner": [[[3, 3], [6, 3], [6, 6]]]}}
BOX = {"type": "rectangle", "data": {"x_min": 0, "y_min": 0, "width": 20, "height": 10}}
BIN = {"id": 7, "shape": BOX, "stock": 4, "cost": 2.5}


def read(**keys: object) -> Instance:
    return from_json("made", msgspec.json.encode({"items": [ITEM], **keys}))


def test_the_stored_instances_are_a_hide_sheets_and_a_strip() -> None:
    found = {one.name: one for one in load(FOLDER)}
    assert {name: (one.parts, one.stock[0].kind) for name, one in found.items()} == {
        "hide_synth_a": (66, "hide"),
        "sheets_ducts_a": (63, "sheet"),
        "strip_jigsaw20": (20, "roll"),
    }
    assert {one.quality for one in found["hide_synth_a"].patterns} == {1, 2, 3}
    assert found["sheets_ducts_a"].options.gap_mm == 2.0
    assert all(sheet.edge_gap_mm == 8.0 for sheet in found["hide_synth_a"].stock)


def test_an_instance_taken_from_a_file_has_the_areas_of_the_file() -> None:
    for one in load(FOLDER):
        for pattern, item in zip(one.patterns, _items(FOLDER / f"{one.name}.json"), strict=True):
            rings = _rings(item["shape"])
            wanted = abs(_shoelace(rings[0])) - sum(abs(_shoelace(ring)) for ring in rings[1:])
            assert_near(net_area(pattern), wanted, bound=1e-9 * wanted, why="two sums over up to 50 corners")
            assert area(pattern.outer.path) > 0.0, "outer contours run counter-clockwise"


def test_a_clockwise_closed_ring_becomes_an_open_one_the_other_way_round() -> None:
    pattern = read(strip_height=9.0).patterns[0]
    assert pattern.outer.path.vertices.shape == (4, 2)
    assert area(pattern.outer.path) == 12.0
    assert (pattern.part, pattern.quantity) == ("part-3", 2)


def test_a_strip_is_a_roll_without_end_of_that_width() -> None:
    made = read(strip_height=9.0, min_edge_separation=1.0)
    assert made.is_strip
    assert (made.stock[0].width_mm, made.stock[0].height_mm, made.stock[0].edge_gap_mm) == (inf, 9.0, 1.0)


def test_absent_orientations_are_any_and_given_ones_are_kept() -> None:
    free = read(strip_height=9.0)
    assert (free.patterns[0].rotations, free.options.rotations) == (None, None)
    listed = from_json(
        "made", msgspec.json.encode({"items": [ITEM | {"allowed_orientations": [0, 90]}], "bins": [BIN]})
    )
    assert listed.patterns[0].rotations == (0.0, 90.0)


def test_absent_quality_is_the_best_and_a_given_one_is_kept() -> None:
    assert read(bins=[BIN]).patterns[0].quality == "best"
    made = read(items=[ITEM | {"min_quality": 2}], bins=[BIN])
    assert made.patterns[0].quality == 2


def test_a_bin_that_is_a_plain_rectangle_is_a_sheet_with_stock_and_price() -> None:
    sheet = read(bins=[BIN]).stock[0]
    assert sheet.is_rectangle
    assert (sheet.id, sheet.width_mm, sheet.height_mm, sheet.quantity, sheet.price) == ("sheet-7", 20.0, 10.0, 4, 2.5)


def test_holes_of_a_bin_are_defects_and_its_zones_are_zones() -> None:
    zone = {"quality": 1, "shape": {"type": "simple_polygon", "data": [[0, 0], [1, 0], [1, 1]]}}
    hide = read(bins=[BIN | {"shape": HOLED, "zones": [zone]}]).stock[0]
    assert (hide.kind, len(hide.defects), hide.zones[0].quality) == ("hide", 1, 1)
    assert_near(net_area_of_sheet(hide), 81.0 - 4.5, bound=1e-12, why="whole numbers")


def test_holes_of_an_item_are_holes_of_the_part() -> None:
    made = read(items=[ITEM | {"shape": HOLED}], strip_height=9.0)
    assert_near(net_area(made.patterns[0]), 81.0 - 4.5, bound=1e-12, why="whole numbers")


@pytest.mark.parametrize(
    ("keys", "complaint"),
    [
        ({}, "either strip_height or bins"),
        ({"strip_height": 9.0, "bins": [BIN]}, "either strip_height or bins"),
        ({"items": [ITEM | {"zones": [{"quality": 1, "shape": BOX}]}], "strip_height": 9.0}, "zones of a part"),
        ({"bins": [BIN | {"zones": [{"quality": 1, "shape": HOLED}]}]}, "zone with holes"),
        ({"items": [ITEM | {"shape": {"type": "blob"}}], "strip_height": 9.0}, "blob"),
    ],
)
def test_what_cannot_be_honoured_is_an_error_that_names_the_file(keys: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValueError, match=rf"made\.json: .*{complaint}"):
        read(**keys)


def test_a_strip_put_on_sheets_keeps_its_parts() -> None:
    strip = read(strip_height=9.0, min_edge_separation=1.0)
    moved = on_sheets(strip, 63.0, 79.0)
    assert moved.patterns == strip.patterns
    assert (moved.stock[0].width_mm, moved.stock[0].height_mm, moved.stock[0].quantity) == (63.0, 79.0, None)
    assert moved.stock[0].edge_gap_mm == 1.0


def _items(file: Path) -> list[dict]:
    return msgspec.json.decode(file.read_bytes())["items"]


def _rings(shape: dict) -> list[list[list[float]]]:
    data = shape["data"]
    return [data] if shape["type"] == "simple_polygon" else [data["outer"], *data["inner"]]


def _shoelace(ring: list[list[float]]) -> float:
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)) / 2.0
