"""Paper, hopper, bag and guard run as they are; their reports hold the figures of closed forms and quadrature."""

from math import cos, hypot, pi, sin

import pytest

from tests.near import assert_near
from tests.samples import LAST_DIGITS, both_sides, figure, run


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


@pytest.fixture(scope="module")
def guard() -> dict:
    report, code, files = run("guard/job.toml")
    assert code == 0, report
    assert {name for name in files if name.startswith("flat/")} == {
        "flat/hood.dxf", "flat/collar.1.dxf", "flat/collar.2.dxf",
        "flat/hood.json", "flat/collar.1.json", "flat/collar.2.json",
    }  # fmt: skip
    return {part["name"]: part for part in report["parts"]}


def test_the_hood_bends_by_what_its_profile_turns(guard: dict) -> None:
    """From straight up to 45 deg downwards: 135 deg, in hits of at most 8."""
    detail = next(stage for stage in guard["hood"]["stages"] if stage["stage"] == "unroll")["detail"]
    hits = [row["angle_deg"] for row in detail["bends"]]
    assert_near([sum(hits)], [135.0], bound=1e-9, why="closed form")
    assert len(hits) == 17
    assert max(hits) - min(hits) < 1e-9
    assert detail["thickness"]["face"] == "outer"
    assert_near(detail["thickness"]["offsets"][0]["offset_mm"], 1.0, bound=1e-12, why="r/t is above 5: K = 1/2")


def test_the_hoods_straight_edge_is_that_of_its_middle_surface(guard: dict) -> None:
    """Square to the rulings, an edge is shorter on the middle surface by half the thickness times the turning."""
    detail = next(stage for stage in guard["hood"]["stages"] if stage["stage"] == "unroll")["detail"]
    given, flat = detail["given"]["edges"]["c0"], guard["hood"]["flat"]["edges"]["c0"]
    assert_near(given - flat, 1.0 * 0.75 * pi, bound=1e-10, why="135 deg of 1 mm")


def test_every_hole_of_the_hood_arrives_with_its_size(guard: dict) -> None:
    holes = {hole["name"]: hole for hole in guard["hood"]["flat"]["holes"]}
    assert set(holes) == {"fix-1", "fix-2", "fix-3", "fix-4", "window"}
    for number in range(1, 5):
        # a drill through a bent sheet leaves a little more than a circle, by (r / R)^2 / 8
        assert 1.0 <= holes[f"fix-{number}"]["area"] / (pi * 4.5**2) < 1.0 + (4.5 / 115.0) ** 2 / 4.0


def test_the_collar_is_cut_into_two_even_blanks(guard: dict) -> None:
    """Eight triangles of sides a, a, b from the apex (0, 0, 40), halved towards it: 3/4 of each is left."""
    a, a2, b = hypot(60, 40), hypot(32, 32, 10), hypot(28, 32, 30)
    s = (a + a2 + b) / 2.0
    triangle = (s * (s - a) * (s - a2) * (s - b)) ** 0.5
    for blank in ("collar.1", "collar.2"):
        assert_near(guard[blank]["flat"]["area"], 4 * 0.75 * triangle, bound=1e-9, why="closed form")
        assert guard[blank]["class"] == "exact"
