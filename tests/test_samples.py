"""Every sample runs as it is, and its report holds the figures that closed forms and 30-digit quadrature give."""

import json
from math import cos, hypot, pi, sin
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from tests.near import assert_near

SAMPLES = Path(__file__).parent.parent / "samples"
LAST_DIGITS = 1e-12
"""What the program promises for lengths and areas, relative."""


def run(name: str) -> tuple[dict, int, dict[str, bytes]]:
    result = run_job(job_of(read(SAMPLES / name, ["report.formats=['json']"])))
    report, files = outputs(result)
    return json.loads(json.dumps(report)), result.exit_code, files


@pytest.fixture(scope="module")
def paper() -> dict[str, dict]:
    report, code, files = run("paper/job.toml")
    assert code == 0, report
    assert report["status"] == "made"
    assert any(name.startswith("cut/") for name in files)
    return {part["name"]: part for part in report["parts"]}


@pytest.fixture(scope="module")
def hopper() -> dict:
    report, code, _ = run("hopper/job.toml")
    assert code == 0, report
    return report


def figure(part: dict, stage: str, name: str) -> dict:
    metrics = next(entry for entry in part["stages"] if entry["stage"] == stage)["metrics"]
    return next(metric for metric in metrics if metric["name"] == name)


def both_sides(part: dict, key: str) -> list[float]:
    """The surface's and the flat pattern's figure, which are measured separately."""
    if key == "area":
        return [part["surface"]["area"], part["flat"]["area"]]
    return [part["surface"]["edges"][key], part["flat"]["edges"][key]]


PAPER_FIGURES = [
    ("example-1", "area", 299.0982744480111),
    ("example-1", "c0", 78.21368602419299),
    ("example-1", "c1", 78.27151246658052),
    ("example-2", "area", 29.12631958208397),
    ("example-2", "c0", 4.808642122342346),
    ("example-2", "c1", 6.370289698009902),
    ("example-2", "start", 4.0),
    ("example-2", "end", 8.0),
]
"""30-digit quadrature of the paper's formulas, rounded to double."""


@pytest.mark.parametrize(("name", "key", "value"), PAPER_FIGURES)
def test_the_papers_examples_have_their_lengths_and_areas(
    paper: dict[str, dict], name: str, key: str, value: float
) -> None:
    for reached in both_sides(paper[name], key):
        assert_near(reached, value, bound=LAST_DIGITS * value, why="30-digit quadrature")


def test_every_example_of_the_paper_is_proved_developable(paper: dict[str, dict]) -> None:
    for part in paper.values():
        assert part["class"] == "exact"
        for name in ("max_warp_deg", "max_gaussian_curvature"):
            metric = figure(part, "verify", name)
            assert (metric["value"], metric["evidence"]) == (0.0, "proved"), (part["name"], metric)


def test_example_1_is_called_planar(paper: dict[str, dict]) -> None:
    assert figure(paper["example-1"], "construct", "planar")["value"] is True
    assert figure(paper["example-2"], "construct", "planar")["value"] is False


def test_example_3_reaches_the_minimax(paper: dict[str, dict]) -> None:
    speed = figure(paper["example-3"], "construct", "speed_max")["value"]
    assert 0.698368026963404 - 1e-12 <= speed <= 0.698368026963404 + 1e-9


def test_example_4_joins_with_equal_curvature(paper: dict[str, dict]) -> None:
    for name in ("join_gap_mm", "join_curvature_jump"):
        assert abs(figure(paper["example-4"], "construct", name)["value"]) <= 1e-12, name


