"""Stock from drawings with layers, from published instances, and from the remnants of earlier jobs."""

import json
from collections.abc import Callable
from math import pi
from pathlib import Path

import ezdxf
import pytest
from ezdxf.layouts import Modelspace

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.kinds import template
from stages.errors import BadInputError
from stages.geometry.arcpath import area
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job

SIDE = [(0, 0), (900, 0), (900, 600), (0, 600)]
ROW = '[[stock]]\nid = "skin"\nkind = "hide"\nfile = "{}"\nedge_gap = 5\n'


def job(folder: Path, stock: str) -> Job:
    return job_of(read(write_job(folder, PLATE + stock)))


def refused(folder: Path, stock: str) -> str:
    with pytest.raises(BadInputError) as caught:
        job(folder, stock)
    (problem,) = caught.value.problems
    return str(problem).removeprefix(f"{folder}/")


def drawing(folder: Path, draw: Callable[[Modelspace], None], name: str = "skin.dxf") -> None:
    document = ezdxf.new("R2000", units=ezdxf.units.MM)
    draw(document.modelspace())
    document.saveas(folder / name)


def outline(space: Modelspace, layer: str = "SHEET", dx: float = 0.0) -> None:
    space.add_lwpolyline([(x + dx, y) for x, y in SIDE], close=True, dxfattribs={"layer": layer})


def whole(space: Modelspace) -> None:
    outline(space)
    space.add_circle((200, 200), 20, dxfattribs={"layer": "SHEET_KEEPOUT"})
    space.add_circle((400, 200), 30, dxfattribs={"layer": "11"})
    space.add_circle((600, 200), 40, dxfattribs={"layer": "50"})
    space.add_circle((700, 400), 50, dxfattribs={"layer": "56"})
    space.add_line((100, 100), (100, 500), dxfattribs={"layer": "33"})


def test_the_layers_of_leather_cad_are_outline_defects_zones_and_stretch(tmp_path: Path) -> None:
    drawing(tmp_path, whole)
    made = job(tmp_path, ROW.format("skin.dxf"))
    (sheet,) = made.stock
    assert (sheet.id, sheet.kind, sheet.width_mm, sheet.height_mm, sheet.edge_gap_mm) == ("skin", "hide", 900, 600, 5)
    assert_near([area(path) for path in sheet.defects], [400 * pi, 900 * pi], bound=1e-9, why="circles")
    assert [zone.quality for zone in sheet.zones] == [7, 1]
    assert sheet.grain_deg is not None
    assert_near(sheet.grain_deg % 180.0, 0.0, bound=1e-12, why="it stretches across the line of tightness")
    assert [name for name, _ in made.inputs] == ["job.toml", "skin.dxf"]
    assert made.notes == ()


def test_the_grain_line_lies_along_the_grain_and_the_job_goes_first(tmp_path: Path) -> None:
    def draw(space: Modelspace) -> None:
        outline(space, "1")
        space.add_line((100, 100), (100, 500), dxfattribs={"layer": "7"})

    drawing(tmp_path, draw)
    assert job(tmp_path, ROW.format("skin.dxf")).stock[0].grain_deg == 90.0
    assert job(tmp_path, ROW.format("skin.dxf") + "grain = 5\n").stock[0].grain_deg == 5.0


def test_every_outline_of_a_drawing_is_a_hide_with_what_lies_on_it(tmp_path: Path) -> None:
    def draw(space: Modelspace) -> None:
        whole(space)
        outline(space, dx=1000.0)
        space.add_circle((1200, 200), 10, dxfattribs={"layer": "11"})
        space.add_line((1100, 100), (1200, 200), dxfattribs={"layer": "7"})

    drawing(tmp_path, draw)
    left, right = job(tmp_path, ROW.format("skin.dxf")).stock
    assert [left.id, right.id] == ["skin-1", "skin-2"]
    assert [len(left.defects), len(right.defects)] == [2, 1]
    assert [len(left.zones), len(right.zones)] == [2, 0]
    assert right.grain_deg == 45.0


def test_layers_of_ones_own_are_said_in_the_job_file(tmp_path: Path) -> None:
    def draw(space: Modelspace) -> None:
        outline(space, "Skin")
        space.add_circle((200, 200), 20, dxfattribs={"layer": "Belly"})
        space.add_circle((200, 200), 5, dxfattribs={"layer": "Ticks"})

    drawing(tmp_path, draw)
    own = 'layers = { outline = ["SKIN"], zones = [{ layer = "belly", quality = 4 }] }\n'
    made = job(tmp_path, ROW.format("skin.dxf") + own)
    assert [zone.quality for zone in made.stock[0].zones] == [4]
    assert made.notes == ("skin.dxf: nothing is read from the layers Ticks",)


