"""Planted faults: a good file has no finding; break one thing, and exactly that is found (measure W16)."""

from collections.abc import Callable
from io import StringIO

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities.lwpolyline import LWPolyline

from stages.geometry.arcpath import ArcPath
from stages.geometry.rigid import Rigid2
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import StageReport
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.readback import read
from tests.stages.write.patterns import CHORD_MM, nesting, plate, sector

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


FAULTS: list[tuple[str, Callable[[Document], None]]] = [
    ("readback-open-contour", drop_flag),
    ("readback-open-contour", loose_line),
    ("readback-duplicate", copy_hole),
    ("readback-duplicate", add_to("CUT_INNER", 5, [(10, 0, 0), (10, 5, 0), (20, 5, 0), (20, 0, 0)])),
    ("readback-order", outline_first),
    ("readback-order", marks_last),
    ("readback-entity", spline),
    ("readback-entity", insert),
    ("readback-entity", text_on_cut),
    ("readback-bulge", bulge(1.5)),
    ("readback-repeated-vertex", insert_vertex(0.0, 0.0)),
    ("readback-short-piece", insert_vertex(0.01, 0.0)),
    ("readback-direction", reverse),
    ("readback-direction", add_to("CUT_INNER", 5, [(5, 20, 0), (10, 20, 0), (10, 30, 0), (5, 30, 0)])),
    ("readback-units", header("$INSUNITS", 6)),
    ("readback-units", header("$MEASUREMENT", 0)),
    ("readback-units", header("$LUNITS", 4)),
    ("readback-extents", extents),
    ("readback-colour", colour_by_layer),
]


def test_a_good_file_has_no_fault() -> None:
    assert codes(good_text()) == set()
    assert codes(with_change(lambda document: None)) == set()


@pytest.mark.parametrize(("code", "change"), FAULTS)
def test_a_planted_fault_is_found(code: str, change: Callable[[Document], None]) -> None:
    text = with_change(change)
    found = codes(text)
    assert code in found
    # what follows from it may be said too: a loose line or text has its own share of other rules
    assert found <= {code, "readback-extents", "readback-open-contour"}


def test_an_outline_on_no_layer_of_ours_is_found() -> None:
    assert "readback-layer" in codes(with_change(unknown_layer))


def test_text_that_is_no_drawing_is_found() -> None:
    assert codes("this is no DXF\n") == {"readback-complaint"}
    assert codes(good_text()[:200]) != set()


def test_an_empty_drawing_is_found() -> None:
    stream = StringIO()
    ezdxf.new("R2000").write(stream)
    assert codes(stream.getvalue()) == {"readback-empty"}


def report_on(text: str) -> StageReport:
    part = plate()
    return judged([CutFile("flat/plate.dxf", text)], [flat_drawing(part, MACHINE)], {"plate": part})


@pytest.mark.parametrize(
    "change",
    [
        bulge(0.01),
        bulge(-0.01),
        copy_hole,
        lambda document: outline(document).translate(1e-6, 0.0, 0.0),
        lambda document: document.modelspace().delete_entity(next(iter(document.modelspace()))),
    ],
)
def test_a_file_that_is_not_what_was_drawn_is_found(change: Callable[[Document], None]) -> None:
    found = {finding.code for finding in report_on(with_change(change)).findings if finding.fatal}
    assert "readback-content" in found


def test_a_failed_readback_fails_the_report_but_keeps_the_files() -> None:
    report = report_on(with_change(bulge(0.01)))
    assert not report.passed
    assert report.metric("entities").value == 6.0
    assert report.metric("max_deviation_mm").value is None


def flipped(path: ArcPath) -> ArcPath:
    return ArcPath(path.vertices, path.bulges * np.where(np.arange(path.bulges.size) == 0, -1.0, 1.0), path.closed)


def test_a_flipped_bulge_in_the_pattern_itself_is_a_deviation() -> None:
    part = sector()
    wrong = part.replace(outer=Contour(part.outer.edges, flipped(part.outer.path), part.outer.chord_mm))
    outcome = write([wrong], None, MACHINE)
    assert not outcome.report.passed
    assert not outcome.report.metric("max_deviation_mm").passed
    assert outcome.report.metric("area_error").value > 0.1


def side_by_side(gap: float) -> tuple[list[FlatPattern], Nesting]:
    places = tuple(Placement("plate", k + 1, Rigid2((100.0 + gap) * k, 10.0)) for k in range(2))
    return [plate()], Nesting((SheetLayout(Sheet("stock", 500.0, 300.0), 1, places, 0.1),))


def test_parts_that_touch_are_said_and_parts_on_top_of_each_other_stop_the_job() -> None:
    assert write(*side_by_side(0.5), MACHINE).report.findings == ()
    touching = write(*side_by_side(0.0), MACHINE).report
    assert [(f.code, f.fatal) for f in touching.findings] == [("readback-common-cut", False)]
    same = write(*side_by_side(-100.0), MACHINE).report
    assert "readback-duplicate" in {f.code for f in same.findings if f.fatal}


def test_a_hole_after_its_own_outline_but_before_another_is_out_of_order() -> None:
    outcome = write([plate(), sector()], nesting(), MACHINE)
    text = next(file.text for file in outcome.product if file.path == "cut/stock-1.dxf")
    document = ezdxf.read(StringIO(text))
    space = document.modelspace()
    entities = list(space)
    holes = [i for i, e in enumerate(entities) if e.dxf.layer == "CUT_INNER"]
    outlines = [i for i, e in enumerate(entities) if e.dxf.layer == "CUT_OUTER"]
    moved = entities.pop(holes[0])
    entities.insert(outlines[0], moved)
    for entity in entities:
        space.unlink_entity(entity)
        space.add_entity(entity)
    stream = StringIO()
    document.write(stream)
    assert "readback-order" in codes(stream.getvalue())


def test_an_edge_that_is_itself_short_is_said_and_stops_nothing() -> None:
    from tests.stages.write.patterns import contour, pattern, polygon_edges

    corners = ((0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.02, 20.0), (0.0, 19.98))
    outcome = write([pattern("cut-corner", contour(polygon_edges(*corners)), (20.0, 10.0))], None, MACHINE)
    assert outcome.report.passed
    assert [f.code for f in outcome.report.findings] == ["short-piece"]


@pytest.mark.parametrize("chord_mm", [0.02, 0.1, 1.0])
def test_a_mark_may_end_on_the_exact_outline_whatever_the_chord(chord_mm: float) -> None:
    """A side that bulges by the chord is cut straight: a mark that ends on the bulge still belongs."""
    from tests.stages.write.patterns import line_mark, pattern, polygon_edges

    corners = ((0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0))
    outer = Contour(tuple(polygon_edges(*corners)), plate().outer.path, chord_mm)

    def found(beyond: float) -> list[str]:
        part = pattern("plate", outer, (45.0, 20.0), marks=(line_mark((50.0, 10.0), (50.0, 60.0 + beyond)),))
        return [finding.code for finding in write([part], None, MACHINE).report.findings]

    assert found(chord_mm) == []
    assert found(3.0 * chord_mm + 0.1) == ["readback-order"]
