"""A part on paper: the formed view is there as it stands, whatever draws it on the screen, and all of it is light.

The page is printed to PDF as chromium does it for a person, backgrounds left out, and its pages are read as pixels.
"""

import base64
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.browser.chromium import WITH_WEBGL, WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.linked import made
from tests.browser.test_linked import READY
from tests.poppler import colours, count, needs_poppler, words

pytestmark = [needs_chromium, needs_poppler]
BLUE = np.array([0, 114, 178])
"""Of the edge c0, which nothing else has where no strain is shown."""
NEAR = 12
"""Of 255, in each colour: what the middle of a line that is scaled may differ by."""
PART_PAGE = "2"
"""A part begins a page, behind the verdict and the table of parts."""
PLAIN = "current.flat.colourBy(null); current.solid.setField(null)"
KEY = "document.querySelectorAll('.solid canvas')[1].dispatchEvent(new KeyboardEvent('keydown', { key: '%s' }))"
SHOWN = f"""(async () => {{ const canvas = document.querySelector('.solid canvas'), {{ width, height }} = canvas;
  const pen = new OffscreenCanvas(width, height).getContext('2d', {{ willReadFrequently: true }});
  current.solid.resize();
  await new Promise(requestAnimationFrame);
  pen.drawImage(canvas, 0, 0);
  const {{ data }} = pen.getImageData(0, 0, width, height), box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < data.length; i += 4) {{
    if ({BLUE.tolist()}.some((tone, k) => Math.abs(tone - data[i + k]) > {NEAR}) || data[i + 3] < 200) continue;
    grow(box, (i / 4) % width, Math.floor(i / 4 / width));
  }}
  return box; }})()"""
AT_ONCE = """(() => { const before = document.documentElement.dataset.theme;
  showPart(0);
  const early = Boolean(current.solid);
  dispatchEvent(new Event('beforeprint'));
  const canvas = document.querySelector('.solid canvas'), pen = canvas.getContext('2d');
  const drawn = pen.getImageData(0, 0, canvas.width, canvas.height).data.some((one) => one > 0);
  const sharp = [canvas, current.flat.canvas].map((one) => one.width / one.clientWidth);
  const light = document.documentElement.dataset.theme;
  dispatchEvent(new Event('afterprint'));
  return { early, drawn, sharp, light, after: document.documentElement.dataset.theme === before,
           soft: current.flat.canvas.width / current.flat.canvas.clientWidth }; })()"""


@pytest.fixture(scope="module", params=[WITH_WEBGL, WITHOUT_WEBGL], ids=["webgl", "canvas"])
def page(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    file, _, _ = made(tmp_path_factory.mktemp("page"))
    with opened(file, tmp_path_factory.mktemp("profile"), *request.param, query="?view=webgl") as shown:
        shown.ask(READY)
        yield shown


def printed(page: Page, folder: Path, pages: str = "") -> Path:
    """Return what is printed, A4: all pages, or those of these numbers."""
    file = folder / "page.pdf"
    made = page._ask("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, pageRanges=pages)
    file.write_bytes(base64.b64decode(made["data"]))
    return file


def blue_box(file: Path) -> tuple[float, float]:
    """Return width and height, mm, of what is blue on a page."""
    rows, columns = np.nonzero(np.abs(colours(file, 1) - BLUE).max(axis=2) <= NEAR)
    return float(np.ptp(columns)) / 4.0, float(np.ptp(rows)) / 4.0


def on_screen(page: Page) -> float:
    """Return width over height of the edge c0 on the screen."""
    box = page.ask(SHOWN)
    assert isinstance(box, list)
    left, top, right, bottom = box
    return float((right - left) / (bottom - top))


def test_the_formed_part_is_printed_as_it_stands(page: Page, tmp_path: Path) -> None:
    page.ask(PLAIN)
    shapes = []
    for keys in ([], ["ArrowUp"] * 4):
        for key in keys:
            page.ask(KEY % key)
        wide, high = blue_box(printed(page, tmp_path, PART_PAGE))
        shapes.append(on_screen(page))
        assert wide > 20.0, "mm: it is no smaller than a stamp"
        assert wide / high == pytest.approx(shapes[-1], rel=0.05)
    assert abs(shapes[1] / shapes[0] - 1.0) > 0.2


def test_what_is_there_to_be_pressed_is_not_printed(page: Page, tmp_path: Path) -> None:
    file = printed(page, tmp_path)
    told = {word.text for number in range(1, count(file) + 1) for word in words(file, number)}
    assert {"frustum", "Metric"} <= told
    assert not {"reset", "Fit", "Rulings"} & told


def test_a_part_that_was_opened_just_now_is_printed_whole(page: Page) -> None:
    page.ask("setTheme('dark')")
    found = page.ask(AT_ONCE)
    assert found == {"early": False, "drawn": True, "sharp": [3, 3], "light": "light", "after": True, "soft": 1}
    page.ask("setTheme('light')")


def test_the_screen_is_as_before(page: Page, tmp_path: Path) -> None:
    page.ask(READY)
    page.ask("window.before = document.querySelector('.solid canvas')")
    printed(page, tmp_path)
    assert page.ask("document.querySelector('.solid canvas') === window.before")
    assert page.ask("document.querySelectorAll('.solid canvas').length") == 2
    assert page.told == []
    assert page.requests == []
