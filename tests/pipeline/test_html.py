"""The page of a report as bytes: what is in it, and that every metric has its line."""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.report.html import data_block, part_texts, report_html, summary
from pipeline.report.meanings import MEANINGS
from tests.browser.pages import HOSTILE, PLATE, REFUSED, metric, report, view

ROOT = Path(__file__).parents[2]
MAKERS = {"Metric", "_at", "limit_metric", "_area"}
"""Calls that make a metric of a name."""
COUNTED = {
    "triangles", "vertices", "boundary_loops", "euler_characteristic", "vertices_merged", "vertices_welded",
    "faces_dropped", "slivers_resolved", "vertices_unused", "travel_mm", "travel_listed_mm", "half_width_max_mm",
    "width_left_max_mm", "width_right_max_mm", "tangent_norm_error", "normal_tangent_dot", "end_curvature_error",
    "zone_overlap_mm2",
}  # fmt: skip
"""Names that the code takes from a table of its own."""


def emitted() -> Iterator[str]:
    """Yield the names that calls in the code give to metrics."""
    for file in [*ROOT.glob("stages/**/*.py"), *ROOT.glob("pipeline/**/*.py")]:
        for call in ast.walk(ast.parse(file.read_text())):
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in MAKERS:
                for name in call.args[:2]:
                    if isinstance(name, ast.Constant) and isinstance(name.value, str) and len(name.value) > len("mm2"):
                        yield name.value


def test_every_metric_has_a_meaning() -> None:
    names = set(emitted()) | COUNTED
    assert {"max_strain", "min_gap_mm", "metric_error"} <= names
    assert names - set(MEANINGS) == set()


@pytest.mark.parametrize("name", sorted(MEANINGS))
def test_a_meaning_is_one_line(name: str) -> None:
    assert MEANINGS[name].endswith(".")
    assert "\n" not in MEANINGS[name]


def test_no_text_ends_the_data() -> None:
    block = data_block(report(), view(), part_texts(report(), view()))
    assert "<" not in block
    assert "\u2028" not in block
    rows = json.loads(block)["rows"]
    assert [row["name"] for row in rows] == [HOSTILE, PLATE, REFUSED]


def test_the_page_has_the_numbers_of_the_report() -> None:
    block = json.loads(data_block(report(), view(), part_texts(report(), view())))
    assert [json.loads(part)["report"] for part in block["parts"]] == report()["parts"]
    assert [json.loads(part)["view"] for part in block["parts"]] == view()["parts"]
    assert [row["failed"] for row in block["rows"]] == [0, 1, 1]


@pytest.mark.parametrize(
    ("metrics", "codes", "failed"),
    [
        (["max_warp_deg"], ["not-developable"], 1),
        (["outer_fibre_strain"], ["bend-radius", "bend-strain"], 2),
        (["outer_fibre_strain"], [], 1),
        (["overlap_mm2", "max_strain"], ["flat-overlap"], 2),
        ([], ["no-area", "no-area"], 2),
        ([], [], 0),
    ],
)
def test_what_failed_once_counts_once(metrics: list[str], codes: list[str], failed: int) -> None:
    """A number past its limit and the finding that tells of it in words are one reason, in one stage."""
    found = [{"code": code, "fatal": True} for code in codes] + [{"code": "note", "fatal": False}]
    stages = [
        {"metrics": [metric(name, 2.0, 1.0, passed=False) for name in metrics], "findings": found},
        {"metrics": [metric("max_warp_deg", 0.0, 1.0)], "findings": []},
    ]
    assert summary({"name": "a", "quantity": 1, "class": "rejected", "stages": stages})["failed"] == failed


def test_a_number_is_no_reason_less_for_a_finding_of_another_stage() -> None:
    stages = [
        {"metrics": [metric("max_strain", 2.0, 1.0, passed=False)], "findings": []},
        {"metrics": [], "findings": [{"code": "strain", "fatal": True}]},
    ]
    assert summary({"name": "a", "quantity": 1, "class": "rejected", "stages": stages})["failed"] == 2


def test_the_page_names_no_address_to_load_from() -> None:
    text = report_html(report(), view()).decode()
    assert "default-src 'none'" in text
    assert not re.search(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=[\"']?(?:https?:|//|[\w.]+\.(?:js|css))", text)


def test_the_same_report_gives_the_same_bytes() -> None:
    assert report_html(report(), view()) == report_html(report(), view())
