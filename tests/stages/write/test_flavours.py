"""Every flavour and version says the same: as this project reads it, and as the library reads it by itself."""

import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from io import StringIO
from math import dist, pi

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities import DXFEntity
from ezdxf.path import make_path
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arcpath import ArcPath, area, length
from stages.geometry.plane import CircularArc
from stages.geometry.rigid import Rigid2
from stages.model.cutfile import PROFILES, CutFile, Flavour, Layer, Machine, Version
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.flavours import LARGEST_RADIUS_MM, as_cut, as_written
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.patterns import (
    CHORD_MM,
    contour,
    drop,
    hole,
    line_mark,
    nesting,
    pattern,
    plate,
    polygon_edges,
    sector,
    strip,
)
from tests.stages.write.test_commonlines import PARTS, brick, grid

Case = tuple[Flavour, Version]
CASES: list[Case] = [
    ("polyline-arcs", "R2000"),
    ("polyline-arcs", "R2010"),
    ("polyline-arcs", "R2018"),
    ("lines-arcs", "R12"),
    ("lines-arcs", "R2000"),
    ("lines-arcs", "R2018"),
    ("polylines", "R12"),
    ("polylines", "R2000"),
    ("r12", "R12"),
]
LEAST_MM = 0.05
KINDS = {
    "polyline-arcs": {"LWPOLYLINE", "LINE", "CIRCLE", "TEXT"},
    "lines-arcs": {"LINE", "ARC", "CIRCLE", "TEXT"},
    "polylines": {"LWPOLYLINE", "LINE", "TEXT"},
    "r12": {"POLYLINE", "LINE", "CIRCLE", "TEXT"},
}


def machine(case: Case) -> Machine:
    return Machine(flavour=case[0], version=case[1])


@cache
def texts_of(case: Case) -> dict[str, str]:
    return texts(machine(case))


def texts(how: Machine) -> dict[str, str]:
    outcome = write([plate(), sector(), strip(), drop()], nesting(), how)
    assert outcome.report.passed, outcome.report.findings
    assert outcome.report.findings == ()
    return {file.path: file.text for file in outcome.product}


def document(text: str) -> Document:
    return ezdxf.read(StringIO(text))


def on(layer: str, text: str) -> list[DXFEntity]:
    return [entity for entity in document(text).modelspace() if entity.dxf.layer == layer]


@pytest.mark.parametrize("case", CASES)
def test_every_flavour_passes_and_holds_only_its_entities(case: Case) -> None:
    for text in texts_of(case).values():
        kinds = {entity.dxftype() for entity in document(text).modelspace()}
        wanted = KINDS[case[0]] - ({"LWPOLYLINE"} if case[1] == "R12" else set())
        assert kinds <= wanted | ({"POLYLINE"} if case[1] == "R12" else set())
        assert document(text).acad_release == case[1]
        assert document(text).audit().errors == []


@pytest.mark.parametrize("case", CASES)
def test_the_deviation_of_the_flavour_itself_is_measured_and_within_the_tolerance(case: Case) -> None:
    report = write([strip(), drop()], None, machine(case)).report
    deviation = report.metric("max_deviation_mm")
    assert deviation.limit == CHORD_MM
    assert 0.3 * CHORD_MM < deviation.value <= CHORD_MM
    chords = case[0] == "polylines"
    # a chord is inside a round hole by up to the tolerance: 2/3 of it on average, around the smaller of the circles
    assert report.metric("length_error").value < (2e-3 if chords else 5e-5)


@pytest.mark.parametrize("case", CASES)
def test_the_library_finds_the_same_area_by_itself(case: Case) -> None:
    """The outline of the sector, pi (100^2 - 50^2) / 3, from the entities' own points, flattened to 1e-4 mm."""
    points = [
        (point.x, point.y)
        for entity in on("CUT_OUTER", texts_of(case)["flat/sector.dxf"])
        for point in _forward(entity)
    ]
    x, y = np.array(points).T
    found = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    outline = 150.0 * 2.0 * pi / 3.0 + 100.0
    bound = outline * (CHORD_MM if case[0] == "polylines" else 1e-3)
    assert_near(abs(found), pi * 7500.0 / 3.0, bound=bound, why="a flattened arc is off by that along the outline")


