"""Stock from drawings with layers, and from what is no file of stock."""

from math import pi
from pathlib import Path

import ezdxf
import pytest
from ezdxf.layouts import Modelspace

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.kinds import template
from stages.errors import BadInputError
from stages.geometry.paths.arcpath import area
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job
from tests.pipeline.stockjobs import ROW, drawing, job, outline, refused, remnants


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


def test_layers_that_a_job_names_and_a_drawing_lacks_are_told(tmp_path: Path) -> None:
    def draw(space: Modelspace) -> None:
        outline(space, "Skin")
        space.add_circle((200, 200), 20, dxfattribs={"layer": "Belly"})

    drawing(tmp_path, draw)
    own = 'layers = { outline = ["SKIN"], zones = [{ layer = "BELY", quality = 4 }], defects = ["11", "scar"] }\n'
    made = job(tmp_path, ROW.format("skin.dxf") + own)
    assert made.notes == (
        "skin.dxf: there is nothing on the layers scar, BELY; did you mean Belly?",
        "skin.dxf: nothing is read from the layers Belly",
    )
    wrong = 'layers = { outline = ["SKINN"] }\n'
    with pytest.raises(BadInputError, match=r"no layer SKINN holds an outline .*; did you mean Skin\?"):
        job(tmp_path, ROW.format("skin.dxf") + wrong)


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


def holed(space: Modelspace) -> None:
    outline(space)
    space.add_circle((400, 300), 50, dxfattribs={"layer": "SHEET"})


def flat(space: Modelspace) -> None:
    space.add_lwpolyline([(0, 0), (10, 0), (5, 0)], close=True, dxfattribs={"layer": "SHEET"})


BAD_DRAWINGS = {
    "no outline": (lambda space: outline(space, "CUT"), "no layer SHEET or 21 or 1 holds an outline (put it on SHEET"),
    "letters": (lettered, "skin.dxf: TEXT #"),
    "a stray defect": (stray, "a defect or a zone lies outside every outline (move it"),
    "two directions": (two_ways, "two directions on one piece of stock: 45 and 90 deg"),
    "an open zone": (open_zone, "layer 52: the curve from (0, 0) to (10, 10) mm is open"),
    "a hole on the layer of the outline": (holed, "the outline skin-2 lies within skin-1: a hole is no piece of stock"),
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
