"""Every number that the page shows of a report is one of the report, to the digits that the page shows."""

import json
import re
from collections.abc import Callable, Iterator

import pytest

from pipeline.report.html import report_html
from tests.browser.chromium import WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.pages import HOSTILE, PLATE, REFUSED, part, report, stage, view
from tests.toldnumbers import distinct, foreign, told

pytestmark = needs_chromium
TAPE = {
    "spots": [{"letters": "A", "x": 1.0, "y": 2.0}, {"letters": "BC", "x": 3.0, "y": 4.0}],
    "spans": [
        {"from": "A", "to": "B", "what": "c0", "along_mm": 5.0, "straight_mm": 6.0, "evidence": "sampled"},
        {"from": "A", "to": "C", "what": "diagonal", "along_mm": None, "straight_mm": 7.0, "evidence": "sampled"},
    ],
}
FORMED = {"size_mm": [8.0, 9.0, 10.0], "evidence": "sampled"}
OWN = re.compile(r"planish-report/\d|\bplanish\s+\S+|3D|c[01]\b")
"""What the page says of itself, and names of edges."""


def shown(value: float) -> str:
    """Write a number as the page does: to five digits, whole ones in full."""
    return str(value) if isinstance(value, int) else f"{value:.5g}"


def percent(value: float) -> str:
    return f"{float(f'{100.0 * value:.3g}'):g}"


WAYS: tuple[Callable[[float], str], ...] = (shown, percent, "{:g}".format, lambda value: f"{value:.2f}", str)


def changed() -> dict[str, object]:
    """Return a report in which all numbers differ from those of the drawings."""
    told_of = report()
    parts = told_of["parts"]
    assert isinstance(parts, list)
    parts[1] |= {"tape": TAPE, "formed": FORMED}
    one = part("whole", [stage("verify", [])], "exact")
    made = distinct({**told_of, "parts": [*parts, one]})
    assert isinstance(made, dict)
    return made


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    file = tmp_path_factory.mktemp("page") / "report.html"
    file.write_bytes(report_html(changed(), view()))
    with opened(file, tmp_path_factory.mktemp("profile"), *WITHOUT_WEBGL) as browser:
        yield browser


def numbers(page: Page) -> list[str]:
    """Return the numbers of all that the page says, part by part."""
    texts = []
    for name in (PLATE, REFUSED, HOSTILE):
        page.ask(f"goTo(rowOf.get({json.dumps(name)}));new Promise((done) => setTimeout(done, 120))")
        texts.append(str(page.ask("document.body.innerText")))
    text = "\n".join(texts)
    for name in (HOSTILE.replace("\u2028", " "), HOSTILE):
        text = text.replace(name, " ")
    return told(OWN.sub(" ", re.sub(r"alert\(1\)", " ", text)).replace("\u00a0", " ").split("\n"))


def test_every_number_is_in_the_report(page: Page) -> None:
    found = numbers(page)
    assert len(found) > 30
    assert foreign(found, [changed(), view()], WAYS) == []


def test_a_number_that_is_not_in_the_report_is_seen(page: Page) -> None:
    lost = changed()
    assert isinstance(lost["parts"], list)
    along = shown(lost["parts"][1]["tape"]["spans"][0].pop("along_mm"))
    assert set(foreign(numbers(page), [lost, view()], WAYS)) == {along}