def _forward(entity: DXFEntity) -> list[ezdxf.math.Vec3]:
    """Return the points of an entity in the direction of a counter-clockwise ring: its inner arc runs clockwise."""
    points = list(make_path(entity).flattening(1e-4))
    inner = entity.dxftype() == "ARC" and entity.dxf.radius < 75.0
    return points[::-1] if inner else points


@pytest.mark.parametrize("version", ["R12", "R2000"])
def test_lines_and_arcs_join_where_a_reader_computes_their_ends(version: Version) -> None:
    text = texts_of(("lines-arcs", version))["flat/strip.dxf"]
    entities = on("CUT_OUTER", text)
    ends = [(e.dxf.start, e.dxf.end) if e.dxftype() == "LINE" else (e.start_point, e.end_point) for e in entities]
    corners = [(point.x, point.y) for pair in ends for point in pair]
    nearest = [min(dist(a, b) for j, b in enumerate(corners) if j // 2 != i // 2) for i, a in enumerate(corners)]
    # ten decimals of centre and radius; the doubles of a radius of 1e5 mm
    assert max(nearest) < 1e-9


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("kerf_mm", [0.0, 0.2])
def test_outlines_that_share_cuts_are_whole_again(case: Case, kerf_mm: float) -> None:
    how = replace(machine(case), common_kerf_mm=kerf_mm)
    for layout in (grid(3, kerf_mm), brick(kerf_mm)):
        outcome = write(PARTS, Nesting((layout,)), how)
        assert outcome.report.passed, outcome.report.findings
        assert [finding.code for finding in outcome.report.findings] == ["common-lines"]


def test_an_outline_of_which_one_straight_line_is_left_is_told_from_a_common_line() -> None:
    """The middle of three panels in a row that end alike has two lines of its own left, above and below."""
    layout = SheetLayout(
        Sheet("stock", 500.0, 300.0),
        1,
        tuple(Placement("a", k + 1, Rigid2(10.0 + 50.2 * k, 10.0)) for k in range(3)),
        0.1,
    )
    how = Machine(flavour="lines-arcs", common_kerf_mm=0.2)
    outcome = write(PARTS, Nesting((layout,)), how)
    assert outcome.report.passed, outcome.report.findings
    text = {file.path: file.text for file in outcome.product}["cut/stock-1.dxf"]
    outer = [entity for entity in read(text).entities if entity.layer == "CUT_OUTER"]
    assert Counter(entity.kind for entity in outer) == {"CHAIN": 4, "LINE": 2}


def test_marks_that_begin_where_the_one_before_ended_stay_marks_of_their_own() -> None:
    marks = (
        line_mark((10.0, 10.0), (20.0, 10.0)),
        line_mark((20.0, 10.0), (20.0, 20.0)),
        line_mark((20.0, 20.0), (10.0, 10.0)),
    )
    part = plate().replace(marks=marks)
    for case in CASES:
        outcome = write([part], None, machine(case))
        assert outcome.report.passed, outcome.report.findings
        entities = read(outcome.product[0].text).entities
        assert [entity.kind for entity in entities if entity.layer == "MARK"] == ["LINE"] * 3


def test_a_lens_of_two_arcs_keeps_its_direction_in_arcs() -> None:
    bulges = np.array([-0.3, -0.3])
    lens = ArcPath(np.array([[0.0, 0.0], [10.0, 0.0]]), bulges, closed=True)
    cut = as_written(lens, Machine(flavour="lines-arcs"), outline=True)
    assert cut.bulges.size == 4
    assert_near(area(cut), area(lens), bound=1e-12, why="the same arcs in halves")
    assert as_written(lens, Machine(), outline=True) is lens


def test_an_arc_that_doubles_place_badly_is_a_line() -> None:
    bulge = 0.25 * 100.0 / (2.0 * LARGEST_RADIUS_MM)
    corners = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [0.0, 50.0]])
    path = ArcPath(corners, np.array([bulge, 0.0, 0.4, 0.0]), closed=True)
    found = as_written(path, Machine(flavour="lines-arcs"), outline=True)
    assert found.bulges.tolist() == [0.0, 0.0, 0.4, 0.0]


