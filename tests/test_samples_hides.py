"""The sample of two sides of leather: every wish of a part about zones, direction and pairs is kept."""

from math import isclose

import pytest

from tests.samples import SHORT_SEARCH, run

COPIES = {"front": 4, "side": 4, "base": 2, "flap": 2, "handle": 4, "pocket": 2, "tab": 16}


@pytest.fixture(scope="module")
def report() -> dict:
    found, code, files = run("hides/job.toml", SHORT_SEARCH)
    assert (code, found["status"]) == (0, "made"), found["nest"]
    assert any(name.startswith("cut/") for name in files)
    return found


def placements(report: dict, part: str) -> list[dict]:
    return [placed for sheet in report["nest"]["sheets"] for placed in sheet["placements"] if placed["part"] == part]


def test_all_parts_lie_on_the_two_sides(report: dict) -> None:
    assert {part: len(placements(report, part)) for part in COPIES} == COPIES
    assert {sheet["stock"] for sheet in report["nest"]["sheets"]} <= {"left", "right"}
    assert {sheet["kind"] for sheet in report["nest"]["sheets"]} == {"hide"}
    assert sum(sheet["cost"] for sheet in report["nest"]["sheets"]) == 38.0 * len(report["nest"]["sheets"])


def test_every_second_side_is_turned_over_and_nothing_else(report: dict) -> None:
    for part in COPIES:
        for placed in placements(report, part):
            assert placed["mirrored"] == (part == "side" and placed["copy"] % 2 == 0)


def test_the_handles_lie_along_the_backbone_and_the_fronts_upright_on_it(report: dict) -> None:
    """Angles modulo 180 deg; the line of tightness runs along x, the handles' direction of stretch across them."""
    for part, along, band in (("handle", 0.0, 8.0), ("front", 90.0, 10.0)):
        for placed in placements(report, part):
            off = abs((placed["angle"] - along + 90.0) % 180.0 - 90.0)
            assert off < band or isclose(off, band, abs_tol=1e-6)


def test_gaps_and_zones_are_kept(report: dict) -> None:
    figures = {metric["name"]: metric["value"] for metric in report["nest"]["metrics"]}
    assert figures["overlap_mm2"] == 0.0
    assert figures["zone_overlap_mm2"] == 0.0
    assert figures["min_gap_mm"] >= 2.0 - 1e-6
    assert figures["min_edge_gap_mm"] >= 6.0 - 1e-6


def test_what_was_taken_smaller_than_drawn_is_said(report: dict) -> None:
    assert [note.split(":")[0] for note in report["job"]["notes"]] == ['stock "left"'] * 2
