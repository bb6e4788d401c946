"""PDF files: cubic pieces within their bound of the arcs, one page at 1:1."""

import re
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.paths.arcpath import ArcPath, area, bounds, distances, length, piece_count
from stages.model.cutfile import PROFILES, Layer, Machine
from stages.model.pattern import FlatPattern
from stages.write.colours import BRIGHTEST_ON_PAPER, on_paper, rgb
from stages.write.drawing import Drawing, Item, extent, flat_drawing, sheet_drawing
from stages.write.pdf import ARC_MM, CONDENSED, cubic_error, cubics, for_cubics
from stages.write.pdfobjects import CAPITAL_SHARE, LETTER_SHARE, string
from stages.write.pdfpages import CHECK_LAYER, MARGIN_MM, REGISTER_LAYER, drawing_pdf
from tests.near import assert_near
from tests.stages.write.patterns import drop, nesting, plate, sector, strip
from tests.stages.write.pictures import pdf_shapes, stream

MACHINE = Machine()
POINT = 72.0 / 25.4


def flat(part: FlatPattern) -> Drawing:
    return flat_drawing(part, MACHINE)


def sheet() -> Drawing:
    return sheet_drawing(nesting().layouts[0], {one.part: one for one in (plate(), sector())}, MACHINE)


def arc(radius: float, sweep: float) -> ArcPath:
    ends = radius * np.array([[1.0, 0.0], [np.cos(sweep), np.sin(sweep)]])
    return ArcPath(ends, np.array([np.tan(sweep / 4.0), 0.0]), closed=False)


# Cubic pieces


@pytest.mark.parametrize("sweep", [0.05, 0.3, 0.8, pi / 2.0, -pi / 2.0, -0.6])
def test_a_cubic_piece_is_as_far_off_its_arc_as_the_formula_says(sweep: float) -> None:
    """By its points at many parameters; the difference is largest at two of them."""
    path = arc(100.0, sweep)
    inner = cubics(path)[0]
    t = np.linspace(0.0, 1.0, 20_001)[:, None]
    a, b, c, d = path.vertices[0], *inner, path.vertices[1]
    on = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    away = np.hypot(*on.T) - 100.0
    wanted = float(cubic_error(np.array([100.0]), np.array([abs(sweep)]))[0])
    assert_near(away.max(), wanted, bound=1e-6 * wanted + 1e-13, why="steps of 5e-5 beside a flat maximum")
    assert away.min() >= -1e-13


def test_four_quarters_miss_a_circle_by_what_is_known_of_them() -> None:
    """2.725e-4 of the radius (Goldapp's table)."""
    assert_near(cubic_error(np.array([1.0]), np.array([pi / 2.0])), [2.725e-4], bound=5e-8, why="four digits")


@given(st.floats(0.01, 1e5), st.floats(-1.5, 1.5).filter(lambda sweep: abs(sweep) > 1e-3))
def test_arcs_are_divided_until_their_cubics_keep_the_bound(radius: float, sweep: float) -> None:
    path = for_cubics(arc(radius, sweep))
    count = piece_count(path)
    inner = cubics(path)
    t = np.linspace(0.0, 1.0, 41)[1:-1, None]
    for piece in range(count):
        a, b, c, d = path.vertices[piece], *inner[piece], path.vertices[piece + 1]
        on = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
        away = distances(on, arc(radius, sweep), np.zeros(len(on), dtype=np.int64))
        assert away.max() <= ARC_MM + 1e-14 * radius


def test_no_more_pieces_than_needed() -> None:
    """A quarter circle of 1000 mm: four pieces are 0.27 mm / 4^6 off, three would be 3.7e-4 mm."""
    assert piece_count(for_cubics(arc(1000.0, pi / 2.0))) == 4
    assert piece_count(for_cubics(arc(0.3, pi / 2.0))) == 1


# The drawing


@pytest.mark.parametrize("drawing", [flat(plate()), flat(sector()), flat(strip()), flat(drop()), sheet()])
def test_every_path_is_read_as_it_was_drawn(drawing: Drawing) -> None:
    shapes = pdf_shapes(drawing_pdf(drawing, MACHINE))
    assert [shape.about["layer"] for shape in shapes] == [item.layer for item in drawing.items]
    for shape, item in zip(shapes, drawing.items, strict=True):
        path = item.path
        assert shape.closed == path.closed
        off = ARC_MM if path.bulges.any() else 1e-9
        assert_near(shape.length, length(path), bound=2.0 * pi * off * 4.0, why="a curve d off turns by a full turn")
        if path.closed:
            assert_near(shape.area, area(path), bound=length(path) * off, why="a strip of that width along it")
        found = [*shape.points.min(axis=0), *shape.points.max(axis=0)]
        assert_near(found, bounds(path), bound=off + 2e-3 * length(path), why="64 points on each cubic")


@pytest.mark.parametrize("fault", ["a digit", "a piece less", "another layer"])
def test_a_fault_in_the_file_is_seen(fault: str) -> None:
    text = drawing_pdf(flat(plate()), MACHINE)
    wanted = pdf_shapes(text)
    spoilt = {
        "a digit": text.replace("100 0 l", "101 0 l", 1),
        "a piece less": text.replace(" 0 60 l", "       ", 1),
        "another layer": text.replace("/OC /L2 BDC", "/OC /L1 BDC", 1),
    }[fault]
    assert spoilt != text
    found = pdf_shapes(spoilt)
    assert [(one.area, one.length, one.about) for one in found] != [(one.area, one.length, one.about) for one in wanted]


def test_a_wrong_place_in_the_table_is_seen() -> None:
    text = drawing_pdf(flat(plate()), MACHINE).replace("/Type /Catalog", "/Type  /Catalog", 1)
    with pytest.raises(AssertionError):
        stream(text, 5)


