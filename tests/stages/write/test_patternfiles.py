"""Pattern files: what they hold, that nothing is lost on the way, and that two processes write the same."""

import subprocess
import sys
from dataclasses import replace
from functools import cache
from io import StringIO
from itertools import pairwise

import ezdxf
import numpy as np
import pytest
from ezdxf import bbox
from ezdxf.document import Drawing as Document
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import norm
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths.arcpath import area, length
from stages.model.cutfile import FILE_NAMES, FilePer
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import PATTERN_LAYERS, STANDARD, TURN
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.piecedxf import pieces_text
from stages.write.pieces import NAME_MOST, block_names, flat_file, quantity
from stages.write.readback import read
from stages.write.readpieces import read_pieces
from stages.write.tracing import as_pattern
from tests.near import assert_near, assert_relative
from tests.stages.write.patterns import CHORD_MM, drop, fan, nesting, plate, sector, strip
from tests.stages.write.pieces import MACHINE, NOTCH_ON_ARC, flap

PARTS = [as_pattern(part) for part in (flap(), plate(), sector(), strip(), drop())]


@cache
def texts() -> dict[str, str]:
    return written(PARTS)


def written(parts: list[FlatPattern], nest: Nesting | None = None, per: FilePer = "sheet") -> dict[str, str]:
    name = FILE_NAMES[per].replace("{job}", "all")
    outcome = write(parts, nest, replace(MACHINE, file_per=per, file_name=name))
    assert outcome.report.passed, outcome.report.findings
    assert outcome.report.findings == ()
    return {file.path: file.text for file in outcome.product}


def document(text: str) -> Document:
    return ezdxf.read(StringIO(text))


def test_every_part_has_a_file_of_its_own_and_all_are_in_one() -> None:
    found = texts()
    assert list(found) == [*(f"flat/{part.part}.dxf" for part in PARTS), "pieces/bag.dxf"]
    names = [block.name for block in read_pieces(found["pieces/bag.dxf"]).blocks]
    assert names == ["FLAP_M", "PLATE_M", "SECTOR_M", "STRIP_M", "DROP_M"]


def test_the_style_stands_below_all_pieces_and_begins_where_the_leftmost_does() -> None:
    found = document(texts()["pieces/bag.dxf"]).modelspace()
    low = bbox.extents(found.query("INSERT")).extmin
    style = [text for text in found.query("TEXT") if text.dxf.insert.y < low.y]
    assert any(text.dxf.text.startswith("Curve Tolerance") for text in style)
    assert style == list(found.query("TEXT"))
    assert_near(max(abs(text.dxf.insert.x - low.x) for text in style), 0.0, bound=1e-3, why="arcs by chords")


def test_an_apex_is_one_turn_point() -> None:
    text = written([as_pattern(fan())])["flat/fan.dxf"]
    (block,) = read_pieces(text).blocks
    corners = sorted((point.x, point.y) for point in block.points if point.layer == TURN)
    assert_near(np.array(corners), [[0, 0], [45, 45 * 3**0.5], [90, 0]], bound=1e-9, why="decimals")


def test_the_library_finds_nothing_but_the_standard() -> None:
    """Layers of all entities, their vertices, blocks and inserts; no block but the pieces; no bulge; R12."""
    text = texts()["pieces/bag.dxf"]
    found = document(text)
    assert found.acad_release == "R12"
    assert found.audit().errors == []
    assert text.count("\nBLOCK\n") == text.count("\nINSERT\n") == len(PARTS)
    seen = [entity for block in found.blocks for entity in block]
    assert {entity.dxf.layer for entity in seen} <= STANDARD
    corners = [corner for entity in seen if entity.dxftype() == "POLYLINE" for corner in entity.vertices]
    assert {corner.dxf.layer for corner in corners} <= STANDARD
    assert not any(corner.dxf.bulge for corner in corners)
    assert {entity.dxftype() for entity in seen} == {"INSERT", "POLYLINE", "LINE", "POINT", "TEXT"}


