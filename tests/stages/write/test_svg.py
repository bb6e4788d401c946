"""SVG files: the drawing's own lines and arcs at 1:1, read by another method; names and colours."""

import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, bounds, length, split
from stages.model.cutfile import PROFILES, Layer, Machine
from stages.model.pattern import FlatPattern, Mark
from stages.model.sheet import Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.drawing import Drawing, Item, flat_drawing, sheet_drawing
from stages.write.flavours import as_cut
from stages.write.svg import svg_text
from tests.near import assert_near
from tests.stages.write.patterns import contour, drop, line_mark, nesting, pattern, plate, polygon_edges, sector, strip
from tests.stages.write.pictures import SVG, Shape, svg_shapes

MACHINE = Machine()
STEP = 5e-11
"""What rounding to ten decimals moves a coordinate and a radius by, mm."""


def flat(part: FlatPattern, machine: Machine = MACHINE) -> Drawing:
    return flat_drawing(as_cut(part, machine), machine)


def sheet() -> Drawing:
    return sheet_drawing(nesting().layouts[0], {one.part: one for one in (plate(), sector())}, MACHINE)


def assert_alike(shape: Shape, path: ArcPath) -> None:
    """Fail unless a path was read as it was drawn: by its length, its area and its box."""
    why = "each end and each radius rounded"
    assert shape.closed == path.closed
    assert_near(shape.length, length(path), bound=16.0 * STEP * len(path.vertices) + 1e-12 * length(path), why=why)
    assert_near(shape.area, area(path) if path.closed else 0.0, bound=16.0 * STEP * length(path) + 1e-9, why=why)
    found = [*shape.points.min(axis=0), *shape.points.max(axis=0)]
    sagitta = length(path) / max(shape.curved, 1) * np.pi / 4.0 / 64.0
    assert_near(found, bounds(path), bound=sagitta + 4.0 * STEP, why="64 points on an arc of a quarter turn at most")


@pytest.mark.parametrize("drawing", [flat(plate()), flat(sector()), flat(strip()), flat(drop()), sheet()])
def test_every_path_is_read_as_it_was_drawn(drawing: Drawing) -> None:
    shapes = svg_shapes(svg_text(drawing, MACHINE))
    assert [shape.about["data-kind"] for shape in shapes] == [item.layer for item in drawing.items]
    for shape, item in zip(shapes, drawing.items, strict=True):
        assert_alike(shape, item.path)


def test_arcs_stay_arcs() -> None:
    for part in (plate(), sector(), strip(), drop()):
        for shape, item in zip(svg_shapes(svg_text(flat(part), MACHINE)), flat(part).items, strict=True):
            assert shape.curved == np.count_nonzero(item.path.bulges)


def test_a_flavour_without_arcs_has_none_here_either() -> None:
    shapes = svg_shapes(svg_text(flat(strip(), Machine(flavour="polylines")), Machine(flavour="polylines")))
    assert [shape.curved for shape in shapes] == [0] * len(shapes)


def ring(x: float, y: float, radius: float, turn: float, share: float) -> ArcPath:
    """Return a closed path of two arcs and a chord, split as drawings are."""
    angles = turn + np.array([0.0, 2.0 * share, 2.0 * share + 1.3])
    points = np.array([x, y]) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    path = ArcPath(points, np.array([np.tan(share / 2.0), -np.tan(1.3 / 4.0), 0.0]), closed=True)
    return split(path, max_bulge=MACHINE.max_bulge)


@given(
    st.floats(-3000.0, 3000.0),
    st.floats(-3000.0, 3000.0),
    st.floats(0.1, 1e4),
    st.floats(0.0, 6.28),
    st.floats(0.05, 2.0),
)
def test_any_arc_is_read_as_it_was_drawn(x: float, y: float, radius: float, turn: float, share: float) -> None:
    path = ring(x, y, radius, turn, share)
    (shape,) = svg_shapes(svg_text(Drawing("flat/ring.dxf", (Item("CUT_OUTER", "ring", path, 0),), ()), MACHINE))
    assert_alike(shape, path)


def test_an_arc_too_flat_for_viewers_is_a_line() -> None:
    path = ArcPath(np.array([[0.0, 0.0], [100.0, 0.0], [50.0, 80.0]]), np.array([1e-9, 1e-3, 0.0]), closed=True)
    (shape,) = svg_shapes(svg_text(Drawing("flat/flat.dxf", (Item("CUT_OUTER", "flat", path, 0),), ()), MACHINE))
    assert shape.curved == 1
    assert_near(shape.area, area(path), bound=1e-6 * 100.0, why="below the height of the arc")


def test_the_page_is_the_extent_in_millimetres() -> None:
    root = ElementTree.fromstring(svg_text(sheet(), MACHINE))
    assert (root.attrib["width"], root.attrib["height"]) == ("500mm", "300mm")
    assert root.attrib["viewBox"] == "0 0 500 300"


@pytest.mark.parametrize("fault", ["arc the other way", "one digit", "a path less"])
def test_a_fault_in_the_file_is_seen(fault: str) -> None:
    drawing = flat(sector())
    text = svg_text(drawing, MACHINE)
    if fault == "arc the other way":
        spoilt = re.sub(r" 0 0 0 ", " 0 0 1 ", text, count=1)
    elif fault == "one digit":
        spoilt = re.sub(r"A100 100", "A100.001 100.001", text, count=1)
    else:
        spoilt = re.sub(r"<path[^>]*/>", "", text, count=1)
    assert spoilt != text
    with pytest.raises((AssertionError, ValueError)):
        for shape, item in zip(svg_shapes(spoilt), drawing.items, strict=True):
            assert_alike(shape, item.path)


