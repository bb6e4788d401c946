"""The traveller as Poppler sees it: its texts, its pages, its line of 100 mm, and nothing outside of a page."""

import json
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from pipeline.report.render import Made
from pipeline.report.traveller.book import traveller_pdf
from pipeline.report.traveller.numbers import millimetres
from tests.pipeline.jobs import CONE, STOCK
from tests.pipeline.report.traveller.test_book import LARGE, PLATE, produced
from tests.readers.test_pictures import GRID_MM, lines, there

XHTML = "{http://www.w3.org/1999/xhtml}"
WIDE = PLATE.replace('name = "plate"', f'name = "Größe {"W" * 70}"')


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("traveller")
    for path, content in produced(
        out, WIDE + CONE + LARGE + STOCK.replace("100", "9000").replace("60", "9000")
    ).items():
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_bytes(content)
    return out


def said(folder: Path, *more: str) -> str:
    command = [there("pdftotext"), *more, "traveller.pdf", "-"]
    run = subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    assert run.stderr == b"", "not a word of complaint"
    return run.stdout.decode()


@pytest.mark.readers
def test_poppler_finds_every_dimension(folder: Path) -> None:
    words = said(folder, "-raw").split()
    report = json.loads((folder / "report.json").read_bytes())
    for part in report["parts"]:
        flat = part["flat"]
        lengths = [flat["width"], flat["height"], *(flat["edges"] or {}).values()]
        corners = np.array(flat["corners"])
        lengths += [float(np.hypot(*(corners[i] - corners[j]))) for i, j in ((0, 2), (1, 3))]
        assert {millimetres(length) for length in lengths} <= {*words}


@pytest.mark.readers
def test_poppler_reads_umlauts(folder: Path) -> None:
    assert "Größe" in said(folder, "-raw")


@pytest.mark.readers
def test_poppler_sees_no_word_outside_of_a_page_and_no_two_in_one_place(folder: Path) -> None:
    for page in ElementTree.fromstring(said(folder, "-bbox")).iter(f"{XHTML}page"):
        width, height = float(page.attrib["width"]), float(page.attrib["height"])
        rows = [[float(word.attrib[key]) for key in ("xMin", "yMin", "xMax", "yMax")] for word in page]
        boxes = np.array(rows)
        assert (boxes[:, :2] >= 0.0).all()
        assert (boxes[:, 2:] <= [width, height]).all()
        assert not clashes(boxes)


SHARED = 0.3
"""Of the smaller of two boxes: lines are set closer than the boxes of their letters are high."""


def clashes(boxes: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> list[tuple[int, int]]:
    """Return the words that cover more of each other than neighbouring lines do."""
    low, high = np.maximum(boxes[:, None, :2], boxes[None, :, :2]), np.minimum(boxes[:, None, 2:], boxes[None, :, 2:])
    common = np.prod(np.clip(high - low, 0.0, None), axis=2)
    size = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1)
    found = np.argwhere(np.triu(common > SHARED * np.minimum(size[:, None], size[None, :]), 1))
    return [(int(i), int(j)) for i, j in found]


def test_words_in_one_place_are_found() -> None:
    boxes = np.array([[0.0, 0.0, 10.0, 4.0], [8.0, 0.0, 18.0, 4.0], [5.0, 0.5, 15.0, 4.5]])
    assert clashes(boxes) == [(0, 2), (1, 2)]


@pytest.mark.readers
def test_poppler_sees_the_check_line_on_every_page(folder: Path) -> None:
    count = len(list(ElementTree.fromstring(said(folder, "-bbox")).iter(f"{XHTML}page")))
    for number in range(1, count + 1):
        found = lines(page_of(folder, number))
        long = [points for points in found if len(points) == 2 and abs(np.ptp(points[:, 0]) - 100.0) <= GRID_MM]
        assert any(abs(points[0, 0] - 12.0) <= GRID_MM and abs(points[0, 1] - 9.0) <= GRID_MM for points in long)


def page_of(folder: Path, number: int) -> str:
    page = ["-f", str(number), "-l", str(number)]
    command = [there("pdftocairo"), "-svg", "-noshrink", "-nocenter", *page, "traveller.pdf", "page.svg"]
    run = subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    assert run.stderr == b""
    return (folder / "page.svg").read_text("utf-8")


@pytest.mark.readers
def test_a_length_that_is_not_in_the_pages_is_not_found(folder: Path) -> None:
    report = json.loads((folder / "report.json").read_bytes())
    told = next(span for span in report["parts"][1]["tape"]["spans"] if span["what"] == "c0")
    told["along_mm"] += 1.0
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    (folder / "other").mkdir()
    (folder / "other/traveller.pdf").write_bytes(traveller_pdf(Made(report, files)))
    length = millimetres(told["along_mm"])
    assert length in said(folder / "other", "-raw").split()
    assert length not in said(folder, "-raw").split()