def test_a_flap_says_all_that_the_standard_has_for_it() -> None:
    block = read_pieces(texts()["flat/flap.dxf"]).blocks[0]
    lines = [line.layer for line in block.lines]
    assert lines == ["8", "85", "14", "87", "7", "11", "86", "11", "86", "1", "84"]
    spots = {point.layer: point for point in block.points if point.layer not in ("2", "3")}
    assert set(spots) == {"4", "81", "13"}
    assert (spots["13"].x, spots["13"].y, spots["13"].width_mm) == (10.0, 30.0, 1.0)
    assert (spots["81"].depth_mm, spots["81"].width_mm, spots["81"].angle_deg) == (4.0, 3.0, 270.0)
    slits = [point for point in block.points if point.layer == "4" and point.width_mm == 0.0]
    vees = [point for point in block.points if point.layer == "4" and point.width_mm > 0.0]
    assert [(one.x, one.y, one.depth_mm, one.angle_deg) for one in slits] == [(0.0, 10.0, 4.0, 0.0)]
    assert_near((vees[0].x, vees[0].y), NOTCH_ON_ARC, bound=1e-10, why="rounded to ten decimals")
    assert_near(vees[0].angle_deg, 210.0, bound=1e-9, why="towards the centre")
    said = [text.text for text in block.texts if text.layer == "1"]
    assert said == [
        "Piece Name: flap", "Size: M", "Category: flap", "Annotation: 1.6 mm thick", "Quantity: 2,1", "Material: calf",
    ]  # fmt: skip
    assert [text.text for text in block.texts if text.layer == "15"] == ["front"]


def test_the_style_says_units_date_and_tolerance_beside_all_pieces() -> None:
    space = read_pieces(texts()["pieces/bag.dxf"]).space
    assert [text.text for text in space.texts] == [
        "ASTM/D13Proposal 1 Version: D 6673-04", "Style Name: bag", "Creation Date: 01-01-2000", "Creation Time: 12:00",
        "Author: planish", "Sample Size: M", "Grade Rule Table: NONE", "Units: METRIC", "Curve Tolerance: 0.02",
    ]  # fmt: skip
    assert {text.layer for text in space.texts} == {"1"}


def test_pieces_of_a_style_lie_beside_each_other() -> None:
    boxes = []
    for block in read_pieces(texts()["pieces/bag.dxf"]).blocks:
        outline = next(line.path for line in block.lines if line.layer == "1")
        assert outline is not None
        boxes.append((outline.vertices[:, 0].min(), outline.vertices[:, 0].max(), outline.vertices[:, 1].min()))
    for (_, before, _), (after, _, _) in pairwise(boxes):
        assert_near(after - before, 20.0, bound=1e-9, why="the gap, rounded twice")
    assert_near([box[2] for box in boxes], [0.0] * len(boxes), bound=1e-9, why="one base line")


def test_the_grain_line_lies_within_the_piece_along_its_direction() -> None:
    block = read_pieces(texts()["flat/flap.dxf"]).blocks[0]
    (line,) = [one.path for one in block.lines if one.layer == "7"]
    assert line is not None
    way = line.vertices[1] - line.vertices[0]
    assert_near(np.degrees(np.arctan2(way[1], way[0])) % 180.0, 30.0, bound=1e-8, why="coordinates rounded to 1e-10 mm")
    # from (40, 0) at 30 degrees down to x = 0, and up to the half circle: its middle is 40 from there along x
    half_circle = 40.0 * np.cos(np.pi / 6.0) + np.sqrt(40.0**2 - (40.0 * 0.5) ** 2)
    across = 40.0 / np.cos(np.pi / 6.0) + half_circle
    assert_near(norm(way), 0.8 * across, bound=2.0 * CHORD_MM, why="80 % of the way across, to a chord")
    assert not any(one.layer == "7" for one in read_pieces(texts()["flat/plate.dxf"]).blocks[0].lines)


def test_figures_are_measured_on_what_was_read_and_within_the_tolerance() -> None:
    report = write(PARTS, None, MACHINE).report
    deviation = report.metric("max_deviation_mm")
    assert deviation.limit == CHORD_MM
    assert 0.3 * CHORD_MM < deviation.value <= CHORD_MM
    said = report.detail["pieces"]
    vertices = sum(
        line.path.bulges.size
        for line in read_pieces(texts()["flat/flap.dxf"]).blocks[0].lines
        if line.layer in ("1", "8", "11", "14") and line.path is not None
    )
    # four of the outline and of the sew line, three of the mark, both ends of the slit
    assert said["flat/flap.dxf"] == {
        "pieces": 1, "turn_points": 13, "curve_points": vertices - 13, "notches": 3, "drill_holes": 1,
    }  # fmt: skip