# Names, groups, colours


def named(name: str) -> FlatPattern:
    outer = contour(polygon_edges((0.0, 0.0), (50.0, 0.0), (50.0, 30.0), (0.0, 30.0)))
    return pattern(name, outer, (25.0, 15.0), marks=(replace(line_mark((5.0, 5.0), (9.0, 5.0)), name=name),))


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", 'a"b&c', "--><!--", "plain"])
def test_names_cannot_leave_their_place(name: str) -> None:
    text = svg_text(flat(named(name)), MACHINE)
    root = ElementTree.fromstring(text)
    assert {element.tag for element in root.iter()} == {f"{SVG}{tag}" for tag in ("svg", "title", "g", "path", "text")}
    assert [shape.about["data-part"] for shape in svg_shapes(text)] == [name, name]
    assert svg_shapes(text)[0].about["data-name"] == name
    assert [one.text for one in root.iter(f"{SVG}text")] == [name]


def test_a_name_that_xml_does_not_know_is_still_a_file() -> None:
    mark = Mark("a\x01b\u00e9", line_mark((5.0, 5.0), (9.0, 5.0)).path)
    shapes = svg_shapes(svg_text(flat(plate().replace(marks=(mark,))), MACHINE))
    assert shapes[0].about["data-name"] == "a?b\u00e9"


def test_ids_are_ascii_and_occur_once() -> None:
    layout = SheetLayout(
        Sheet("s", 300.0, 100.0),
        1,
        (Placement("a b", 1, Rigid2(0.0, 0.0)), Placement("a_b", 1, Rigid2(60.0, 0.0))),
        0.5,
    )
    text = svg_text(sheet_drawing(layout, {name: named(name) for name in ("a b", "a_b")}, MACHINE), MACHINE)
    ids = [element.attrib["id"] for element in ElementTree.fromstring(text).iter() if "id" in element.attrib]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_.-]*", one) for one in ids)
    assert text.isascii()


def test_a_group_for_each_copy_and_in_it_one_for_each_layer() -> None:
    root = ElementTree.fromstring(svg_text(sheet(), MACHINE))
    groups = [group for group in root[1] if "data-part" in group.attrib]
    assert [(group.attrib["data-part"], group.attrib["data-copy"]) for group in groups] == [
        ("plate", "1"), ("plate", "2"), ("sector", "1"), ("sector", "2"),
    ]  # fmt: skip
    kinds = [[inner.attrib["data-kind"] for inner in group] for group in groups]
    assert kinds == [["MARK", "CUT_INNER", "CUT_OUTER"]] * 2 + [["CUT_OUTER"]] * 2


def test_colours_are_those_of_the_profile_and_white_is_black() -> None:
    layers = dict(PROFILES["planish"]) | {"CUT_OUTER": Layer("OUT", 7), "CUT_INNER": Layer("IN", 30)}
    shapes = svg_shapes(svg_text(flat(plate()), Machine(layers=layers)))
    found = {shape.about["data-kind"]: shape.about["stroke"] for shape in shapes}
    assert found == {"MARK": "#00ff00", "CUT_INNER": "#ff7f00", "CUT_OUTER": "#000000"}
    labels = {shape.about["{http://www.inkscape.org/namespaces/inkscape}label"] for shape in shapes}
    assert labels == {"MARK", "IN", "OUT"}


def test_a_text_has_its_middle_at_its_place() -> None:
    drawing = sheet()
    root = ElementTree.fromstring(svg_text(drawing, MACHINE))
    for text, label in zip(root.iter(f"{SVG}text"), drawing.labels, strict=True):
        x, y, angle = map(float, re.findall(r"-?[0-9.]+", text.attrib["transform"]))
        assert_near([x, 300.0 - y, -angle], [*label.at, label.angle_deg], bound=1e-9, why="ten decimals")
        assert_near(float(text.attrib["y"]), label.height_mm / 2.0, bound=1e-9, why="half a capital below the middle")


# As files


def test_they_come_with_every_drawing_and_only_if_asked_for() -> None:
    parts = [plate(), sector()]
    paths = [file.path for file in write(parts, nesting(), Machine(also=("svg", "pdf"))).product]
    drawings = [path for path in paths if path.endswith(".dxf")]
    wanted = {path.replace(".dxf", end) for path in drawings for end in (".svg", ".pdf")}
    assert set(paths) - {*drawings} == wanted
    assert [file.path for file in write(parts, nesting(), MACHINE).product] == drawings


ONCE = """
from hashlib import sha256
from stages.model.cutfile import Machine
from stages.write import write
from tests.stages.write.patterns import nesting, plate, sector
made = write([plate(), sector()], nesting(), Machine(also=("svg", "pdf"), paper="A4")).product
print(sha256("".join(file.path + file.text for file in made).encode()).hexdigest())
"""


def test_two_processes_write_the_same_bytes() -> None:
    def started(seed: str) -> "subprocess.Popen[bytes]":
        environment = {"PYTHONHASHSEED": seed, "TZ": f"X{seed}"}
        return subprocess.Popen([sys.executable, "-c", ONCE], env=environment, stdout=subprocess.PIPE)

    one, other = (run.communicate()[0] for run in [started("1"), started("2")])
    assert one == other
    assert len(one.strip()) == len("a sha256 in hexadecimal digits, ") * 2