MOTIONS = st.builds(
    Rigid2, st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0), st.floats(0.0, 360.0), mirrored=st.booleans()
)


@settings(max_examples=8, deadline=None)
@given(MOTIONS, st.sampled_from(CASES), st.sampled_from([sector(), drop(), plate()]))
def test_a_placed_part_reads_back_with_its_length_and_area(motion: Rigid2, case: Case, part: FlatPattern) -> None:
    how = machine(case)
    laid = (Placement(part.part, 1, motion),)
    layout = SheetLayout(Sheet("stock", 500.0, 300.0), 1, laid, 0.1)
    outcome = write([part], Nesting((layout,)), how)
    assert outcome.report.passed, outcome.report.findings
    text = outcome.product[-1].text
    outer = next(entity.path for entity in read(text).entities if entity.layer == "CUT_OUTER")
    drawn = as_cut(part, how).outer.path
    assert_near(length(outer), length(drawn), bound=1e-7, why="some 40 pieces, ends rounded to 1e-10 mm or computed")
    assert_near(area(outer), area(drawn), bound=1e-7 * length(drawn), why="the same along the whole outline")


def test_two_processes_write_the_same_bytes_in_every_flavour() -> None:
    code = "\n".join([
        "from hashlib import sha256",
        "from tests.stages.write.test_flavours import CASES, good, machine",
        "for case in CASES: print(sha256(good(machine(case)).encode()).hexdigest())",
    ])  # fmt: skip
    seen = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": seed}
        )
        for seed in ("1", "2")
    ]
    assert len(seen[0].stdout.split()) == len(CASES)
    assert seen[0].stdout == seen[1].stdout


@pytest.mark.parametrize("flavour", ["lines-arcs", "polylines", "r12"])
def test_r12_says_millimetres_in_both_variables_that_it_does_not_know(flavour: Flavour) -> None:
    text = texts_of((flavour, "R12"))["flat/sector.dxf"]
    assert text.count("$INSUNITS\n 70\n4\n") == 1
    assert text.count("$MEASUREMENT\n 70\n1\n") == 1
    header = document(text).header
    assert header["$EXTMAX"][:2] == pytest.approx((100.0, 100.0), abs=CHORD_MM)
    for gone in ("$INSUNITS\n 70\n4", "$MEASUREMENT\n 70\n1"):
        broken = text.replace(f"  9\n{gone}\n", "")
        assert codes(broken) == {"readback-units"}


# planted faults


def codes(text: str) -> set[str]:
    return {finding.code for finding in faults(read(text), "flat/plate.dxf", LEAST_MM, CHORD_MM) if finding.fatal}


def told(text: str, how: Machine) -> set[str]:
    part = as_cut(rounded(), how)
    report = judged([CutFile("flat/plate.dxf", text)], [flat_drawing(part, how)], {part.part: part}, how)
    return {finding.code for finding in report.findings if finding.fatal}


def rounded() -> FlatPattern:
    """Return a plate with one round corner, a round hole and a slot."""
    corner = CircularArc(np.array([80.0, 40.0]), 20.0, 0.0, pi / 2.0)
    straight = polygon_edges((80.0, 60.0), (0.0, 60.0), (0.0, 0.0), (100.0, 0.0), (100.0, 40.0))[:4]
    slot = polygon_edges((10.0, 30.0), (10.0, 50.0), (20.0, 50.0), (20.0, 30.0))
    marks = (line_mark((50.0, 5.0), (60.0, 5.0)),)
    return pattern(
        "plate", contour([corner, *straight]), (30.0, 20.0), hole(60.0, 30.0, 10.0), contour(slot), marks=marks
    )


def good(how: Machine) -> str:
    return dxf_text(flat_drawing(as_cut(rounded(), how), how), how)


