"""Every kind of fault, planted in every flavour and version, is found under its own name (measure W16).

Faults are planted into what is drawn and written as any other drawing, or into the text; the file is then judged
against the good drawing.  A flavour without arcs has no arcs to bend wrongly.
"""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.plane import CircularArc
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, backwards, piece_count
from stages.model.cutfile import Layer, Lettering, Machine, Side
from stages.model.pattern import FlatPattern, Text
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.drawing import Drawing, Item, flat_drawing
from stages.write.dxf import dxf_text
from tests.stages.geometry.plane_curves import TAU, wave
from tests.stages.write.cases import CASES, Case, good, machine, rounded_as, told
from tests.stages.write.patterns import contour, hole, line_mark, pattern, polygon_edges

Change = Callable[[Drawing], Drawing]
MARK, SLOT, ROUND, OUTER = range(4)
"""The paths of the plate with a round corner, as they follow in its file."""


def drawn(how: Machine) -> Drawing:
    return flat_drawing(rounded_as(how.flavour), how)


def in_order(*places: int) -> Change:
    return lambda drawing: replace(drawing, items=tuple(drawing.items[place] for place in places))


def with_item(layer: str, path: ArcPath, place: int) -> Change:
    def change(drawing: Drawing) -> Drawing:
        items = list(drawing.items)
        items.insert(place, Item(layer, "plate", path, 9))
        return replace(drawing, items=tuple(items))

    return change


def with_path(place: int, made: Callable[[ArcPath], ArcPath]) -> Change:
    def change(drawing: Drawing) -> Drawing:
        items = list(drawing.items)
        items[place] = replace(items[place], path=made(items[place].path))
        return replace(drawing, items=tuple(items))

    return change


def ring(*corners: tuple[float, float]) -> ArcPath:
    """Return a ring of lines, clockwise as a hole runs."""
    return ArcPath(np.array(corners, dtype=np.float64), np.zeros(len(corners)), closed=True)


def opened(path: ArcPath) -> ArcPath:
    return ArcPath(path.vertices, np.append(path.bulges[:-1], 0.0), closed=False)


def stepped(by: float) -> Callable[[ArcPath], ArcPath]:
    """Return the path with one vertex more, so far along its first straight piece."""

    def change(path: ArcPath) -> ArcPath:
        at = int(np.flatnonzero(path.bulges == 0.0)[0])
        start, end = path.vertices[at], np.roll(path.vertices, -1, axis=0)[at]
        vertex = start + by * (end - start) / np.linalg.norm(end - start)
        return ArcPath(
            np.insert(path.vertices, at + 1, vertex, axis=0), np.insert(path.bulges, at + 1, 0.0), path.closed
        )

    return change


def bent(by: float) -> Callable[[ArcPath], ArcPath]:
    """Return the path with the bulge of its first arc multiplied."""

    def change(path: ArcPath) -> ArcPath:
        bulges = path.bulges.copy()
        bulges[np.flatnonzero(bulges)[0]] *= by
        return ArcPath(path.vertices, bulges, path.closed)

    return change


def moved(by: float) -> Callable[[ArcPath], ArcPath]:
    def change(path: ArcPath) -> ArcPath:
        vertices = path.vertices.copy()
        vertices[-1] += by
        return ArcPath(vertices, path.bulges, path.closed)

    return change


def label_on_cut(drawing: Drawing) -> Drawing:
    return replace(drawing, labels=tuple(label.replace(layer="CUT_INNER") for label in drawing.labels))


