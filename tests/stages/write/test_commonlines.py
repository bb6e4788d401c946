"""Common lines in cut files: what is cut once is one line, and from the file alone every outline is whole again."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from io import StringIO
from math import dist

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing as Document
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, length, transform
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import judged, write
from stages.write.chains import Entity
from stages.write.closing import closed_again
from stages.write.commonlines import rests_of, shared_cuts
from stages.write.drawing import sheet_drawing
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.patterns import contour, hole, line_mark, pattern, polygon_edges

KERF_MM = 0.2
MACHINE = Machine(common_kerf_mm=KERF_MM)
ROUNDING = 1e-8
"""Sums of some ten coordinates that were rounded to 1e-10 mm, doubled by the chords."""


def panel(part: str, width: float, height: float) -> FlatPattern:
    """Return a rectangle with a hole and a mark."""
    outer = contour(polygon_edges((0.0, 0.0), (width, 0.0), (width, height), (0.0, height)))
    mark = line_mark((5.0, 5.0), (15.0, 5.0))
    return pattern(part, outer, (10.0, 10.0), hole(width / 2.0, height / 2.0, 4.0), marks=(mark,))


def laid(*placed: tuple[str, float, float], sheet: Sheet | None = None) -> SheetLayout:
    sheet = sheet or Sheet("stock", 500.0, 300.0)
    places = (Placement(part, number + 1, Rigid2(x, y)) for number, (part, x, y) in enumerate(placed))
    return SheetLayout(sheet, 1, tuple(places), 0.2)


def grid(count: int, kerf_mm: float = KERF_MM) -> SheetLayout:
    """Return count x count panels of 50 x 30, a kerf apart."""
    step_x, step_y = 50.0 + kerf_mm, 30.0 + kerf_mm
    return laid(*(("a", 10.0 + step_x * i, 10.0 + step_y * j) for i in range(count) for j in range(count)))


def brick(kerf_mm: float = KERF_MM) -> SheetLayout:
    """Return two panels of 50 x 30 on one of 100.2 x 30."""
    above = 40.0 + kerf_mm
    return laid(("wide", 10.0, 10.0), ("a", 10.0, above), ("a", 60.0 + kerf_mm, above))


PARTS = [panel("a", 50.0, 30.0), panel("wide", 100.0 + KERF_MM, 30.0)]


def text_of(layout: SheetLayout, machine: Machine = MACHINE) -> str:
    outcome = write(PARTS, Nesting((layout,)), machine)
    assert outcome.report.passed, outcome.report.findings
    return {file.path: file.text for file in outcome.product}["cut/stock-1.dxf"]


def cut(text: str) -> list[Entity]:
    return [one for one in read(text).entities if one.layer == "CUT_OUTER"]


def test_two_panels_side_by_side_share_one_line() -> None:
    text = text_of(laid(("a", 10.0, 10.0), ("a", 60.0 + KERF_MM, 10.0)))
    first, second, line = cut(text)
    assert [first.kind, second.kind, line.kind] == ["LWPOLYLINE", "LWPOLYLINE", "LINE"]
    assert not (first.closed or second.closed)
    assert line.path is not None
    assert_near(sorted(line.path.vertices.tolist()), [[60.1, 10.0], [60.1, 40.0]], bound=ROUNDING, why="mid kerf")
    total = sum(length(one.path) for one in (first, second, line) if one.path is not None)
    assert_near(total, 2.0 * 160.0 - 30.0, bound=ROUNDING, why="the shared side once")


def test_without_the_wish_every_outline_is_whole() -> None:
    text = text_of(laid(("a", 10.0, 10.0), ("a", 60.0 + KERF_MM, 10.0)), Machine())
    assert [one.closed for one in cut(text)] == [True, True]


def test_a_line_runs_on_across_the_kerf_between_two_parts_along_a_third() -> None:
    lines = [one.path for one in cut(text_of(brick())) if one.kind == "LINE" and one.path is not None]
    assert sorted(length(line) for line in lines) == pytest.approx([30.0, 100.0 + KERF_MM])


def test_the_line_comes_after_the_holes_of_both_parts() -> None:
    layers = [(one.layer, one.kind) for one in read(text_of(grid(2))).entities if one.layer.startswith("CUT_")]
    assert max(k for k, one in enumerate(layers) if one[0] == "CUT_INNER") < layers.index(("CUT_OUTER", "LINE"))


def alone(_: float) -> SheetLayout:
    return laid(("a", 10.0, 10.0))


@pytest.mark.parametrize("kerf_mm", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("shape", [partial(grid, 2), partial(grid, 3), brick, alone], ids=["2", "3", "brick", "one"])
def test_every_outline_is_whole_again_from_the_file_alone(
    shape: Callable[[float], SheetLayout], kerf_mm: float
) -> None:
    layout = shape(kerf_mm)
    by_part = {one.part: one for one in PARTS}
    outlines = [transform(by_part[one.part].outer.path, one.motion) for one in layout.placements]
    entities = cut(text_of(layout, Machine(common_kerf_mm=kerf_mm)))
    closed = closed_again(entities, kerf_mm)
    whole = [one.path for one in entities if one.closed and one.path is not None]
    found = sorted(area(path) for path in (*whole, *(one.path for one in closed.outlines)))
    assert closed.loose == ()
    assert_near(found, sorted(map(area, outlines)), bound=1e-3, why="sides of 1e2 mm, four ends that meet to 2e-6 mm")
    total = sum(length(one.path) for one in entities if one.path is not None)
    saved = shared_cuts(outlines, kerf_mm).saved_mm
    assert_near(sum(map(length, outlines)) - total, saved, bound=ROUNDING, why="as it was drawn")


def test_a_part_amid_others_has_no_piece_of_its_own() -> None:
    layout = grid(3)
    outlines = [transform(PARTS[0].outer.path, one.motion) for one in layout.placements]
    shared = shared_cuts(outlines, KERF_MM)
    assert [len(rests) for rests in shared.rests] == [1, 1, 1, 1, 0, 1, 1, 1, 1]
    assert len(shared.lines) == 4
    assert_near(shared.saved_mm, 6.0 * 50.0 + 6.0 * 30.0 - 8.0 * KERF_MM, bound=ROUNDING, why="12 sides, 8 crossings")


def test_a_line_that_ends_a_hair_before_an_edge_runs_on_to_it() -> None:
    """Without that a piece of 0.03 mm would be left to cut."""
    outlines = [transform(PARTS[0].outer.path, motion) for motion in (Rigid2(), Rigid2(50.0 + KERF_MM, 0.03))]
    shared = shared_cuts(outlines, KERF_MM)
    (line,) = shared.lines
    assert_near(np.sort(line.ends[:, 1]), [0.0, 30.03], bound=ROUNDING, why="the ends of both edges")
    assert [rest.bulges.size for rests in shared.rests for rest in rests] == [4, 4]


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 3), st.floats(0.0, 0.45), st.floats(0.55, 1.0)), max_size=4))
def test_rests_and_what_was_taken_make_up_the_outline(taken: list[tuple[int, float, float]]) -> None:
    path = PARTS[0].outer.path
    sides = [length(ArcPath(path.vertices[[k, (k + 1) % 4]], np.zeros(2), closed=False)) for k in range(4)]
    spans: dict[int, tuple[float, float]] = {}
    for piece, low, high in taken:
        before = spans.get(piece, (low, high))
        spans[piece] = min(before[0], low), max(before[1], high)
    gone = sum(sides[piece] * (high - low) for piece, (low, high) in spans.items())
    left = sum(length(rest) for rest in rests_of(path, taken))
    assert_near(left + gone, length(path), bound=1e-9, why="nothing is lost")


def found_faults(text: str, layout: SheetLayout) -> set[str]:
    by_part = {one.part: one for one in PARTS}
    drawing = sheet_drawing(layout, by_part, MACHINE)
    report = judged([CutFile(drawing.path, text)], [drawing], by_part)
    return {finding.code for finding in report.findings if finding.fatal}


def changed(text: str, change: Callable[[Document], None]) -> str:
    document = ezdxf.read(StringIO(text))
    change(document)
    stream = StringIO()
    document.write(stream)
    return stream.getvalue()


def drop_a_line(document: Document) -> None:
    space = document.modelspace()
    space.delete_entity(next(e for e in space if e.dxftype() == "LINE" and e.dxf.layer == "CUT_OUTER"))


def move_a_line(document: Document) -> None:
    line = next(e for e in document.modelspace() if e.dxftype() == "LINE" and e.dxf.layer == "CUT_OUTER")
    line.translate(0.01, 0.0, 0.0)


def double_a_line(document: Document) -> None:
    space = document.modelspace()
    line = next(e for e in space if e.dxftype() == "LINE" and e.dxf.layer == "CUT_OUTER")
    space.add_line(line.dxf.start, line.dxf.end, dxfattribs={"layer": "CUT_OUTER", "color": 1})


def drop_a_rest(document: Document) -> None:
    space = document.modelspace()
    space.delete_entity(next(e for e in space if e.dxftype() == "LWPOLYLINE" and e.dxf.layer == "CUT_OUTER"))


def hole_last(document: Document) -> None:
    space = document.modelspace()
    entity = next(e for e in space if e.dxf.layer == "CUT_INNER")
    space.unlink_entity(entity)
    space.add_entity(entity)


def mark_after_hole(document: Document) -> None:
    space = document.modelspace()
    mark = next(e for e in space if e.dxf.layer == "MARK")
    rest = [e for e in space if e.dxf.layer not in ("MARK", "CUT_INNER", "SHEET")]
    space.unlink_entity(mark)
    space.add_entity(mark)
    for entity in rest:
        space.unlink_entity(entity)
        space.add_entity(entity)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (drop_a_line, "readback-open-contour"),
        (move_a_line, "readback-open-contour"),
        (double_a_line, "readback-duplicate"),
        (drop_a_rest, "readback-open-contour"),
        (hole_last, "readback-order"),
        (mark_after_hole, "readback-order"),
    ],
)
def test_a_planted_fault_is_found(change: Callable[[Document], None], code: str) -> None:
    layout = grid(3)
    text = text_of(layout)
    assert found_faults(text, layout) == set()
    assert code in found_faults(changed(text, change), layout)


def test_an_open_outline_is_a_fault_where_nobody_asked_for_common_lines() -> None:
    layout = grid(2)
    by_part = {one.part: one for one in PARTS}
    drawing = sheet_drawing(layout, by_part, MACHINE)
    report = judged([CutFile(drawing.path, text_of(layout))], [replace(drawing, kerf_mm=None)], by_part)
    assert "readback-open-contour" in {finding.code for finding in report.findings}


def test_what_is_shared_is_said_with_count_and_length() -> None:
    report = write(PARTS, Nesting((brick(),)), MACHINE).report
    (found,) = [finding for finding in report.findings if finding.code == "common-lines"]
    assert not found.fatal
    assert found.where is not None
    assert found.where["lines"] == 2
    assert_near(float(found.where["length_mm"]), 130.2, bound=ROUNDING, why="30 and 100.2 mm")
    assert_near(float(found.where["saved_mm"]), 130.0, bound=ROUNDING, why="30 + 50 + 50 + 0.2 - 0.2 mm")


def test_a_sheet_of_a_thousand_parts_takes_seconds() -> None:
    from time import process_time

    outlines = [transform(PARTS[0].outer.path, Rigid2(50.2 * i, 30.2 * j)) for i in range(32) for j in range(32)]
    start = process_time()
    shared = shared_cuts(outlines, KERF_MM)
    assert process_time() - start < 25.0
    assert len(shared.lines) == 2 * 31


def test_the_figures_of_a_sheet_count_what_is_cut_and_the_way_between() -> None:
    """Two bare panels: the line is cut once, and the head goes where the file says."""
    bare = [one.replace(inner=(), marks=()) for one in PARTS]
    layout = laid(("a", 10.0, 10.0), ("a", 60.0 + KERF_MM, 10.0))
    report = write(bare, Nesting((layout,)), MACHINE).report
    figures = report.detail["files"]["cut/stock-1.dxf"]  # type: ignore[index]
    assert figures["pierces"] == 3.0
    assert_near(figures["cut_length_mm"], 290.0, bound=ROUNDING, why="twice 160 less 30")
    corner, left, right = (0.0, 0.0), [(60.0, 40.0), (60.0, 10.0)], [(60.2, 10.0), (60.2, 40.0)]
    line = [(60.1, 40.0), (60.1, 10.0)]
    ways = [(corner, left[0]), (left[1], right[0]), (right[1], line[0])]
    assert_near(figures["travel_mm"], sum(map(dist, *zip(*ways, strict=True))), bound=ROUNDING, why="closed form")


def test_a_part_in_a_hole_that_is_cut_after_the_hole_is_found() -> None:
    """A small panel in the hole of a frame that shares a cut with a neighbour."""
    opening = contour(polygon_edges((10.0, 10.0), (10.0, 50.0), (70.0, 50.0), (70.0, 10.0)))
    frame = pattern(
        "frame", contour(polygon_edges((0.0, 0.0), (80.0, 0.0), (80.0, 60.0), (0.0, 60.0))), (5.0, 5.0), opening
    )
    parts = {one.part: one for one in (PARTS[0].replace(inner=(), marks=()), frame)}
    places = [("a", 20.0, 20.0), ("frame", 0.0, 0.0), ("a", 80.0 + KERF_MM, 0.0)]
    codes = []
    for order in (places, [places[1], places[0], places[2]]):
        outcome = write(tuple(parts.values()), Nesting((laid(*order),)), MACHINE)
        codes.append({finding.code for finding in outcome.report.findings if finding.fatal})
    assert codes == [set(), {"readback-order"}]
