"""`[[stock]]`, `[nest]` and the keys of a part about the nest: what they become, and what is refused with its place."""

import math
from pathlib import Path

import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from stages.errors import BadInputError
from stages.geometry.paths.arcpath import area
from stages.model.sheet import NestOptions
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job

HIDE = """\
[[stock]]
id = "hide"
kind = "hide"
outline = { polyline = [[10, 20], [910, 20], [910, 620], [10, 620], [10, 20]] }
edge_gap = 6
defects = [{ circle = { center = [200, 200], radius = 15 } }]
zones = [{ outline = { polyline = [[10, 20], [100, 20], [100, 90], [10, 90], [10, 20]] }, quality = 2 }]
grain = 90
"""
ROLL = '[[stock]]\nid = "roll"\nkind = "roll"\nwidth = 1500\nprice = 12\n'


def job(folder: Path, *tables: str, part: str = "") -> Job:
    text = PLATE.replace('name = "plate"\n', f'name = "plate"\n{part}')
    return job_of(read(write_job(folder, text + "".join(tables))))


def refused(folder: Path, *tables: str, part: str = "") -> list[str]:
    with pytest.raises(BadInputError) as caught:
        job(folder, *tables, part=part)
    return [str(problem).removeprefix(f"{folder}/") for problem in caught.value.problems]


def test_a_hide_lies_where_it_was_drawn_and_there_is_one_of_it(tmp_path: Path) -> None:
    (sheet,) = job(tmp_path, HIDE).stock
    assert (sheet.kind, sheet.quantity, sheet.edge_gap_mm, sheet.grain_deg) == ("hide", 1, 6.0, 90.0)
    assert (sheet.width_mm, sheet.height_mm) == (900.0, 600.0)
    assert sheet.outline is not None
    assert sheet.outline.vertices.min(axis=0).tolist() == [10.0, 20.0]
    assert_near(area(sheet.defects[0]), 225.0 * math.pi, bound=1e-9, why="a circle stays one")
    assert [(zone.quality, area(zone.outline)) for zone in sheet.zones] == [(2, 6300.0)]


def test_a_roll_has_a_width_across_and_no_end(tmp_path: Path) -> None:
    (sheet,) = job(tmp_path, ROLL).stock
    assert (sheet.is_roll, sheet.width_mm, sheet.height_mm, sheet.quantity) == (True, math.inf, 1500.0, None)


def test_a_remnant_is_there_once_and_a_sheet_as_often_as_needed(tmp_path: Path) -> None:
    row = '[[stock]]\nid = "{0}"\nkind = "{0}"\nwidth = 300\nheight = 200\n'
    stock = job(tmp_path, row.format("remnant"), row.format("sheet")).stock
    assert [(sheet.id, sheet.quantity) for sheet in stock] == [("remnant", 1), ("sheet", None)]


def test_lengths_of_outlines_are_in_the_units_of_the_job(tmp_path: Path) -> None:
    text = PLATE.replace("schema = 1", 'schema = 1\nunits = "in"') + HIDE
    (sheet,) = job_of(read(write_job(tmp_path, text))).stock
    assert_near(sheet.width_mm, 900.0 * 25.4, bound=1e-10, why="900 in")


def test_stock_without_a_grain_has_that_of_the_material(tmp_path: Path) -> None:
    stock = job(tmp_path, HIDE, ROLL, "[material]\ngrain = 30\n").stock
    assert [sheet.grain_deg for sheet in stock] == [90.0, 30.0]


def test_the_wishes_for_the_nest_come_through(tmp_path: Path) -> None:
    table = "[nest]\nmirror = true\none_direction = true\ncommon_line = true\noffcut_min = 250\n[process]\nkerf = 0.4\n"
    found = job(tmp_path, table).options
    assert found == NestOptions(mirror=True, one_direction=True, common_line=True, kerf_mm=0.4, offcut_min_mm=250.0)
    assert job(tmp_path, '[process]\ntype = "knife"\n').options == NestOptions()


@pytest.mark.parametrize(
    ("keys", "axis", "band", "quality", "pair"),
    [
        ("", None, 0.0, "best", False),
        ("grain = 30\ngrain_band = 5\nquality = 2\n", 30.0, 5.0, 2, False),
        ('stretch_axis = 30\nquality = "any"\nquantity = 2\npair = true\n', 120.0, 0.0, "any", True),
    ],
)
def test_how_a_part_is_to_lie_reaches_its_pattern(
    tmp_path: Path, keys: str, axis: float | None, band: float, quality: object, *, pair: bool
) -> None:
    from pipeline.run import run_job

    (run,) = run_job(job(tmp_path, "[material]\ngrain = 0\n", part=keys)).parts
    assert run.pattern is not None
    found = run.pattern
    assert (found.axis_deg, found.axis_band_deg, found.quality, found.pair) == (axis, band, quality, pair)


def test_a_mended_outline_is_told(tmp_path: Path) -> None:
    bow_tie = "[[10, 20], [910, 620], [910, 20], [10, 420], [10, 20]]"
    crossing = HIDE.replace("[[10, 20], [910, 20], [910, 620], [10, 620], [10, 20]]", bow_tie)
    inside = crossing.replace("[200, 200], radius = 15", "[850, 300], radius = 15").replace("zones =", "# zones =")
    made = job(tmp_path, inside)
    assert made.notes == (
        'stock "hide": the outline crosses or touches itself: what it encloses once is used; '
        "left out, hanging on by a point: 1 piece of 72000 mm2",
    )