DRAWN: list[tuple[str, Change]] = [
    ("readback-open-contour", with_path(OUTER, opened)),
    ("readback-open-contour", with_path(SLOT, opened)),
    ("readback-order", in_order(OUTER, MARK, ROUND, SLOT)),
    ("readback-order", in_order(SLOT, MARK, ROUND, OUTER)),
    ("readback-order", with_item("CUT_INNER", ring((200, 0), (200, 5), (205, 5), (205, 0)), OUTER)),
    ("readback-direction", with_path(OUTER, backwards)),
    ("readback-direction", with_path(SLOT, backwards)),
    ("readback-duplicate", in_order(MARK, ROUND, SLOT, OUTER, OUTER)),
    ("readback-duplicate", in_order(MARK, ROUND, ROUND, SLOT, OUTER)),
    ("readback-duplicate", with_item("CUT_INNER", ring((0, 5), (0, 15), (5, 15), (5, 5)), OUTER)),
    ("readback-duplicate", with_item("CUT_INNER", ring((0, 5), (0, 5.06), (5, 5.06), (5, 5)), OUTER)),
    ("readback-short-piece", with_path(OUTER, stepped(0.01))),
    ("readback-repeated-vertex", with_path(OUTER, stepped(1e-8))),
    ("readback-content", with_path(OUTER, moved(1e-5))),
    ("readback-content", with_path(MARK, moved(1e-5))),
    ("readback-content", in_order(MARK, ROUND, OUTER)),
    ("readback-content", in_order(MARK, MARK, ROUND, SLOT, OUTER)),
    ("readback-entity", label_on_cut),
]
WITH_ARCS: list[tuple[str, Change]] = [
    ("readback-content", with_path(OUTER, bent(-1.0))),
    ("readback-content", with_path(OUTER, bent(1.0 + 1e-6))),
    ("readback-content", with_path(OUTER, bent(0.0))),
    ("readback-bulge", with_path(OUTER, bent(3.0))),
]
HAS_ARCS = [case for case in CASES if case[0] != "polylines"]


@pytest.mark.parametrize("case", CASES)
def test_the_good_file_has_none(case: Case) -> None:
    assert told(good(machine(case)), machine(case)) == set()


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("code", "change"), DRAWN)
def test_a_fault_in_what_is_drawn_is_found(case: Case, code: str, change: Change) -> None:
    how = machine(case)
    assert code in told(dxf_text(change(drawn(how)), how), how)


@pytest.mark.parametrize("case", HAS_ARCS)
@pytest.mark.parametrize(("code", "change"), WITH_ARCS)
def test_a_fault_of_an_arc_is_found(case: Case, code: str, change: Change) -> None:
    how = machine(case)
    assert code in told(dxf_text(change(drawn(how)), how), how)


