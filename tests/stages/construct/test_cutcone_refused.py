"""Cones that planes cannot cut so: each refusal with its place and what would do, and errors of the job file."""

import numpy as np
import pytest

from tests.near import assert_near
from tests.parts import Table, passage, troubles
from tests.stages.construct.test_cutcone import FRUSTUM, HOPPER


def refusal(table: Table) -> dict[str, float | int | str]:
    (finding,) = passage(table).reports["construct"].findings
    assert finding.fatal and finding.where is not None
    return {"code": finding.code} | finding.where


def test_a_plane_steeper_than_the_rulings_is_refused_with_the_angle_that_it_is_off_by() -> None:
    # rulings lean by atan(1/3) from the axis: a plane of slope 4 leans by atan(1/4) from it
    found = refusal(FRUSTUM | {"end_plane": {"point": [0, 0, 150], "normal": [4, 0, 1]}})
    assert found["code"] == "plane-misses"
    wanted = float(np.degrees(np.arctan(1 / 3) - np.arctan(1 / 4)))
    assert_near(float(found["past_parallel_deg"]), wanted, bound=1e-9, why="difference of both angles")
    # narrowing towards +z, the rulings at -x lean towards +x
    assert_near(float(found["v"]) % 1.0, 0.0, bound=1e-6, why="where the ruling leans most along the normal")


def test_a_plane_parallel_to_one_ruling_is_refused() -> None:
    assert refusal(FRUSTUM | {"end_plane": {"point": [0, 0, 150], "normal": [3, 0, 1]}})["code"] == "plane-misses"


def test_planes_that_cross_on_the_cone_are_refused_with_the_overlap() -> None:
    table = FRUSTUM | {"start_plane": {"point": [0, 0, 50], "normal": [0, 0, 1]},
                       "end_plane": {"point": [0, 0, 60], "normal": ["0.5", 0, 1]}}  # fmt: skip
    found = refusal(table)
    assert (found["code"], found["piece"]) == ("planes-cross", 0)
    # at +x: x = 80 - z/3 and z = 60 - x/2: z = (60 - 40) / (1 - 1/6) = 24
    wanted = (24.0 - 50.0) * np.hypot(1.0, 1.0 / 3.0)
    assert_near(float(found["length_mm"]), wanted, bound=1e-9, why="closed form at the worst ruling")
    assert_near(float(found["v"]) % 1.0, 0.0, bound=1e-6, why="at +x")


def test_a_plane_that_cuts_the_other_end_is_refused() -> None:
    table = {key: value for key, value in FRUSTUM.items() if key != "start_plane"}
    assert refusal(table | {"end_plane": {"point": [0, 0, 10], "normal": ["0.3", 0, 1]}})["code"] == "planes-cross"


def test_planes_that_cross_just_where_two_pieces_meet_are_refused() -> None:
    lines = {"polyline": [[50, -50, 0], [50, 0, 0], [50, 50, 0]]}
    planes = [{"point": [0, 0, 20], "normal": [0, lean, 1]} for lean in (0, "-0.1")]
    table: Table = {"kind": "cone", "apex": [0, 0, 100], "directrix": lines}
    found = refusal(table | {"start_plane": planes[0], "end_plane": planes[1]})
    assert (found["code"], found["piece"], found["v"]) == ("planes-cross", 1, 1.0)


def test_ends_on_both_sides_of_the_apex_are_refused() -> None:
    assert refusal(FRUSTUM | {"end_plane": {"point": [0, 0, 300], "normal": [0, 0, 1]}})["code"] == "through-apex"


def test_an_apex_on_the_directrix_is_still_refused() -> None:
    table = HOPPER | {"apex": [90, 0, 10], "end_plane": {"point": [0, 0, -20], "normal": [0, 0, 1]}}
    assert refusal(table)["code"] == "apex-on-directrix"


def test_the_piece_of_a_chain_is_named() -> None:
    lines = [{"line": [[50, 0, 0], [50, 50, 0]]}, {"line": [[50, 50, 0], [-50, 50, 0]]}]
    table: Table = {"kind": "cone", "apex": [0, 0, 100], "directrix": {"chain": lines},
                    "end_plane": {"point": [0, 0, 20], "normal": ["2", 0, 1]}}  # fmt: skip
    assert refusal(table | {"end_plane": {"point": [30, 0, 20], "normal": ["-2.5", 0, 1]}})["piece"] == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"end_plane": {"point": [5, 0, 240], "normal": [0, 0, 1]}}, ["the plane passes through the apex"]),
        ({"end_plane": {"point": [10, 20, 10], "normal": ["-0.4", "0.2", -2]}}, ["the same plane as start_plane"]),
        (
            {"radius1": 80, "end_plane": {"point": [0, 0, 9], "normal": [1, 0, 0]}},
            ["the plane is parallel to the axis"],
        ),
    ],
)
def test_planes_that_cannot_be_are_errors_of_the_job_file(change: Table, message: list[str]) -> None:
    assert troubles(FRUSTUM | change) == message


def test_an_end_is_given_by_a_plane_or_by_a_fraction() -> None:
    assert troubles(HOPPER | {"fraction": [0, "0.5"]}) == ["beside end_plane"]
    assert troubles(HOPPER | {"fraction": ["0.2", 1]}) == []
    without = {key: value for key, value in HOPPER.items() if key != "end_plane"}
    assert troubles(without | {"start_plane": HOPPER["end_plane"], "fraction": ["0.2", 1]}) == ["beside start_plane"]


def test_a_plane_through_the_apex_of_a_directrix_is_an_error() -> None:
    plane = {"point": [30, 20, -250], "normal": [1, 2, 3]}
    assert troubles(HOPPER | {"end_plane": plane}) == ["the plane passes through the apex"]
