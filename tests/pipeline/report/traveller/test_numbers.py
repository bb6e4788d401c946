"""Every number on the pages of the traveller is one of the report, in one of the ways in which people read numbers."""

import json
import re
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import cast

import pytest

from pipeline.report.entries import MetricEntry
from pipeline.report.render import Made
from pipeline.report.shopentries import PartEntry
from pipeline.report.traveller.book import traveller_pdf
from pipeline.report.traveller.numbers import degrees, millimetres, plain
from pipeline.report.traveller.part import nearest
from tests.pdfs import all_texts
from tests.pipeline.jobs import CONE, STOCK
from tests.pipeline.report.traveller.test_book import PLATE, produced
from tests.toldnumbers import distinct, foreign, told

WITH_LINES = '[[part.bend]]\nmax_angle = 20\n[[part.mark]]\nkind = "rulings"\ncount = 3\n[part.surface]'
BENT = CONE.replace("[part.surface]", WITH_LINES)
OWN = (
    re.compile(r"[0-9a-f]{8}-[PS]\d{3}"),
    re.compile(r"page \d+ of \d+"),
    re.compile(r"100 mm on paper"),
    re.compile(r"[\d.]+ : [\d.]+"),
    re.compile(r"(?:bend|roll|mark|rulings|hole)-\d+"),
    re.compile(r"90\N{DEGREE SIGN} on this page"),
    re.compile(r"\w[\w-]*\.(?:dxf|json)"),
    re.compile(r"\b[A-Za-z]\w*\d\w*"),
    re.compile(r"\d+ in report"),
)
"""What pages say of themselves, and names: ids, scales, the check line, paper, files, metrics."""


def share(value: float) -> str:
    return f"{100.0 * value:.1f}"


WAYS: tuple[Callable[[float], str], ...] = (
    millimetres, degrees, plain, share, "{:g}".format, "{:.4g}".format, "{:.1f}".format, "{:.3f}".format,
    lambda value: f"{value / 1e6:.4f}", lambda value: f"{1000.0 * value:.3g}", str,
)  # fmt: skip


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return produced(tmp_path_factory.mktemp("job"), PLATE + BENT + STOCK)


def shown(report: Mapping[str, object], files: Mapping[str, bytes]) -> list[str]:
    """Return the numbers on the pages of a report, without what the pages say of themselves."""
    texts = " \n ".join(all_texts(traveller_pdf(Made(report, files))))
    for own in OWN:
        texts = own.sub(" ", texts)
    return told(texts.split("\n"))


def test_every_number_is_in_the_report(job: dict[str, bytes]) -> None:
    """None is computed from what is drawn: the report has others than the drawings."""
    report = distinct(json.loads(job["report.json"]))
    assert isinstance(report, dict)
    found = shown(report, job)
    assert len(found) > 100
    assert foreign(found, report, WAYS) == []


def test_a_number_that_is_not_in_the_report_is_seen(job: dict[str, bytes]) -> None:
    report = distinct(json.loads(job["report.json"]))
    assert isinstance(report, dict)
    found = shown(report, job)
    without = json.loads(json.dumps(report))
    (lost,) = (span for span in without["parts"][1]["tape"]["spans"] if span["what"] == "c0")
    written = millimetres(lost.pop("along_mm"))
    assert foreign(found, without, WAYS) == [written]


def test_checks_that_failed_come_first_then_those_nearest_to_their_limits_and_what_is_no_number_last() -> None:
    checks: dict[str, tuple[float | bool | None, float | bool, bool]] = {
        "nothing of it": (0.0, 1.0, True),
        "half": (0.5, 1.0, True),
        "a truth": (True, True, True),
        "most": (1.8, 2.0, True),
        "nothing allowed": (0.3, 0.0, True),
        "unknown": (None, 1.0, False),
        "beyond": (3.0, 2.0, False),
    }
    metrics = tuple(MetricEntry(name, value, "mm", "sampled", limit, ok) for name, (value, limit, ok) in checks.items())
    part = SimpleNamespace(stages=(SimpleNamespace(stage="unroll", metrics=metrics),))
    found = [metric.name for _, metric in nearest(cast("PartEntry", part))]
    assert found == ["beyond", "unknown", "most", "half", "nothing of it", "a truth", "nothing allowed"]