def changed(how: Machine, change: Callable[[Document], None]) -> str:
    found = document(good(how))
    # the library forgets them where there is no layout
    found.modelspace().reset_extents(found.header["$EXTMIN"], found.header["$EXTMAX"])
    change(found)
    stream = StringIO()
    found.write(stream)
    text = stream.getvalue()
    if how.version == "R12":
        text = text.replace("  9\n$LUNITS\n", "  9\n$INSUNITS\n 70\n4\n  9\n$MEASUREMENT\n 70\n1\n  9\n$LUNITS\n", 1)
    return text


def outer(found: Document) -> list[DXFEntity]:
    return [entity for entity in found.modelspace() if entity.dxf.layer == "CUT_OUTER"]


def lose_one(found: Document) -> None:
    found.modelspace().delete_entity(outer(found)[2])


def shift_one(found: Document) -> None:
    outer(found)[2].translate(0.0, 1e-3, 0.0)


def swap_two(found: Document) -> None:
    space, some = found.modelspace(), outer(found)
    order = [*some[:1], some[2], some[1], *some[3:]]
    for entity in order:
        space.unlink_entity(entity)
        space.add_entity(entity)


def twice(found: Document) -> None:
    space = found.modelspace()
    for entity in outer(found):
        space.add_entity(entity.copy())


def bend_other_way(found: Document) -> None:
    arc = next(entity for entity in outer(found) if entity.dxftype() == "ARC")
    # the arc over the same chord on its other side
    middle = (arc.start_point + arc.end_point) / 2.0
    arc.dxf.center = 2.0 * middle - arc.dxf.center
    arc.dxf.start_angle, arc.dxf.end_angle = (arc.dxf.start_angle + 180.0) % 360.0, (arc.dxf.end_angle + 180.0) % 360.0


def grow_arc(found: Document) -> None:
    arc = next(entity for entity in outer(found) if entity.dxftype() == "ARC")
    arc.dxf.radius += 1e-3


def outline_first(found: Document) -> None:
    space = found.modelspace()
    for entity in [entity for entity in space if entity.dxf.layer != "CUT_OUTER"]:
        space.unlink_entity(entity)
        space.add_entity(entity)


def other_colour(found: Document) -> None:
    for entity in outer(found):
        entity.dxf.color = 256


def extents(found: Document) -> None:
    high = (100.0, 60.5, 0.0)
    found.modelspace().reset_extents((0.0, 0.0, 0.0), high)
    found.header["$EXTMAX"] = high


LOOSE: list[tuple[str, Callable[[Document], None]]] = [
    ("readback-open-contour", lose_one),
    ("readback-open-contour", shift_one),
    ("readback-open-contour", swap_two),
    ("readback-open-contour", grow_arc),
    ("readback-duplicate", twice),
    ("readback-content", bend_other_way),
    ("readback-order", outline_first),
    ("readback-colour", other_colour),
    ("readback-extents", extents),
]


@pytest.mark.parametrize("version", ["R12", "R2000"])
@pytest.mark.parametrize(("code", "change"), LOOSE)
def test_a_fault_among_lines_and_arcs_is_found(version: Version, code: str, change: Callable[[Document], None]) -> None:
    how = Machine(flavour="lines-arcs", version=version)
    assert told(changed(how, lambda _: None), how) == set()
    assert code in told(changed(how, change), how)


def open_old(found: Document) -> None:
    outer(found)[0].dxf.flags &= ~1


def flip_old(found: Document) -> None:
    corner = next(vertex for vertex in outer(found)[0].vertices if vertex.dxf.bulge)
    corner.dxf.bulge = -corner.dxf.bulge


def move_old(found: Document) -> None:
    outer(found)[0].vertices[1].dxf.location += (0.0, 1e-3, 0.0)


