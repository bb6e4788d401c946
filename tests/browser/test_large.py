"""The page of a large report: parts in files beside it, loaded as scripts from a disk; one that is missing is told."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.report.document import Document
from pipeline.report.html import MOST_INSIDE, PAGE, PER_FILE, report_pages
from pipeline.store import write_files
from tests.browser.chromium import WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.pages import HOSTILE, part, report, stage, view

pytestmark = needs_chromium
COUNT = MOST_INSIDE + 2 * PER_FILE + 1
SLOW_MS = 2000.0
"""What a page may take to be ready and a part to open on a machine that is busy with other things."""


def large() -> tuple[Document, Document]:
    """Return a report of many parts, each with what is drawn of it; the last has a name that is markup."""
    told, drawn = report(), view()
    assert isinstance(drawn["parts"], list)
    flat = drawn["parts"][1]["flat"]
    names = [f"part {number}" for number in range(COUNT - 1)] + [HOSTILE]
    parts = [part(name, [stage("unroll", [])], "exact") for name in names]
    place = {"copy": 1, "x": 10.0, "y": 10.0, "angle": 0.0, "mirrored": False}
    sheet = {**told["nest"]["sheets"][0], "placements": [{**place, "part": HOSTILE}]}  # type: ignore[index]
    told |= {"parts": parts, "nest": {**told["nest"], "sheets": [sheet]}}  # type: ignore[dict-item]
    return told, {**drawn, "parts": [{"name": name, "flat": flat, "formed": None} for name in names]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("large")
    write_files(made, report_pages(*large()))
    return made


@pytest.fixture(scope="module")
def page(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with opened(folder / PAGE, tmp_path_factory.mktemp("profile"), *WITHOUT_WEBGL) as browser:
        yield browser


def opened_part(page: Page, index: int) -> str:
    """Open a part, and return its title when it is there."""
    look = f"current?.index === {index} ? done(byId('part-title').textContent) : setTimeout(look, 5)"
    return str(page.ask(f"goTo({index}); new Promise((done) => {{ const look = () => {look}; look(); }})"))


def test_the_page_holds_no_part_and_asks_for_the_file_of_the_one_that_is_open(page: Page) -> None:
    assert page.ask("report.rows.length") == COUNT
    assert opened_part(page, 0) == "part 0"
    assert page.ask("Object.keys(report.parts).length") == PER_FILE
    assert [one.rpartition("/")[2] for one in page.requests] == ["parts-0.js"]
    assert page.told == []


def test_a_part_of_another_file_opens_and_its_name_stays_text(page: Page) -> None:
    assert opened_part(page, COUNT - 1) == HOSTILE
    assert page.ask("document.title").startswith("<script>")  # type: ignore[union-attr]
    assert page.ask("document.querySelectorAll('img').length") == 0
    assert page.told == []
    assert all(one.startswith("file://") for one in page.requests)


def test_a_part_is_there_soon(page: Page) -> None:
    for index in (1, PER_FILE + 1, MOST_INSIDE):
        before = page.ask("performance.now()")
        opened_part(page, index)
        after = page.ask("performance.now()")
        assert isinstance(before, float | int)
        assert isinstance(after, float | int)
        assert after - before < SLOW_MS


def test_a_sheet_draws_the_parts_of_a_file_that_was_not_loaded(folder: Path, tmp_path: Path) -> None:
    with opened(folder / PAGE, tmp_path, *WITHOUT_WEBGL) as page:
        copies = page.ask(
            "byId('sheet-list').scrollIntoView(); new Promise((done) => { const look = () => { const box ="
            " document.querySelector('.sheet'); box.drawing"
            " ? done(box.drawing.copies.map((one) => one.contours.length)) : setTimeout(look, 5); }; look(); })"
        )
        assert copies == [1]


def test_a_file_that_is_missing_is_told(folder: Path, tmp_path: Path) -> None:
    copied = tmp_path / "moved"
    write_files(copied, {PAGE: (folder / PAGE).read_bytes()})
    with opened(copied / PAGE, tmp_path / "profile", *WITHOUT_WEBGL) as page:
        told = page.ask(
            "new Promise((done) => { const look = () => document.querySelector('#part .fail') ?"
            " done(byId('part').textContent) : setTimeout(look, 5); look(); })"
        )
        assert told == "report/parts-0.js is missing beside this page"


def test_a_smaller_report_is_one_file(tmp_path: Path) -> None:
    told, drawn = report(), view()
    assert [*report_pages(told, drawn)] == [PAGE]
    made = report_pages(told, drawn, most=2)
    assert [*made] == [PAGE, "report/parts-0.js"]
    block = made["report/parts-0.js"].decode()
    assert "<" not in block
    first, texts = json.loads(f"[{block.removeprefix('planishParts(').removesuffix(');' + chr(10))}]")
    assert first == 0
    assert [json.loads(text)["report"]["name"] for text in texts] == [one["name"] for one in told["parts"]]  # type: ignore[attr-defined]