def pages(text: str) -> list[tuple[float, float]]:
    return [(float(x) / POINT, float(y) / POINT) for x, y in re.findall(r"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", text)]


def contents(text: str) -> list[str]:
    return [stream(text, int(number)) for number in re.findall(r"/Contents (\d+) 0 R", text)]


def check_ends(content: str) -> list[list[float]]:
    """Return the ends of the first line on the layer of the check line, mm on the page."""
    line = re.search(r"w\n(\S+) (\S+) m (\S+) (\S+) l S", content[content.rindex("BDC") :])
    assert line is not None
    return [[float(line[1]), float(line[2])], [float(line[3]), float(line[4])]]


@pytest.mark.parametrize("drawing", [flat(plate()), flat(drop()), sheet()])
def test_one_page_holds_the_drawing_and_a_margin_with_100_mm_in_it(drawing: Drawing) -> None:
    text = drawing_pdf(drawing, MACHINE)
    low_x, low_y, high_x, high_y = extent(item.path for item in drawing.items)
    ((width, height),) = pages(text)
    assert_near(width, max(high_x - low_x, 100.0) + 2.0 * MARGIN_MM, bound=1e-6, why="six decimals of a point")
    assert_near(height, high_y - low_y + 2.0 * MARGIN_MM, bound=1e-6, why="six decimals of a point")
    (content,) = contents(text)
    (x0, y0), (x1, y1) = check_ends(content)
    assert_near([x1 - x0, y1 - y0], [100.0, 0.0], bound=1e-9, why="exact")
    assert 4.2 < y0 < MARGIN_MM - 4.0, "printed, and below the drawing"
    moved = re.search(r"1 0 0 1 (\S+) (\S+) cm /D Do", content)
    assert moved is not None
    assert_near([float(moved[1]) + low_x, float(moved[2]) + low_y], [MARGIN_MM] * 2, bound=1e-9, why="ten decimals")
    assert f"{POINT:.12f} 0 0 {POINT:.12f} 0 0 cm" in content


def test_layers_are_those_of_the_profile_and_one_for_the_check_line() -> None:
    machine = Machine(layers=dict(PROFILES["inventor"]))
    text = drawing_pdf(flat(plate()), machine)
    names = ["IV_FEATURE_PROFILES", "IV_INTERIOR_PROFILES", "IV_OUTER_PROFILE", "LABEL", CHECK_LAYER]
    assert re.findall(r"/Type /OCG /Name \((\w+)\)", text) == names
    tiled = drawing_pdf(flat(plate()), replace(machine, also=("pdf",), paper="A4"))
    assert re.findall(r"/Type /OCG /Name \((\w+)\)", tiled) == [*names, REGISTER_LAYER]


def test_a_text_is_as_wide_as_courier_and_has_its_middle_at_its_place() -> None:
    drawing = sheet()
    content = stream(drawing_pdf(drawing, MACHINE), 5)
    texts = re.findall(r"BT /F (\S+) Tf (\d+) Tz ([-0-9. ]+) Tm \((\w+)\) Tj ET", content)
    assert [words for *_, words in texts] == [label.text for label in drawing.labels]
    for (size, wide, place, words), label in zip(texts, drawing.labels, strict=True):
        a, b, c, d, x, y = map(float, place.split())
        half = np.array([LETTER_SHARE * CONDENSED / 100.0 * len(words), CAPITAL_SHARE]) * float(size) / 2.0
        middle = np.array([x, y]) + half[0] * np.array([a, b]) + half[1] * np.array([c, d])
        assert (int(wide), len(words)) == (CONDENSED, len(label.text))
        assert_near(middle, label.at, bound=1e-8, why="ten decimals, times the length of the text")
        assert_near(
            np.arctan2(b, a) % (2 * pi), np.radians(label.angle_deg) % (2 * pi), bound=1e-9, why="its direction"
        )


def test_texts_cannot_leave_their_strings() -> None:
    assert string("a(b)c\\") == r"(a\(b\)c\\)"
    assert string("\u00e9\n") == "(??)"
    text = drawing_pdf(flat(plate(") Tj ET (")), MACHINE)
    assert r"(\) Tj ET \()" in text
    assert len(contents(text)) == 1


def test_what_is_bright_is_darker_on_paper_and_the_rest_is_the_profile() -> None:
    assert on_paper(1) == rgb(1) == (255, 0, 0)
    assert rgb(7) == on_paper(7) == (0, 0, 0)
    assert rgb(2) == (255, 255, 0)
    red, green, blue = on_paper(2)
    assert (red, blue) == (green, 0)
    assert_near((0.2126 + 0.7152) * red / 255.0, BRIGHTEST_ON_PAPER, bound=0.5 / 255.0, why="rounded to whole steps")
    assert all(rgb(index) == on_paper(index) for index in (1, 5, 6))


def test_what_is_not_finite_cannot_be_written() -> None:
    drawing = flat(plate())
    path = drawing.items[-1].path
    object.__setattr__(path, "vertices", path.vertices * np.array([np.nan, 1.0]))
    with pytest.raises(ValueError, match="finite"):
        drawing_pdf(drawing, MACHINE)


def test_a_drawing_of_one_line_is_a_page_too() -> None:
    line = Item("MARK", "line", ArcPath(np.array([[0.0, 0.0], [10.0, 0.0]]), np.zeros(2), closed=False))
    text = drawing_pdf(Drawing("flat/line.dxf", (line,), ()), Machine(layers={"MARK": Layer("M", 3)}))
    assert_near(pages(text), [(130.0, 30.0)], bound=1e-6, why="the check line and the margins")
