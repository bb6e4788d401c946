"""The code of a page: read by a reader of the tests' own, from its operators and as it is printed."""

import re
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.traveller.code import MODULE_MM, QUIET_MM, code_of
from tests.pdfs import page_operators, texts
from tests.pipeline.jobs import CONE, STOCK
from tests.pipeline.report.traveller.test_book import PLATE, produced
from tests.poppler import PIXELS_PER_MM, grey, needs_poppler, words
from tests.qrcodes import Modules, finder_like, read

ID = re.compile(r"[0-9a-f]{8}-[PS]\d{3}")
FOOT_MM, CORNER_MM = 17.3, 24
"""The corner of a page below the line above its foot in which nothing stands but the code."""
DARK = 128


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("traveller")
    made = folder / "traveller.pdf"
    made.write_bytes(produced(folder, PLATE + CONE + STOCK)["traveller.pdf"])
    return made


def drawn(content: str) -> Modules:
    """Return the modules that the operators of a code fill."""
    count = round(code_of("x").side_mm / MODULE_MM)
    modules = np.zeros((count, count), dtype=bool)
    for x, y, wide in re.findall(r"(\d+) (\d+) (\d+) 1 re", content):
        row, column = count - 1 - int(y), int(x)
        assert not modules[row, column : column + int(wide)].any()
        modules[row, column : column + int(wide)] = True
    return modules


def printed(page: np.ndarray) -> tuple[Modules, tuple[int, int, int, int]]:
    """Return the modules of the code in the foot of a page on its right, and their box in pixels."""
    left = page.shape[1] - CORNER_MM * PIXELS_PER_MM
    rows, columns = np.nonzero(page[: int(FOOT_MM * PIXELS_PER_MM), left:] < DARK)
    box = (left + int(columns.min()), int(rows.min()), left + int(columns.max()) + 1, int(rows.max()) + 1)
    step = MODULE_MM * PIXELS_PER_MM
    middles = np.arange(step / 2.0, box[2] - box[0], step).astype(int)
    return page[np.ix_(box[3] - 1 - middles, box[0] + middles)] < DARK, box


@pytest.mark.parametrize("text", ["1a2b3c4d-P001", "unnamed-S1000", "x", "=cmd()", "17 signs in a row"])
def test_what_is_drawn_reads_as_the_text(text: str) -> None:
    assert read(drawn(code_of(text).content)) == text


def test_a_module_that_is_wrong_is_seen() -> None:
    modules = drawn(code_of("1a2b3c4d-P001").content)
    for place in [(0, 0), (6, 10), (8, 2), (12, 12), (20, 20)]:
        spoilt = modules.copy()
        spoilt[place] ^= True
        with pytest.raises(AssertionError):
            read(spoilt)
    assert not finder_like(modules[::-1])


def test_every_page_has_the_code_of_its_id(file: Path) -> None:
    pages = page_operators(file.read_bytes())
    assert len(pages) >= 3
    for page in pages:
        (told,) = [one for one in texts(page) if ID.fullmatch(one)]
        assert code_of(told).content in page


@needs_poppler
def test_the_code_that_is_printed_reads_as_the_id_beside_it(file: Path) -> None:
    for number in range(1, len(page_operators(file.read_bytes())) + 1):
        page = grey(file, number)
        modules, (left, low, right, high) = printed(page)
        (told,) = [word for word in words(file, number) if ID.fullmatch(word.text)]
        assert read(modules) == told.text
        assert (right - left) / PIXELS_PER_MM == pytest.approx(len(modules) * MODULE_MM, abs=0.11)
        free = round(QUIET_MM * PIXELS_PER_MM) - 1
        around = page[low - free : high + free, left - free : right + free].copy()
        around[free - 1 : 1 - free, free - 1 : 1 - free] = 255  # and the pixels that its rim only touches
        assert around.min() == 255, "four modules stay white all around"
