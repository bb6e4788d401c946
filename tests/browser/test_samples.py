"""The page of every sample in chromium: all parts open, all sheets are drawn, nothing is told and nothing asked for.

Samples that take long to make are opened where benchmarks are run (`tests/bench/test_pages.py`).
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.outputs import outputs
from pipeline.report.html import report_html
from tests.browser.chromium import WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.everything import everything
from tests.browser.pages import PLATE, report, view, written
from tests.samples import SAMPLES, SHORT_SEARCH, result_of

pytestmark = needs_chromium
QUICK = (
    "bag/job.toml", "flanges/job.toml", "guard/job.toml", "paper/as-printed.toml", "paper/job.toml",
    "strakes/as-drawn.toml",
)  # fmt: skip
SLOW = sorted({f"{path.parent.name}/{path.name}" for path in SAMPLES.glob("*/*.toml")} - {*QUICK})


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    file = written(tmp_path_factory.mktemp("page"))
    with opened(file, tmp_path_factory.mktemp("profile"), *WITHOUT_WEBGL) as browser:
        yield browser


def sample_page(name: str, folder: Path) -> tuple[Path, int, int]:
    """Return the page of a sample as a file, and how many parts and sheets its report has."""
    made, files = outputs(result_of(name, SHORT_SEARCH, "report.formats=['json', 'html']"))
    file = folder / "report.html"
    file.write_bytes(files["report.html"])
    parts, nest = made["parts"], made["nest"]
    assert isinstance(parts, list)
    assert isinstance(nest, dict)
    return file, len(parts), len(nest["sheets"])


@pytest.mark.parametrize("name", QUICK)
def test_everything_of_a_sample_is_shown(page: Page, name: str, tmp_path: Path) -> None:
    file, parts, sheets = sample_page(name, tmp_path)
    page.open(file)
    assert everything(page) == (parts, sheets, [])


def test_a_part_that_cannot_be_drawn_is_seen(page: Page, tmp_path: Path) -> None:
    file, broken = tmp_path / "report.html", view()
    assert isinstance(broken["parts"], list)
    broken["parts"][1]["formed"] = {"kind": "ruled"}
    file.write_bytes(report_html(report(), broken))
    page.open(file)
    seen = everything(page, frames=40)
    assert f"{PLATE}: did not open" in seen.wrong
    assert any("Uncaught" in one for one in seen.wrong)