def replaced(pattern: str, by: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        found, count = re.subn(pattern, by, text, count=1, flags=re.DOTALL)
        assert count == 1
        return found

    return change


def entity(tags: str) -> Callable[[str], str]:
    """Return the text with one more entity before all others."""
    record = "".join(f"{tag.strip()}\n" for tag in tags.split("|"))
    return replaced(r"(  2\nENTITIES\n)", rf"\g<1>{record}")


SPLINE = (
    "0|SPLINE|100|AcDbEntity|8|MARK|62|3|100|AcDbSpline|70|8|71|3|72|8|73|4"
    + 4 * "|40|0"
    + 4 * "|40|1"
    + "".join(f"|10|{x}|20|{y}|30|0" for x, y in ((10, 10), (20, 15), (30, 5), (40, 10)))
)
TEXTS: list[tuple[str, Callable[[str], str]]] = [
    ("readback-units", replaced(r"(\$INSUNITS\n 70\n)4\n", r"\g<1>1\n")),
    ("readback-units", replaced(r"(\$MEASUREMENT\n 70\n)1\n", r"\g<1>0\n")),
    ("readback-units", replaced(r"(\$LUNITS\n 70\n)2\n", r"\g<1>4\n")),
    ("readback-extents", replaced(r"(\$EXTMAX\n 10\n)100.0\n", r"\g<1>100.02\n")),
    ("readback-extents", replaced(r"(\$EXTMIN\n 10\n)0.0\n", r"\g<1>-1.0\n")),
    ("readback-layer", lambda text: text.replace("\nCUT_OUTER\n", "\nOUTLINE\n")),
    ("readback-entity", entity(SPLINE)),
    ("readback-entity", entity("0|ELLIPSE|8|MARK|62|3|10|5|20|5|30|0|11|2|21|0|31|0|40|0.5|41|0|42|6.28")),
    ("readback-entity", entity("0|3DFACE|8|MARK|62|3|10|0|20|0|30|0|11|1|21|0|31|0|12|1|22|1|32|0|13|0|23|1|33|0")),
    ("readback-complaint", replaced(r"(  2\nENTITIES\n.*? 20\n)[-0-9.e]+\n", r"\g<1>nan\n")),
    ("readback-complaint", replaced(r"(  2\nENTITIES\n.*? 10\n)[-0-9.e]+\n", r"\g<1>inf\n")),
    ("readback-complaint", replaced(r"(  2\nENTITIES\n.*? 10\n)[-0-9.e]+\n", r"\g<1>1,5\n")),
    ("readback-complaint", lambda text: text[: len(text) // 2]),
    ("readback-content", lambda text: text.replace("\nplate\n", "\nplane\n")),
]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("code", "change"), TEXTS)
def test_a_fault_in_the_text_is_found(case: Case, code: str, change: Callable[[str], str]) -> None:
    how = machine(case)
    assert code in told(change(good(how)), how)


@pytest.mark.parametrize("case", CASES)
def test_a_colour_that_is_not_that_of_its_layer_is_found(case: Case) -> None:
    how = machine(case)
    others = replace(how, layers={**how.layers, "CUT_OUTER": Layer("CUT_OUTER", 7)})
    text = dxf_text(drawn(how), others)
    assert "readback-colour" in told(text.replace("CUT_OUTER\n 70\n0\n 62\n7\n", "CUT_OUTER\n 70\n0\n 62\n1\n"), how)


# no false alarm


Sizes = tuple[list[float], list[float], list[float], bool]

SIZES: st.SearchStrategy[Sizes] = st.tuples(
    st.lists(st.floats(-6.0, 6.0), min_size=3, max_size=3),
    st.lists(st.floats(-6.0, 6.0), min_size=3, max_size=3),
    st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6),
    st.booleans(),
)


def part_of(sizes: Sizes) -> FlatPattern:
    """Return a part with a wavy, a round and some straight edges, round and square holes, marks and a text."""
    amplitudes, phases, shares, slotted = sizes
    curve = wave(amplitudes, phases)
    (x0, y0), (x1, y1) = curve.at(np.array([0.0, 1.0]))
    radius = 2.0 + 18.0 * shares[0]
    corner = CircularArc(np.array([x1 - radius, 150.0 - radius]), radius, 0.0, TAU / 4.0)
    top = polygon_edges((x1 - radius, 150.0), (x0, 150.0), (x0, y0), (x1, y1), (x1, 150.0 - radius))
    outer = contour([curve, top[3], corner, top[0], top[1]])
    holes = [hole(40.0 + 40.0 * shares[1], 50.0 + 50.0 * shares[2], 1.0 + 7.0 * shares[3])]
    if slotted:
        x, wide = 120.0, 0.2 + 10.0 * shares[4]
        holes.append(contour(polygon_edges((x, 60.0), (x, 90.0), (x + wide, 90.0), (x + wide, 60.0))))
    marks = (line_mark((20.0, 40.0), (25.0, 41.0 + 80.0 * shares[5])), line_mark((100, 50), (110, 50), (105, 60)))
    made = pattern("part", outer, (100.0, 100.0), *holes, marks=marks)
    return made.replace(texts=(Text("note", "TOP 7", np.array([100.0, 120.0]), 4.0, 360.0 * shares[4]),))


@settings(max_examples=6, deadline=None)
@given(
    SIZES,
    st.sampled_from(CASES),
    st.builds(Rigid2, st.just(500.0), st.just(500.0), st.floats(0.0, 360.0), st.booleans()),
    st.sampled_from(["either", "outside"]),
    st.sampled_from(["TEXT", "strokes"]),
)
def test_a_good_job_raises_no_alarm(sizes: Sizes, case: Case, motion: Rigid2, side: Side, lettering: Lettering) -> None:
    how, part = replace(machine(case), side=side, text=lettering), part_of(sizes)
    places = (
        Placement("part", 1, motion),
        Placement("part", 2, Rigid2(1500.0, 500.0, -motion.angle_deg)),
    )
    outcome = write([part], Nesting((SheetLayout(Sheet("stock", 2000.0, 1000.0), 1, places, 0.1),)), how)
    assert outcome.report.passed, (outcome.report.findings, outcome.report.metrics)
    assert outcome.report.findings == ()
    assert piece_count(part.outer.path) >= 5