def test_example_2_as_printed_is_rejected_with_place_and_amount() -> None:
    report, code, files = run("paper/as-printed.toml")
    assert (code, report["status"]) == (1, "rejected")
    assert not [name for name in files if name.startswith("cut/")]
    (part,) = report["parts"]
    metric = figure(part, "verify", "max_warp_deg")
    # the bound is proved, so it lies above the true maximum, by no more than 1e-9 of it
    assert 3.2849872165410022977 <= metric["value"] <= 3.2849872165410022977 * (1 + 1e-9)
    assert (metric["evidence"], metric["pass"], part["class"]) == ("proved", False, "rejected")
    assert_near(metric["where"]["v"], 0.206364358832, bound=1e-6, why="place of a smooth maximum: sqrt of rounding")


def test_the_hoppers_blanks_have_their_closed_forms(hopper: dict) -> None:
    parts = {part["name"]: part for part in hopper["parts"]}
    slant = hypot(450.0, 275.0)
    expected = {
        ("hopper-cone", "area"): pi / 2 * (400.0 + 125.0) * slant,
        ("hopper-cone", "c0"): pi * 400.0,
        ("hopper-cone", "c1"): pi * 125.0,
        ("hopper-cone", "start"): slant,
        ("pipe-straight", "area"): 2 * pi * 100.0 * 400.0,
        ("pipe-mitred", "area"): 2 * pi * 100.0 * 260.0,
        ("pipe-mitred", "c0"): 2 * pi * 100.0,
    }
    for (name, key), value in expected.items():
        for reached in both_sides(parts[name], key):
            assert_near(reached, value, bound=LAST_DIGITS * value, why="closed form")
    ring = pi * (150.0**2 - 101.0**2 - 6 * 5.5**2)
    assert_near(parts["flange"]["flat"]["area"], ring, bound=LAST_DIGITS * ring, why="closed form")


def test_the_hoppers_mass_follows_from_area_thickness_and_density(hopper: dict) -> None:
    for part in hopper["parts"]:
        assert_near(part["mass_kg"], part["flat"]["area"] * 2.0 * 7850e-9, bound=1e-9, why="area x t x density")


def corners_on_sheet(part: dict, placement: dict) -> list[tuple[float, float]]:
    """Corners of a part's box on the sheet, by the contract's words: mirrored, turned, moved."""
    angle, sign = placement["angle"] * pi / 180.0, -1.0 if placement["mirrored"] else 1.0
    turned = []
    for x, y in part["flat"]["corners"]:
        u = sign * x
        x_sheet = u * cos(angle) - y * sin(angle) + placement["x"]
        turned.append((x_sheet, u * sin(angle) + y * cos(angle) + placement["y"]))
    return turned


def test_the_hoppers_copies_all_lie_on_their_sheets(hopper: dict) -> None:
    parts = {part["name"]: part for part in hopper["parts"]}
    placed = [(p["part"], p["copy"]) for sheet in hopper["nest"]["sheets"] for p in sheet["placements"]]
    assert sorted(placed) == sorted((name, i + 1) for name, part in parts.items() for i in range(part["quantity"]))
    for sheet in hopper["nest"]["sheets"]:
        for placement in sheet["placements"]:
            part = parts[placement["part"]]
            if part["flat"]["edges"] is not None:  # the corners of a strip lie on its contour
                for x, y in corners_on_sheet(part, placement):
                    assert 10 - 1e-6 <= x <= 2440 - 10 + 1e-6, placement
                    assert 10 - 1e-6 <= y <= 1220 - 10 + 1e-6, placement


def test_the_bag_is_exact_and_fits_one_side_without_the_engine() -> None:
    first, code, files = run("bag/job.toml")
    again, _, files_again = run("bag/job.toml")
    assert (code, first["status"], len(first["nest"]["sheets"])) == (0, "made", 1)
    assert {part["class"] for part in first["parts"]} == {"exact"}
    assert _but_run(first) == _but_run(again)
    assert {name: content for name, content in files.items() if name.endswith(".dxf")} == {
        name: content for name, content in files_again.items() if name.endswith(".dxf")
    }


def _but_run(report: dict) -> dict:
    return {key: value for key, value in report.items() if key != "run"}