def test_a_defect_at_the_edge_and_curved_contours_are_told(tmp_path: Path) -> None:
    blob = "{ points = [[300, 300], [340, 310], [330, 350], [300, 300]] }"
    made = job(tmp_path, HIDE.replace("[200, 200]", "[12, 200]").replace("defects = [", f"defects = [{blob}, "))
    assert made.notes == (
        'stock "hide": 1 of the defects are curved: taken as straight lines round them, at most 0.2 mm off',
        'stock "hide": defects[1] touch or cross the edge: what they cover of it is left out',
    )


def test_a_sound_stock_needs_no_note(tmp_path: Path) -> None:
    assert job(tmp_path, HIDE, ROLL).notes == ()


BAD_STOCK = {
    "no name": (ROLL.replace('id = "roll"\n', ""), "stock[0].id: missing (give the stock a name)"),
    "no size": ('[[stock]]\nid = "a"\nkind = "hide"\n', "stock[0]: a hide of no size (give its outline, or a file)"),
    "two sizes": (
        HIDE + "width = 300\nheight = 400\n",
        "stock[0].width: beside outline (one of width and height, outline",
    ),
    "a file and a size": (
        ROLL + 'file = "a.dxf"\n',
        "stock[0].width: beside file (one of width and height, outline, file)",
    ),
    "half a rectangle": ('[[stock]]\nid = "a"\nwidth = 3\n', "stock[0].height: missing"),
    "a roll of two sizes": (
        ROLL + "height = 3\n",
        "stock[0].height: without a width, or of a roll (a roll has a width",
    ),
    "a roll with an outline": (
        HIDE.replace('kind = "hide"', 'kind = "roll"'),
        "stock[0].outline: a roll has no outline (give its width, across",
    ),
    "no room across": (
        '[[stock]]\nid = "a"\nwidth = 1000\nheight = 20\n' + "edge_gap = 15\n",
        "stock[0].edge_gap: 15 mm leaves no room",
    ),
    "no room": (ROLL + "edge_gap = 750\n", "stock[0].edge_gap: 750 mm leaves no room"),
    "layers of no file": (ROLL + "layers = {}\n", "stock[0].layers: without a file"),
    "an entry of no file": (ROLL + 'entry = "a"\n', "stock[0].entry: without a file"),
    "an open outline": (
        HIDE.replace("[10, 620], [10, 20]]", "[10, 620]]"),
        "stock[0].outline: the curve does not close: 600 mm are missing (close the curve",
    ),
    "an outline round nothing": (
        HIDE.replace("[910, 620], [10, 620], [10, 20]]", "[10, 20]]"),
        "stock[0].outline: the curve encloses no area",
    ),
    "an outline in space": (
        HIDE.replace("[[10, 20], [910, 20], [910, 620], [10, 620], [10, 20]]", "[[0,0,0],[9,0,0],[9,9,5],[0,0,0]]"),
        "stock[0].outline: the curve leaves the plane of the sheet by 5 mm",
    ),
    "a defect beside the stock": (
        HIDE.replace("[200, 200]", "[2000, 200]"),
        "stock[0].defects[0]: it lies beside the stock",
    ),
    "a zone without a quality": (HIDE.replace(", quality = 2", ""), "stock[0].zones[0].quality: missing"),
    "other material": (
        ROLL + 'material = "brass"\n[material]\nname = "mild steel"\n',
        'stock[0]: "roll" is of "brass" (material.name is "mild steel": take other stock)',
    ),
    "other thickness": (
        ROLL + "thickness = 3\n[material]\nthickness = 2\n",
        'stock[0]: "roll" is 3 mm thick (material.thickness is 2 mm: take other stock)',
    ),
    "common lines of no width": (
        "[nest]\ncommon_line = true\n",
        "nest.common_line: the width of the cut is not known (give process.kerf or process.type",
    ),
    "no offcut": ("[nest]\noffcut_min = 0\n", "nest.offcut_min: 0 (must be above 0)"),
}


@pytest.mark.parametrize("name", BAD_STOCK)
def test_stock_that_is_none_is_refused_with_place_and_remedy(tmp_path: Path, name: str) -> None:
    text, wanted = BAD_STOCK[name]
    (found,) = refused(tmp_path, text)
    assert f" {wanted}" in found
    assert found.startswith("job.toml:")


BAD_PARTS = {
    "two directions": ("grain = 0\nstretch_axis = 0\n", "part[0].stretch_axis: beside grain"),
    "a band round nothing": ("grain_band = 5\n", "part[0].grain_band: without a direction"),
    "a band of more than everything": ("grain = 0\ngrain_band = 91\n", "part[0].grain_band: 91 deg (from 0 to 90 deg"),
    "a pair of one": ("pair = true\n", "part[0].pair: a pair of one copy"),
    "a quality in words": ('quality = "good"\n', 'part[0].quality: "good" '),
    "a direction on stock of none": (
        "grain = 0\n",
        'part[0].grain: the grain of the stock "roll" is not known (give material.grain, or grain under [[stock]])',
    ),
}


@pytest.mark.parametrize("name", BAD_PARTS)
def test_a_part_that_cannot_lie_so_is_refused(tmp_path: Path, name: str) -> None:
    keys, wanted = BAD_PARTS[name]
    stock = ROLL if keys == "grain = 0\n" else ROLL + "grain = 0\n"
    (found,) = refused(tmp_path, stock, part=keys)
    assert f" {wanted}" in found


def test_all_that_is_wrong_with_the_stock_is_told_at_once(tmp_path: Path) -> None:
    open_ = HIDE.replace("[10, 620], [10, 20]]", "[10, 620]]").replace("[10, 90], [10, 20]]", "[10, 90]]")
    found = refused(tmp_path, open_, ROLL + "edge_gap = 800\n")
    assert len(found) == 3
