"""Faults planted into a file: a good one has none; break one thing, and exactly that is found (measure W16)."""

from collections.abc import Callable
from io import StringIO

import ezdxf
import pytest
from ezdxf.document import Drawing as Document

from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import Contour, FlatPattern
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from tests.stages.write.patterns import contour, line_mark, pattern, plate, polygon_edges
from tests.stages.write.planted import (
    MACHINE,
    add_to,
    bulge,
    codes,
    colour_by_layer,
    copy_hole,
    drop_flag,
    extents,
    good_text,
    header,
    insert,
    insert_vertex,
    loose_line,
    marks_last,
    outline_first,
    reverse,
    spline,
    text_on_cut,
    unknown_layer,
    with_change,
)

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


def test_what_is_cut_repeats_no_vertex_open_or_not() -> None:
    """What is left of an outline that shares cuts is open too."""

    def with_open_cut(*x: float) -> set[str]:
        def change(document: Document) -> None:
            attributes = {"layer": "CUT_OUTER", "color": 1}
            document.modelspace().add_lwpolyline([(at, -50.0) for at in x], dxfattribs=attributes)

        return codes(with_change(change))

    assert with_open_cut(0.0, 10.0, 10.0, 20.0) - with_open_cut(0.0, 10.0, 20.0) == {"readback-repeated-vertex"}


def side_by_side(gap: float) -> tuple[list[FlatPattern], Nesting]:
    places = tuple(Placement("plate", k + 1, Rigid2((100.0 + gap) * k, 10.0)) for k in range(2))
    return [plate()], Nesting((SheetLayout(Sheet("stock", 500.0, 300.0), 1, places, 0.1),))


def test_parts_that_touch_are_said_and_parts_on_top_of_each_other_stop_the_job() -> None:
    assert write(*side_by_side(0.5), MACHINE).report.findings == ()
    touching = write(*side_by_side(0.0), MACHINE).report
    assert [(f.code, f.fatal) for f in touching.findings] == [("readback-common-cut", False)]
    same = write(*side_by_side(-100.0), MACHINE).report
    assert "readback-duplicate" in {f.code for f in same.findings if f.fatal}


def test_an_edge_that_is_itself_short_is_said_and_stops_nothing() -> None:
    corners = ((0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.02, 20.0), (0.0, 19.98))
    outcome = write([pattern("cut-corner", contour(polygon_edges(*corners)), (20.0, 10.0))], None, MACHINE)
    assert outcome.report.passed
    assert [f.code for f in outcome.report.findings] == ["short-piece"]


@pytest.mark.parametrize("chord_mm", [0.02, 0.1, 1.0])
def test_a_mark_may_end_on_the_exact_outline_whatever_the_chord(chord_mm: float) -> None:
    """A side that bulges by the chord is cut straight: a mark that ends on the bulge still belongs."""
    corners = ((0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0))
    outer = Contour(tuple(polygon_edges(*corners)), plate().outer.path, chord_mm)

    def found(beyond: float) -> list[str]:
        part = pattern("plate", outer, (45.0, 20.0), marks=(line_mark((50.0, 10.0), (50.0, 60.0 + beyond)),))
        return [finding.code for finding in write([part], None, MACHINE).report.findings]

    assert found(chord_mm) == []
    assert found(3.0 * chord_mm + 0.1) == ["readback-order"]
