"""Ways to break the file of the plate in the default flavour, one thing at a time, as whoever edits it would."""

from collections.abc import Callable
from io import StringIO

import ezdxf
from ezdxf.document import Drawing as Document
from ezdxf.entities.lwpolyline import LWPolyline

from stages.model.cutfile import Machine
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.readback import read
from tests.stages.write.patterns import CHORD_MM, plate

MACHINE = Machine()
LEAST_MM = 0.05


def good_text() -> str:
    return dxf_text(flat_drawing(plate(), MACHINE), MACHINE)


def with_change(change: Callable[[Document], None]) -> str:
    document = ezdxf.read(StringIO(good_text()))
    change(document)
    stream = StringIO()
    document.write(stream)
    return stream.getvalue()


def codes(text: str) -> set[str]:
    return {finding.code for finding in faults(read(text), "flat/plate.dxf", LEAST_MM, CHORD_MM) if finding.fatal}


def outline(document: Document) -> LWPolyline:
    return next(e for e in document.modelspace() if e.dxf.layer == "CUT_OUTER")


def drop_flag(document: Document) -> None:
    outline(document).closed = False


def add_to(layer: str, colour: int, vertices: list[tuple[float, ...]]) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        document.modelspace().add_lwpolyline(
            vertices, format="xyb", close=True, dxfattribs={"layer": layer, "color": colour}
        )
        outer = outline(document)
        space = document.modelspace()
        space.unlink_entity(outer)
        space.add_entity(outer)

    return change


def copy_hole(document: Document) -> None:
    space = document.modelspace()
    holes = [e for e in space if e.dxf.layer == "CUT_INNER"]
    outer = outline(document)
    space.add_circle(holes[0].dxf.center, holes[0].dxf.radius, dxfattribs={"layer": "CUT_INNER", "color": 5})
    space.unlink_entity(outer)
    space.add_entity(outer)


def outline_first(document: Document) -> None:
    space = document.modelspace()
    for entity in [e for e in space if e.dxf.layer != "CUT_OUTER"]:
        space.unlink_entity(entity)
        space.add_entity(entity)


def marks_last(document: Document) -> None:
    space = document.modelspace()
    for entity in [e for e in space if e.dxf.layer in ("CUT_INNER", "CUT_OUTER")][-1:] + [
        e for e in space if e.dxf.layer == "MARK"
    ]:
        space.unlink_entity(entity)
        space.add_entity(entity)
    last = outline(document)
    space.unlink_entity(last)
    space.add_entity(last)
    hole = next(e for e in space if e.dxf.layer == "CUT_INNER")
    order = [hole, *[e for e in space if e is not hole]]
    for entity in order:
        space.unlink_entity(entity)
        space.add_entity(entity)


def spline(document: Document) -> None:
    document.modelspace().add_spline([(0, 0), (10, 3), (20, 0), (30, 5)], dxfattribs={"layer": "MARK", "color": 3})
    outer = outline(document)
    document.modelspace().unlink_entity(outer)
    document.modelspace().add_entity(outer)


def insert(document: Document) -> None:
    document.blocks.new("PART").add_circle((0, 0), 1)
    document.modelspace().add_blockref("PART", (5, 5), dxfattribs={"layer": "LABEL", "color": 2})


def bulge(value: float) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        points = outline(document).get_points("xyb")
        points[0] = (*points[0][:2], value)
        outline(document).set_points(points, format="xyb")
        corner = (50.0, -100.0) if value > 1.0 else (0.0, 0.0)
        document.modelspace().reset_extents((*corner, 0.0), (100.0, 60.0, 0.0))

    return change


def insert_vertex(x: float, y: float) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        points = outline(document).get_points("xyb")
        outline(document).set_points([points[0], (x, y, 0.0), *points[1:]], format="xyb")

    return change


def reverse(document: Document) -> None:
    outer = outline(document)
    outer.set_points(outer.get_points("xyb")[::-1], format="xyb")


def header(name: str, value: object) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        document.header[name] = value

    return change


def extents(document: Document) -> None:
    document.header["$EXTMAX"] = (100.0, 60.02, 0.0)


def colour_by_layer(document: Document) -> None:
    outline(document).dxf.color = 256


def text_on_cut(document: Document) -> None:
    document.modelspace().add_text("7", dxfattribs={"layer": "CUT_INNER", "color": 5})


def unknown_layer(document: Document) -> None:
    outline(document).dxf.layer = "0"


def loose_line(document: Document) -> None:
    document.modelspace().add_line((10, 5), (30, 5), dxfattribs={"layer": "CUT_INNER", "color": 5})
