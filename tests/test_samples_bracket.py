"""The bracket of samples/bracket: a bent sheet from a STEP file, against the bend allowances of its drawing."""

from math import log10, pi

import numpy as np
import pytest

from samples.bracket.drawn import FIXINGS, HOLES, LEFT, LENGTH, OUTSIDE, RIGHT, WIDTH
from tests.near import assert_near, assert_relative
from tests.samples import LAST_DIGITS, SAMPLES, figure, made, stage

THICKNESS = 2.0
INSIDE = OUTSIDE - THICKNESS
K = (0.65 + 0.5 * log10(INSIDE / THICKNESS)) / 2.0
"""DIN 6935."""
BEND = pi / 2.0 * (INSIDE + K * THICKNESS)
"""Bend allowance of a right angle."""
FLAT = LEFT - OUTSIDE + BEND + LENGTH - 2.0 * OUTSIDE + BEND + RIGHT - OUTSIDE
HOLE_AREA = sum(pi / 4.0 * diameter**2 for *_, diameter in HOLES)


@pytest.fixture(scope="module")
def bracket() -> dict:
    (part,) = made("bracket/job.toml").values()
    return part


def test_the_flat_is_as_long_as_its_legs_and_bend_allowances(bracket: dict) -> None:
    assert_relative([bracket["flat"]["width"], bracket["flat"]["height"]], [WIDTH, FLAT], bound=1e-9, why="closed form")
    area = WIDTH * FLAT - HOLE_AREA
    assert_relative(
        [bracket["flat"]["area"], bracket["surface"]["area"]], [area] * 2, bound=LAST_DIGITS * 100, why="same"
    )


def test_k_and_the_inside_radius_are_those_of_the_outer_face(bracket: dict) -> None:
    assert_near(figure(bracket, "unroll", "k_factor")["value"], K, bound=1e-12, why="DIN 6935 at r/t = 2")
    assert_near(
        abs(figure(bracket, "unroll", "neutral_offset_mm")["value"]), THICKNESS * (1.0 - K), bound=1e-12, why="K t"
    )
    assert_near(figure(bracket, "verify", "min_bend_radius_mm")["value"], INSIDE, bound=1e-9, why="the drawing")
    given = stage(bracket, "unroll")["detail"]["given"]["area"]
    drawn = WIDTH * (LEFT + RIGHT + LENGTH - 4.0 * OUTSIDE + pi * OUTSIDE) - HOLE_AREA
    assert_relative(given, drawn, bound=1e-10, why="area of the faces in the file")


def test_every_hole_is_cut_with_its_area(bracket: dict) -> None:
    areas = sorted(hole["area"] for hole in bracket["flat"]["holes"])
    wanted = sorted(pi / 4.0 * diameter**2 for *_, diameter in HOLES)
    assert_relative(areas, wanted, bound=1e-9, why="circles; the flanges and the base do not bend")


def test_the_fixings_keep_their_pattern_in_the_base(bracket: dict) -> None:
    places = [np.array([hole["x"], hole["y"]]) for hole in bracket["flat"]["holes"]
              if abs(hole["area"] - pi / 4.0 * 6.6**2) < 1e-6]  # fmt: skip
    found = sorted(float(np.linalg.norm(a - b)) for i, a in enumerate(places) for b in places[:i])
    drawn = [np.array(place) for place in FIXINGS]
    wanted = sorted(float(np.linalg.norm(a - b)) for i, a in enumerate(drawn) for b in drawn[:i])
    assert_near(found, wanted, bound=1e-9, why="the base is plane")


def test_there_is_one_bend_line_in_the_middle_of_each_bend(bracket: dict) -> None:
    rows = stage(bracket, "unroll")["detail"]["bends"]
    assert_near([abs(row["angle_deg"]) for row in rows], [90.0, 90.0], bound=1e-9, why="two right angles")


def test_the_file_is_small_and_of_the_script_beside_it() -> None:
    content = (SAMPLES / "bracket" / "bracket.step").read_text("ascii")
    assert len(content) < 100_000 and "MILLI" in content


def test_both_bends_are_alike_however_long_the_base_between_them_is(bracket: dict) -> None:
    rows = stage(bracket, "unroll")["detail"]["bends"]
    hits = [row for row in rows if row["name"].startswith("bend")]
    middle = INSIDE + THICKNESS / 2.0
    for row in hits:
        assert_near(
            row["facet_error_mm"], middle * (1.0 - np.cos(pi / 4.0)), bound=1e-6, why="rho (1 - cos(delta / 2))"
        )
    assert len(hits) == 2
