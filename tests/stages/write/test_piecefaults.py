"""Every fault of a pattern file is found by itself, in a file that is otherwise good; good files have none."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from io import StringIO

import ezdxf
import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities import DXFEntity, Point, Polyline, Text

from stages.geometry.plane import CircularArc
from stages.model.cutfile import CutFile
from stages.write.patternfiles import judged_patterns
from stages.write.piecedxf import pieces_text
from stages.write.piecefaults import piece_faults
from stages.write.pieces import PatternFile, flat_file, style_file
from stages.write.readpieces import read_pieces
from stages.write.tracing import as_pattern
from tests.stages.write.patterns import sector
from tests.stages.write.pieces import MACHINE, flap

FLAP = as_pattern(flap())
SECTOR = as_pattern(sector())


@cache
def file() -> PatternFile:
    return flat_file(FLAP, MACHINE)


@cache
def good() -> str:
    return pieces_text(file(), MACHINE)


def codes(text: str) -> set[str]:
    return {finding.code for finding in piece_faults(read_pieces(text), "flat/flap.dxf")}


def told(text: str) -> set[str]:
    report = judged_patterns([CutFile("flat/flap.dxf", text)], [file()], {"flap": FLAP}, MACHINE)
    return {finding.code for finding in report.findings if finding.fatal}


def changed(change: Callable[[Document], None]) -> str:
    found = ezdxf.read(StringIO(good()))
    found.modelspace().reset_extents(found.header["$EXTMIN"], found.header["$EXTMAX"])
    change(found)
    stream = StringIO()
    found.write(stream)
    return stream.getvalue().replace(
        "  9\n$LUNITS\n", "  9\n$INSUNITS\n 70\n4\n  9\n$MEASUREMENT\n 70\n1\n  9\n$LUNITS\n", 1
    )


def block(found: Document) -> ezdxf.layouts.BlockLayout:
    return found.blocks["FLAP_M"]


def on(found: Document, layer: str, kind: type[DXFEntity]) -> list[DXFEntity]:
    return [entity for entity in block(found) if entity.dxf.layer == layer and isinstance(entity, kind)]


def outline(found: Document) -> Polyline:
    (line,) = on(found, "1", Polyline)
    assert isinstance(line, Polyline)
    return line


def move_vertex(found: Document) -> None:
    outline(found).vertices[3].dxf.location += (0.0, 1e-3, 0.0)


def lose_turn_point(found: Document) -> None:
    block(found).delete_entity(on(found, "2", Point)[0])


def lose_curve_point(found: Document) -> None:
    block(found).delete_entity(on(found, "3", Point)[5])


def flag_twice(found: Document) -> None:
    block(found).add_point(on(found, "2", Point)[0].dxf.location, dxfattribs={"layer": "3"})


def stray_point(found: Document) -> None:
    block(found).add_point((1.0, 1.0), dxfattribs={"layer": "3"})


def open_outline(found: Document) -> None:
    outline(found).dxf.flags &= ~1


def bend(found: Document) -> None:
    outline(found).vertices[2].dxf.bulge = 0.1


def turn_round(found: Document) -> None:
    line = outline(found)
    line.vertices.reverse()


def cut_out_the_wrong_way(found: Document) -> None:
    on(found, "11", Polyline)[-1].vertices.reverse()


def second_outline(found: Document) -> None:
    block(found).add_entity(outline(found).copy())


def no_outline(found: Document) -> None:
    block(found).delete_entity(outline(found))


def foreign_layer(found: Document) -> None:
    found.layers.add("CUT")
    outline(found).dxf.layer = "CUT"


def metal_layer(found: Document) -> None:
    block(found).add_line((1.0, 1.0), (2.0, 2.0), dxfattribs={"layer": "16"})


def line_among_points(found: Document) -> None:
    block(found).add_line((1.0, 1.0), (2.0, 2.0), dxfattribs={"layer": "4"})


def circle(found: Document) -> None:
    block(found).add_circle((10.0, 10.0), 2.0, dxfattribs={"layer": "11"})


def block_elsewhere(found: Document) -> None:
    block(found).block.dxf.layer = "0"


def turned_insert(found: Document) -> None:
    found.modelspace().query("INSERT")[0].dxf.rotation = 90.0


def moved_insert(found: Document) -> None:
    found.modelspace().query("INSERT")[0].dxf.insert = (1.0, 0.0)


def scaled_insert(found: Document) -> None:
    found.modelspace().query("INSERT")[0].dxf.xscale = 25.4


def insert_twice(found: Document) -> None:
    found.modelspace().add_blockref("FLAP_M", (0.0, 0.0), dxfattribs={"layer": "1"})


def block_without_insert(found: Document) -> None:
    found.modelspace().delete_entity(found.modelspace().query("INSERT")[0])


def outline_beside(found: Document) -> None:
    found.modelspace().add_line((1.0, 1.0), (2.0, 2.0), dxfattribs={"layer": "1"})


def text_of(found: Document, begins: str) -> Text:
    every = [*block(found), *found.modelspace()]
    return next(one for one in every if isinstance(one, Text) and one.dxf.text.startswith(begins))


def lose_text(begins: str) -> Callable[[Document], None]:
    def change(found: Document) -> None:
        text_of(found, begins).dxf.text = "-"

    return change


def inches(found: Document) -> None:
    text_of(found, "Units").dxf.text = "Units: ENGLISH"


def notch_off(found: Document) -> None:
    on(found, "81", Point)[0].dxf.location += (0.0, 0.01, 0.0)


def notch_outward(found: Document) -> None:
    point = on(found, "81", Point)[0]
    point.dxf.angle += 180.0


def notch_without_depth(found: Document) -> None:
    point = on(found, "81", Point)[0]
    point.dxf.location = point.dxf.location.replace(z=0.0)


def drill_outside(found: Document) -> None:
    on(found, "13", Point)[0].dxf.location = (-10.0, 0.0, 0.0)


def drill_without_size(found: Document) -> None:
    on(found, "13", Point)[0].dxf.thickness = 0.0


def lose_validation(found: Document) -> None:
    block(found).delete_entity(on(found, "84", Polyline)[0])


def validation_off(found: Document) -> None:
    for corner in on(found, "84", Polyline)[0].vertices:
        corner.dxf.location += (0.1, 0.0, 0.0)


def layer_units(found: Document) -> None:
    found.header["$LUNITS"] = 4


def extents(found: Document) -> None:
    found.modelspace().reset_extents((0.0, 0.0, 0.0), (200.0, 100.0, 0.0))
    found.header["$EXTMAX"] = (200.0, 100.0, 0.0)


PLANTED: list[tuple[str, Callable[[Document], None]]] = [
    ("pattern-vertex", move_vertex),
    ("pattern-vertex", lose_turn_point),
    ("pattern-vertex", lose_curve_point),
    ("pattern-vertex", flag_twice),
    ("pattern-vertex", stray_point),
    ("pattern-open", open_outline),
    ("pattern-bulge", bend),
    ("pattern-direction", turn_round),
    ("pattern-direction", cut_out_the_wrong_way),
    ("pattern-outline", second_outline),
    ("pattern-outline", no_outline),
    ("pattern-layer", foreign_layer),
    ("pattern-layer", metal_layer),
    ("pattern-layer", line_among_points),
    ("pattern-layer", circle),
    ("pattern-layer", block_elsewhere),
    ("pattern-block", turned_insert),
    ("pattern-block", moved_insert),
    ("pattern-block", scaled_insert),
    ("pattern-block", insert_twice),
    ("pattern-block", block_without_insert),
    ("pattern-block", outline_beside),
    *(("pattern-text", lose_text(key)) for key in ("Piece Name", "Size", "Quantity", "Style Name", "Units", "Author")),
    ("pattern-text", inches),
    ("pattern-notch", notch_off),
    ("pattern-notch", notch_outward),
    ("pattern-notch", notch_without_depth),
    ("pattern-drill", drill_outside),
    ("pattern-drill", drill_without_size),
    ("pattern-validation", lose_validation),
    ("pattern-validation", validation_off),
]


@pytest.mark.parametrize(("code", "change"), PLANTED, ids=[f"{code}-{i}" for i, (code, _) in enumerate(PLANTED)])
def test_a_planted_fault_is_found(code: str, change: Callable[[Document], None]) -> None:
    assert code in codes(changed(change))


def test_good_files_have_no_faults() -> None:
    assert codes(good()) == set()
    assert codes(changed(lambda _: None)) == set()
    assert told(good()) == set()
    assert codes(pieces_text(style_file([FLAP, SECTOR], MACHINE), MACHINE)) == set()


@pytest.mark.parametrize(("code", "change"), [("readback-units", layer_units), ("readback-extents", extents)])
def test_faults_of_any_drawing_are_found_in_a_pattern_file_too(code: str, change: Callable[[Document], None]) -> None:
    assert told(changed(change)) == {code}


def test_what_cannot_be_read_and_what_is_not_ascii_is_said() -> None:
    assert codes("no drawing") == {"readback-complaint"}
    assert codes(good().replace("Piece Name: flap", "Piece Name: fl\u00e4p")) == {"readback-complaint"}


def test_pieces_that_are_called_the_same_are_found() -> None:
    text = pieces_text(style_file([FLAP, SECTOR], MACHINE), MACHINE)
    assert codes(text.replace("Piece Name: sector", "Piece Name: flap")) == {"pattern-text"}


def scaled(found: Document) -> None:
    """Everything in its place on a piece that is larger by a millionth: only what was written tells."""
    for entity in block(found):
        if isinstance(entity, Polyline):
            for corner in entity.vertices:
                corner.dxf.location *= 1.000001
        elif isinstance(entity, Point):
            depth = entity.dxf.location.z
            entity.dxf.location = (entity.dxf.location * 1.000001).replace(z=depth)


def other_flag(found: Document) -> None:
    on(found, "3", Point)[0].dxf.layer = "2"


def other_quantity(found: Document) -> None:
    text_of(found, "Quantity").dxf.text = "Quantity: 7"


def deeper_notch(found: Document) -> None:
    point = on(found, "81", Point)[0]
    point.dxf.location += (0.0, 0.0, 1e-3)


def renamed(found: Document) -> None:
    found.blocks.rename_block("FLAP_M", "FLOP_M")
    found.modelspace().query("INSERT")[0].dxf.name = "FLOP_M"


@pytest.mark.parametrize("change", [scaled, other_flag, other_quantity, deeper_notch, renamed])
def test_a_file_that_is_good_by_itself_but_not_what_was_written_is_found(change: Callable[[Document], None]) -> None:
    text = changed(change)
    assert codes(text) == set()
    assert told(text) == {"readback-content"}


def test_an_outline_off_its_exact_edges_is_measured() -> None:
    """Written as it was asked for, but of edges that lie 0.05 mm elsewhere: the deviation tells, and does not pass."""
    aside = as_pattern(flap().replace(notches=()))
    edges = as_pattern(sector()).outer.edges
    wrong = aside.replace(outer=SECTOR.outer, inner=(), marks=(), drills=(), texts=(), axis_deg=None)
    grown = tuple(
        CircularArc(edge.centre, edge.radius + 0.05, edge.start_rad, edge.sweep_rad)
        if isinstance(edge, CircularArc)
        else edge
        for edge in edges
    )
    drawn = flat_file(wrong, MACHINE)
    told_of = wrong.replace(outer=replace(wrong.outer, edges=grown))
    text = CutFile("flat/flap.dxf", pieces_text(drawn, MACHINE))
    report = judged_patterns([text], [drawn], {"flap": told_of}, MACHINE)
    assert report.metric("max_deviation_mm").value > 0.05
    assert not report.metric("max_deviation_mm").passed
    assert judged_patterns([text], [drawn], {"flap": wrong}, MACHINE).passed