@pytest.mark.parametrize("per", ["sheet", "material"])
def test_a_nested_copy_is_a_piece_where_it_lies_and_is_inserted_unturned(per: FilePer) -> None:
    parts = [plate(), sector()]
    found = written(parts, nesting(), per)
    back = [read_pieces(text) for path, text in found.items() if path.startswith("cut/")]
    names = [block.name for file in back for block in file.blocks]
    assert names == ["PLATE-1_M", "PLATE-2_M", "SECTOR-1_M", "SECTOR-2_M", "PLATE-3_M"]
    assert {(one.x, one.y, one.scale, one.angle_deg) for file in back for one in file.inserts} == {
        (0.0, 0.0, (1.0, 1.0), 0.0)
    }
    stock = [line for file in back for line in file.space.lines]
    assert {line.layer for line in stock} == {"8"}
    assert all(line.path is not None and line.path.closed for line in stock)


def test_parts_by_themselves_are_written_as_in_flat() -> None:
    found = written([plate(), sector()], nesting(), "part")
    assert found["cut/plate.dxf"] == found["flat/plate.dxf"]


MOTIONS = st.builds(
    Rigid2, st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0), st.floats(0.0, 360.0), mirrored=st.booleans()
)


@settings(max_examples=3, deadline=None)
@given(MOTIONS)
def test_a_placed_piece_keeps_its_size_its_points_and_the_way_its_notches_point(motion: Rigid2) -> None:
    layout = SheetLayout(Sheet("stock", 500.0, 300.0), 1, (Placement("flap", 1, motion),), 0.1)
    flat = PARTS[0]
    block = read_pieces(written([flat], Nesting((layout,)))["cut/stock-1.dxf"]).blocks[0]
    outline = next(line.path for line in block.lines if line.layer == "1")
    assert outline is not None
    assert_near(length(outline), length(flat.outer.path), bound=1e-7, why="some 60 vertices rounded to 1e-10 mm")
    assert_relative(area(outline), area(flat.outer.path), bound=1e-9, why="the same, over an area of 1e4 mm2")
    assert flat.outer.traced is not None
    corners = apply(motion, flat.outer.path.vertices[np.array(flat.outer.traced.turns)])
    turns = np.array([(one.x, one.y) for one in block.points if one.layer == "2"])
    assert max(norm(turns - corner).min() for corner in corners) < 1e-9
    castle = next(one for one in block.points if one.layer == "81")
    ahead = apply(motion, np.array([[40.0, 40.0], [40.0, 39.0]]))
    way = np.array([np.cos(np.radians(castle.angle_deg)), np.sin(np.radians(castle.angle_deg))])
    assert_near(way, ahead[1] - ahead[0], bound=1e-9, why="a turned unit vector, rounded")


def test_the_drawing_of_a_pattern_file_is_what_will_be_cut() -> None:
    back = read(texts()["flat/flap.dxf"], PATTERN_LAYERS)
    kinds = [(entity.layer, entity.closed) for entity in back.entities if entity.kind != "TEXT"]
    assert kinds == [
        ("MARK", False), ("SEW", True), ("GRAIN", False), ("CUT_SLIT", False), ("CUT_INNER", True), ("CUT_OUTER", True),
    ]  # fmt: skip


def test_two_processes_write_the_same_bytes() -> None:
    code = "\n".join([
        "from hashlib import sha256",
        "from tests.stages.write.test_patternfiles import PARTS, written",
        "for path, text in written(PARTS[:2]).items(): print(path, sha256(text.encode()).hexdigest())",
    ])  # fmt: skip
    seen = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": seed}
        )
        for seed in ("1", "2")
    ]
    assert len(seen[0].stdout.splitlines()) == 3
    assert seen[0].stdout == seen[1].stdout


def test_names_of_blocks_are_those_of_r12_and_no_two_alike() -> None:
    names = block_names(["a.b c_M", "A_B_C_M", "x" * 40, "x" * 41, "\u00e4_M"])
    assert names == ["A_B_C_M", "A_B_C_M-2", "X" * NAME_MOST, f"{'X' * (NAME_MOST - 2)}-2", "__M"]


def test_of_a_pair_every_second_copy_is_the_mirror_image() -> None:
    assert quantity(plate().replace(quantity=5, pair=True)) == "3,2"
    assert quantity(plate().replace(quantity=5)) == "5"


def test_numbers_that_are_not_finite_reach_no_file() -> None:
    part = as_pattern(flap())
    broken = flat_file(part.replace(texts=()), MACHINE)
    spot = broken.pieces[0].spots[0].replace(depth_mm=float("nan"))
    piece = replace(broken.pieces[0], spots=(spot,))
    with pytest.raises(ValueError, match="finite"):
        pieces_text(replace(broken, pieces=(piece,)), MACHINE)