def reverse_old(found: Document) -> None:
    line = outer(found)[0]
    points = [(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in line.vertices]
    bulges = [-points[(i - 1) % len(points)][2] for i in range(len(points))]
    places = [point[:2] for point in points][::-1]
    layer = {"layer": "CUT_OUTER", "color": 1}
    space = found.modelspace()
    space.delete_entity(line)
    space.add_polyline2d(
        [(*place, bulge) for place, bulge in zip(places, bulges[::-1], strict=True)],
        format="xyb",
        close=True,
        dxfattribs=layer,
    )


def repeat_old(found: Document) -> None:
    line = outer(found)[0]
    line.insert_vertices(1, [line.vertices[0].dxf.location], dxfattribs={"layer": "CUT_OUTER"})


def wide_old(found: Document) -> None:
    outer(found)[0].vertices[-1].dxf.bulge = 1.5


def fitted_old(found: Document) -> None:
    outer(found)[0].dxf.flags |= 4


OLD: list[tuple[str, Callable[[Document], None]]] = [
    ("readback-open-contour", open_old),
    ("readback-content", move_old),
    ("readback-direction", reverse_old),
    ("readback-repeated-vertex", repeat_old),
    ("readback-bulge", wide_old),
    ("readback-open-contour", fitted_old),
    ("readback-duplicate", twice),
    ("readback-order", outline_first),
    ("readback-colour", other_colour),
    ("readback-extents", extents),
]


@pytest.mark.parametrize("flavour", ["r12", "polylines"])
@pytest.mark.parametrize(("code", "change"), OLD)
def test_a_fault_in_an_old_polyline_is_found(flavour: Flavour, code: str, change: Callable[[Document], None]) -> None:
    how = Machine(flavour=flavour, version="R12")
    assert told(changed(how, lambda _: None), how) == set()
    assert code in told(changed(how, change), how)


def test_a_flipped_bulge_of_an_old_polyline_is_found() -> None:
    how = Machine(flavour="r12", version="R12")
    assert "readback-content" in told(changed(how, flip_old), how)


# layers


def own_layers() -> dict[str, Layer]:
    return {
        **PROFILES["planish"],
        "CUT_OUTER": Layer("CUT", 1),
        "CUT_INNER": Layer("CUT", 5),
        "MARK": Layer("Etch it", 3),
    }


@pytest.mark.parametrize("case", CASES)
def test_inventor_names_are_in_the_file_and_read_as_what_they_mean(case: Case) -> None:
    how = replace(machine(case), layers=PROFILES["inventor"])
    text = write([plate()], None, how).product[0].text
    assert {e.dxf.layer for e in document(text).modelspace()} == {
        "IV_OUTER_PROFILE", "IV_INTERIOR_PROFILES", "IV_FEATURE_PROFILES", "LABEL"
    }  # fmt: skip
    assert {e.layer for e in read(text, how.layers).entities} == {"CUT_OUTER", "CUT_INNER", "MARK", "LABEL"}
    assert "readback-layer" in codes(text)


def test_layers_that_share_a_name_are_told_apart_by_colour() -> None:
    how = Machine(layers=own_layers())
    text = write([plate()], None, how).product[0].text
    assert Counter(e.dxf.layer for e in document(text).modelspace()) == {"CUT": 3, "Etch it": 2, "LABEL": 1}
    assert [layer.dxf.name for layer in document(text).layers].count("CUT") == 1
    assert Counter(e.layer for e in read(text, how.layers).entities if e.layer.startswith("CUT")) == {
        "CUT_INNER": 2, "CUT_OUTER": 1
    }  # fmt: skip
    outline = next(e for e in on("CUT", text) if e.dxf.color == 1)
    found = document(text)
    found.entitydb[outline.dxf.handle].dxf.color = 5
    stream = StringIO()
    found.write(stream)
    report = judged(
        [CutFile("flat/plate.dxf", stream.getvalue())], [flat_drawing(plate(), how)], {"plate": plate()}, how
    )
    assert not report.passed


def test_a_layer_of_another_profile_is_not_taken_for_one_of_ours() -> None:
    layers = {**PROFILES["planish"], "CUT_OUTER": Layer("CONTOUR", 1)}
    text = texts_of(CASES[0])["flat/plate.dxf"]
    found = {finding.code for finding in faults(read(text, layers), "x", LEAST_MM, CHORD_MM)}
    assert "readback-layer" in found
