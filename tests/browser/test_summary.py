"""The summary of a batch in chromium: filter, sort, themes, names, narrow screens, and nothing asked for."""

from collections.abc import Iterator

import pytest

from pipeline.report.summary import summary
from tests.browser.chromium import Page, needs_chromium, opened
from tests.pipeline.test_summary import jobs

pytestmark = needs_chromium
NAMES = "[...document.querySelectorAll('#worst-parts tbody tr:not([hidden])')].map((r) => r.cells[0].textContent)"
SCREEN = {"height": 740, "deviceScaleFactor": 1, "mobile": True}


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    file = tmp_path_factory.mktemp("page") / "summary.html"
    file.write_bytes(summary(jobs(40)))
    with opened(file, tmp_path_factory.mktemp("profile")) as browser:
        yield browser


def test_it_says_how_many_were_made_and_lists_the_worst_first(page: Page) -> None:
    assert "30 of 40 jobs made" in str(page.ask("byId('verdict').textContent"))
    names = page.ask(NAMES)
    assert isinstance(names, list)
    assert names[:2] == ["j39", "j38"]
    assert len(names) == 30


def test_it_sorts_by_a_heading_and_filters(page: Page) -> None:
    page.ask("document.querySelector('#worst-parts th button').click()")
    assert page.ask(NAMES + ".slice(0, 3)") == ["j1", "j2", "j3"]
    assert page.ask("document.querySelector('#worst-parts th').ariaSort") == "ascending"
    page.ask("document.querySelectorAll('#worst-parts th button')[3].click()")
    page.ask("document.querySelectorAll('#worst-parts th button')[3].click()")
    assert page.ask(NAMES + "[0]") == "j39"
    find = "document.querySelector('input[data-table=worst-parts]')"
    page.ask(f"{find}.value = 'J21'; {find}.dispatchEvent(new Event('input'))")
    assert page.ask(NAMES) == ["j21"]
    assert page.ask(f"{find}.closest('.controls').querySelector('.count').textContent") == "1 of 30 listed"


def test_a_bar_is_as_high_as_its_share(page: Page) -> None:
    high = page.ask(
        "[...document.querySelectorAll('figure')[0].querySelectorAll('.mark rect')].map((r) => r.height.baseVal.value)"
    )
    assert isinstance(high, list)
    assert high[:4] == pytest.approx([0.0, 118.0, 118.0, 118.0])


def test_it_turns_dark_and_is_narrow(page: Page) -> None:
    was = page.ask("document.documentElement.dataset.theme")
    page.ask("byId('theme').click()")
    assert page.ask("document.documentElement.dataset.theme") != was
    page._ask("Emulation.setDeviceMetricsOverride", width=360, **SCREEN)
    assert page.ask("document.documentElement.scrollWidth") <= 360


def test_nothing_is_told_and_nothing_asked_for(page: Page) -> None:
    assert page.told == []
    assert page.requests == []
