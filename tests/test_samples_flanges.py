"""The sample whose drawings are ready for a cutter: contours offset, begun, led in and held, and counted as cut."""

from math import pi

import pytest

from tests.near import assert_near
from tests.samples import run

LEADS_MM, GAP_MM = pi + 1.0, 0.8
"""A quarter of radius 2 in and a line of 1 off each cut; a tab of 0.5 and the kerf of 0.3."""


@pytest.fixture(scope="module")
def report() -> dict:
    found, code, _ = run("flanges/job.toml", "nest.time_limit=0.2")
    assert (code, found["status"]) == (0, "made"), found
    return found


def test_every_cut_has_its_leads_and_every_outline_three_tabs(report: dict) -> None:
    told = {finding["code"]: finding["where"] for finding in report["write"]["findings"]}
    assert {"kerf-compensated", "start-points", "tabs", "leads"} <= set(told)
    assert "lead-left-out" not in told and "tab-left-out" not in told
    assert (told["tabs"]["tabs"], told["tabs"]["contours"], told["leads"]["leads"]) == (18, 6, 60)


def test_what_the_rings_take_is_a_closed_form(report: dict) -> None:
    ring = next(part for part in report["nest"]["cost"]["parts"] if part["part"] == "ring")
    contours = 2.0 * pi * (45.15 + 24.85)
    assert ring["pierces"] == 4 * (3 + 1)
    want = 4.0 * (contours - 3.0 * GAP_MM + 4.0 * LEADS_MM)
    assert_near(ring["cut_length_mm"], want, bound=1e-6, why="coordinates of a file rounded to 1e-10 mm")


def test_the_sheet_takes_what_its_parts_take(report: dict) -> None:
    (sheet,) = report["nest"]["sheets"]
    parts = report["nest"]["cost"]["parts"]
    assert sheet["pierces"] == sum(part["pierces"] for part in parts)
    long = sum(part["cut_length_mm"] for part in parts)
    assert_near(sheet["cut_length_mm"], long, bound=1e-6, why="no cut is shared")
