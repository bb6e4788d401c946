"""A good pattern file, how it is judged, and the faults that are planted in it, by the code that tells of each."""

from collections.abc import Callable
from functools import cache
from io import StringIO

import ezdxf
from ezdxf.document import Drawing as Document
from ezdxf.entities import DXFEntity, Point, Polyline, Text

from stages.model.cutfile import CutFile
from stages.write.patternfiles import judged_patterns
from stages.write.piecedxf import pieces_text
from stages.write.piecefaults import piece_faults
from stages.write.pieces import PatternFile, flat_file
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