def test_a_drawing_without_a_unit_has_that_of_the_job(tmp_path: Path) -> None:
    drawing(tmp_path, outline)
    document = ezdxf.readfile(tmp_path / "skin.dxf")
    document.header["$INSUNITS"] = 0
    document.saveas(tmp_path / "skin.dxf")
    text = PLATE.replace("schema = 1", 'schema = 1\nunits = "cm"') + ROW.format("skin.dxf")
    made = job_of(read(write_job(tmp_path, text)))
    assert made.stock[0].width_mm == 9000.0
    assert made.notes == ("skin.dxf states no unit ($INSUNITS = 0): taken as cm, the unit of the job",)


def test_defects_of_a_layer_go_with_an_outline_in_the_job_file(tmp_path: Path) -> None:
    drawing(tmp_path, whole)
    row = """\
[[stock]]
id = "skin"
kind = "hide"
outline = { file = "skin.dxf", layer = "SHEET" }
defects = { file = "skin.dxf", layer = "SHEET_KEEPOUT" }
zones = [{ outline = { file = "skin.dxf", layer = "56" }, quality = 3 }]
"""
    (sheet,) = job(tmp_path, row).stock
    assert [len(sheet.defects), len(sheet.zones), sheet.zones[0].quality] == [1, 1, 3]


def stray(space: Modelspace) -> None:
    outline(space)
    space.add_circle((2000, 200), 20, dxfattribs={"layer": "11"})


def two_ways(space: Modelspace) -> None:
    outline(space)
    space.add_line((100, 100), (200, 200), dxfattribs={"layer": "7"})
    space.add_line((100, 100), (200, 100), dxfattribs={"layer": "33"})


def open_zone(space: Modelspace) -> None:
    outline(space)
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10)], dxfattribs={"layer": "52"})


def lettered(space: Modelspace) -> None:
    outline(space)
    space.add_text("hide 7", dxfattribs={"layer": "SHEET"})


def flat(space: Modelspace) -> None:
    space.add_lwpolyline([(0, 0), (10, 0), (5, 0)], close=True, dxfattribs={"layer": "SHEET"})


BAD_DRAWINGS = {
    "no outline": (lambda space: outline(space, "CUT"), "no layer SHEET or 21 or 1 holds an outline (put it on SHEET"),
    "letters": (lettered, "skin.dxf: TEXT #"),
    "a stray defect": (stray, "a defect or a zone lies outside every outline (move it"),
    "two directions": (two_ways, "two directions on one piece of stock: 45 and 90 deg"),
    "an open zone": (open_zone, "layer 52: the curve from (0, 0) to (10, 10) mm is open"),
    "an outline round nothing": (flat, '"skin" outline: the curve encloses no area'),
}


@pytest.mark.parametrize("name", BAD_DRAWINGS)
def test_a_drawing_that_is_no_stock_is_refused(tmp_path: Path, name: str) -> None:
    draw, wanted = BAD_DRAWINGS[name]
    drawing(tmp_path, draw)
    assert f"stock[0].file: {wanted}" in refused(tmp_path, ROW.format("skin.dxf"))


def test_layers_that_mean_two_things_are_refused(tmp_path: Path) -> None:
    drawing(tmp_path, whole)
    row = ROW.format("skin.dxf") + 'layers = { defects = ["1"] }\n'
    assert 'stock[0].layers.defects[0]: the layer "1" is outline[2] as well' in refused(tmp_path, row)


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
}


@pytest.mark.parametrize("name", BAD_INSTANCES)
def test_an_instance_that_is_none_is_refused(tmp_path: Path, name: str) -> None:
    bins, wanted = BAD_INSTANCES[name]
    instance(tmp_path, bins)
    assert wanted in refused(tmp_path, ROW.format("set.json"))


REMNANTS = {
    "schema": "planish-remnant/1",
    "remnants": [
        {
            "id": f"plate-{i}", "width_mm": 812.5, "height_mm": 100.25 * i, "material": "DC01", "thickness_mm": 2.0,
            "grain_deg": 90.0, "from": {"job": "hoppers", "stock": "plate", "sheet": i, "x": 1687.5, "y": 0.0},
        }
        for i in (1, 2)
    ],
}  # fmt: skip
FROM_REMNANTS = '[[stock]]\nfile = "remnant.json"\nedge_gap = 4\n'


def remnants(folder: Path, **changes: object) -> None:
    entries = [entry | changes for entry in REMNANTS["remnants"]]  # type: ignore[operator]
    (folder / "remnant.json").write_text(json.dumps(REMNANTS | {"remnants": entries}))


