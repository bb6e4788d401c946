"""SVG and PDF files as other programs see them: Inkscape the boxes of an SVG, Poppler the curves and texts of a PDF."""

import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from stages.geometry.arrays import Array
from stages.geometry.paths.arcpath import bounds, length
from stages.model.cutfile import Machine
from stages.write.drawing import Drawing, extent, flat_drawing, sheet_drawing
from stages.write.pdf import LINE_MM
from stages.write.pdfpages import CHECK_MM, MARGIN_MM, drawing_pdf
from stages.write.svg import HAIRLINE_MM, svg_text
from tests.near import assert_near
from tests.stages.write.patterns import drop, nesting, plate, sector, strip

MACHINE = Machine()
POINT_MM = 25.4 / 72.0
PIXEL_MM = 25.4 / 96.0
DIGITS_MM = 2e-5
"""Inkscape states six digits of numbers up to some thousand pixels."""

GRID_MM = POINT_MM / 256.0
"""Where cairo, by which Poppler draws, puts points: half of that is what it moves one by."""


def there(program: str) -> str:
    found = shutil.which(program)
    if found is None:
        pytest.skip(f"{program} is not installed: bash tests/readers/install.sh")
    return found


def drawings() -> list[Drawing]:
    parts = {one.part: one for one in (plate(), sector())}
    return [flat_drawing(one, MACHINE) for one in (plate(), strip(), drop())] + [
        sheet_drawing(nesting().layouts[0], parts, MACHINE)
    ]


def popplers(folder: Path, text: str, *more: str) -> str:
    (folder / "drawing.pdf").write_text(text, "ascii")
    command = [there("pdftocairo"), "-svg", "-noshrink", "-nocenter", *more, "drawing.pdf", "drawing.svg"]
    run = subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    assert run.stderr == b"", "not a word of complaint"
    return (folder / "drawing.svg").read_text("utf-8")


def lines(page: str) -> list[Array]:
    """Return the paths that Poppler draws, as points in mm on the page, y upwards; glyphs are elsewhere."""
    root = ElementTree.fromstring(page)
    height = float(root.attrib["height"].removesuffix("pt"))
    found = []
    for path in root.iter("{http://www.w3.org/2000/svg}path"):
        if "fill:none" not in path.attrib.get("style", f"fill:{path.attrib.get('fill')}"):
            continue
        a, b, c, d, e, f = map(float, re.findall(r"-?[0-9.]+(?:e-?\d+)?", path.attrib.get("transform", "1 0 0 1 0 0")))
        points = np.array(_points(path.attrib["d"])) @ np.array([[a, b], [c, d]]) + np.array([e, f])
        found.append((points * [1.0, -1.0] + [0.0, height]) * POINT_MM)
    return found


def _points(described: str) -> list[Array]:
    made: list[Array] = []
    for letter, rest in re.findall(r"([MLCZ])([^MLCZ]*)", described):
        numbers = np.array([float(word) for word in rest.split()]).reshape(-1, 2)
        if letter == "Z":
            made.append(made[0])
        elif letter == "C":
            t = np.linspace(0.0, 1.0, 33)[1:, None]
            p, q, r, s = made[-1], *numbers
            made += list((1 - t) ** 3 * p + 3 * t * (1 - t) ** 2 * q + 3 * t**2 * (1 - t) * r + t**3 * s)
        else:
            made += list(numbers)
    return made


@pytest.mark.readers
@pytest.mark.parametrize("drawing", drawings(), ids=lambda drawing: drawing.path)
def test_poppler_sees_every_path_of_a_page_at_1_to_1(drawing: Drawing, tmp_path: Path) -> None:
    found = lines(popplers(tmp_path, drawing_pdf(drawing, MACHINE)))
    *paths, check, left, right = found
    assert len(paths) == len(drawing.items)
    assert_near(np.ptp(check[:, 0]), CHECK_MM, bound=GRID_MM, why="the line of 100 mm is 100 mm long")
    assert_near([left[0, 0], right[0, 0]], check[:, 0], bound=GRID_MM, why="ticks at its ends")
    low_x, low_y, *_ = extent(item.path for item in drawing.items)
    for points, item in zip(paths, drawing.items, strict=True):
        moved = points - MARGIN_MM + [low_x, low_y]
        step = np.hypot(*np.diff(moved, axis=0).T)
        long = length(item.path)
        assert_near(step.sum(), long, bound=2e-4 * long + GRID_MM * len(step), why="chords of 3 deg, and the grid")
        box = np.array([moved.min(axis=0), moved.max(axis=0)]).ravel()
        assert_near(box, bounds(item.path), bound=GRID_MM + step.max() / 64.0, why="the grid and the height of a chord")


@pytest.mark.readers
def test_poppler_sees_a_stroke_as_wide_as_it_should_be(tmp_path: Path) -> None:
    page = popplers(tmp_path, drawing_pdf(flat_drawing(plate(), MACHINE), MACHINE))
    assert set(re.findall(r"""stroke-width(?::|=")([0-9.]+)""", page)) == {f"{LINE_MM:g}"}


@pytest.mark.readers
def test_poppler_reads_the_texts(tmp_path: Path) -> None:
    (tmp_path / "drawing.pdf").write_text(drawing_pdf(drawings()[-1], MACHINE), "ascii")
    command = [there("pdftotext"), "-raw", "drawing.pdf", "-"]
    said = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=60).stdout.decode()
    labels = ["plate", "plate", "sector", "sector"]
    assert sorted(said.split()) == sorted(["100", "mm", "at", "1:1", "cut/stock-1", *labels])


@pytest.mark.readers
def test_poppler_sees_on_every_page_its_part_of_the_drawing(tmp_path: Path) -> None:
    """The same corner of the outline lies on two pages, apart by what the pages are."""
    text = drawing_pdf(flat_drawing(strip(), MACHINE), Machine(paper="A4"))
    for number in range(1, 7):
        page = popplers(tmp_path, text, "-f", str(number), "-l", str(number))
        root = ElementTree.fromstring(page)
        assert_near(
            [float(root.attrib[side].removesuffix("pt")) * POINT_MM for side in ("width", "height")],
            (297.0, 210.0), bound=GRID_MM, why="A4 across",
        )  # fmt: skip
        found = lines(page)
        assert any(abs(np.ptp(points[:, 0]) - CHECK_MM) < GRID_MM and len(points) == 2 for points in found)


@pytest.mark.readers
def test_inkscape_sees_every_path_in_its_place(tmp_path: Path) -> None:
    drawing = drawings()[-1]
    root = ElementTree.fromstring(svg_text(drawing, MACHINE))
    for number, path in enumerate(root.iter("{http://www.w3.org/2000/svg}path")):
        path.attrib["id"] = f"path{number}"
    ElementTree.ElementTree(root).write(tmp_path / "drawing.svg")
    command = [there("inkscape"), "--query-all", "drawing.svg"]
    said = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=120).stdout.decode()
    rows = {
        row.split(",")[0]: np.array(row.split(",")[1:], dtype=float) for row in said.split() if row.startswith("path")
    }
    assert len(rows) == len(drawing.items)
    for number, item in enumerate(drawing.items):
        x, y, width, height = rows[f"path{number}"] * PIXEL_MM
        low_x, low_y, high_x, high_y = bounds(item.path)
        found = [x, 300.0 - y - height, x + width, 300.0 - y]
        assert_near(found, (low_x, low_y, high_x, high_y), bound=HAIRLINE_MM + DIGITS_MM, why="half a stroke around it")