def test_the_remnants_of_a_job_are_stock_for_the_next(tmp_path: Path) -> None:
    remnants(tmp_path)
    first, second = job(tmp_path, FROM_REMNANTS + '[material]\nname = "mild steel"\nthickness = 2\n').stock
    assert [first.id, first.kind, first.quantity, first.edge_gap_mm] == ["plate-1", "remnant", 1, 4.0]
    assert [first.width_mm, first.height_mm, first.grain_deg] == [812.5, 100.25, 90.0]
    assert [second.id, second.height_mm] == ["plate-2", 200.5]


def test_remnants_are_in_mm_whatever_the_units_of_the_job(tmp_path: Path) -> None:
    remnants(tmp_path)
    text = PLATE.replace("schema = 1", 'schema = 1\nunits = "in"') + '[[stock]]\nfile = "remnant.json"\n'
    assert job_of(read(write_job(tmp_path, text))).stock[0].width_mm == 812.5


def test_one_remnant_may_be_asked_for_and_named(tmp_path: Path) -> None:
    remnants(tmp_path)
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'entry = "plate-2"\n').stock] == ["plate-2"]
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'entry = "plate-2"\nid = "rest"\n').stock] == ["rest"]
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'id = "rest"\n').stock] == ["rest-plate-1", "rest-plate-2"]


def test_what_is_not_known_of_a_remnant_is_not_held_against_it(tmp_path: Path) -> None:
    remnants(tmp_path, material=None, thickness_mm=None, grain_deg=None)
    made = job(tmp_path, FROM_REMNANTS + '[material]\nname = "brass"\nthickness = 3\ngrain = 7\n')
    assert [sheet.grain_deg for sheet in made.stock] == [7.0, 7.0]


BAD_REMNANTS = {
    "another material": ('[material]\nname = "brass"\n', {}, 'stock[0]: "plate-1" is of "DC01"'),
    "another thickness": ("[material]\nthickness = 3\n", {}, 'stock[0]: "plate-1" is 2 mm thick'),
    "no width": ("", {"width_mm": None}, "stock[0].file: remnant plate-1: width_mm: nothing (null) where"),
    "no height": ("", {"height_mm": 0}, "stock[0].file: remnant plate-1: height_mm is 0 (must be above 0)"),
    "no such remnant": ('entry = "plate-3"\n', {}, 'stock[0].entry: there is no "plate-3" in the file (did you mean'),
}


@pytest.mark.parametrize("name", BAD_REMNANTS)
def test_a_remnant_that_does_not_do_is_refused(tmp_path: Path, name: str) -> None:
    table, changes, wanted = BAD_REMNANTS[name]
    remnants(tmp_path, **changes)
    if not table.startswith("entry"):
        table = f'entry = "plate-1"\n{table}'
    assert wanted in refused(tmp_path, FROM_REMNANTS + table)


@pytest.mark.parametrize(
    ("content", "wanted"),
    [
        ("{", "stock[0].file: this is no JSON that can be read"),
        ("[]", "stock[0].file: an array of 0 where the stock belongs"),
        ("{}", 'stock[0].file: the JSON file holds no stock ("bins", or "schema": "planish-remnant/1")'),
        ("[" * 100_000, "stock[0].file: this is no JSON that can be read"),
    ],
)
def test_a_json_file_that_holds_no_stock_is_refused(tmp_path: Path, content: str, wanted: str) -> None:
    (tmp_path / "set.json").write_text(content)
    assert wanted in refused(tmp_path, ROW.format("set.json"))


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    for name in ("none.json", "none.dxf"):
        assert f"stock[0].file: there is no file {name}" in refused(tmp_path, ROW.format(name))


def test_layers_and_names_go_with_the_right_sort_of_file(tmp_path: Path) -> None:
    instance(tmp_path, BINS)
    drawing(tmp_path, outline)
    assert "stock[0].layers: set.json has no layers" in refused(tmp_path, ROW.format("set.json") + "layers = {}\n")
    assert "stock[0].entry: the pieces of skin.dxf have no names" in refused(
        tmp_path, ROW.format("skin.dxf") + "entry = 1\n"
    )


def test_the_stock_in_the_comments_of_a_template_is_read(tmp_path: Path) -> None:
    def draw(space: Modelspace) -> None:
        outline(space)
        space.add_circle((600, 200), 40, dxfattribs={"layer": "BELLY"})

    drawing(tmp_path, draw, "hide.dxf")
    remnants(tmp_path, material=None, thickness_mm=None)
    begin, end = "# [[stock]]", "[nest]"
    text = template("flat")
    comments = text[text.index(begin) : text.index(end)].splitlines()
    keys = [line.removeprefix("# ") for line in comments if "=" in line.split("  ")[0] or "[[" in line]
    made = job(tmp_path, "\n".join(keys))
    assert [sheet.kind for sheet in made.stock] == ["roll", "remnant", "remnant", "hide"]
    assert [zone.quality for zone in made.stock[3].zones] == [2]
