"""Every duct kind from a job file to its report: lengths, areas and seams against closed forms and 40 digits."""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from mpmath import cos, ellipe, mp, mpf, sin, sqrt, tan

from pipeline.cli import main
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.pipeline.jobs import write_job

CLOSE = 1e-11
"""Two quadratures of 1e-13, and as much again for the largest of the parts; asked for are 1e-10."""
TEES = {
    (angle, offset): f"""
[[part]]
name = "tee-{angle}-{offset}"
[part.surface]
kind = "tee"
branch = 120
main = 200
length = 420
angle = {angle}
offset = {offset}
hole = true
"""
    for angle, offset in ((30, 0), (45, 25), (60, -40), (75, 10), (90, 0), (90, 30))
}
ELBOW = """
[[part]]
name = "elbow"
[part.surface]
kind = "elbow"
diameter = 200
angle = 90
gores = 5
bend_radius = 300
"""
TRANSITION = """
[[part]]
name = "transition"
face = "{face}"
[part.surface]
kind = "transition"
rectangle = [400, 300]
round = 250
height = 350
offset = [50, -20]
tilt = 12
"""
CUT_CONE = """
[[part]]
name = "cone"
[part.surface]
kind = "cone"
radius0 = 120
radius1 = 60
height = 200
start_plane = { point = [0, 0, 20], normal = [0.25, 0, 1] }
end_plane = { point = [0, 0, 180], normal = [-0.4, 0, 1] }
"""
SADDLED = """
[[part]]
name = "pipe"
[part.surface]
kind = "cylinder"
directrix = { circle = { center = [0, 0, 0], radius = 40 } }
direction = [0, 0, 1]
length = 150
start_plane = { point = [0, 0, 0], normal = [0.3, 0, 1] }
saddle = { radius = 60, angle = 70 }
"""
SHEET = "[material]\nthickness = 1\n"


def job(*parts: str, sheet: str = "") -> str:
    return 'schema = 1\n[report]\nformats = ["json"]\n' + sheet + "".join(parts)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(tmp_path)
    yield


def made(text: str, code: int = 0) -> dict[str, dict[str, object]]:
    """Return the parts of the report that the command line writes, by name."""
    write_job(Path(), text)
    with pytest.raises(SystemExit) as caught:
        main(["run", "job.toml", "-o", "out", "--quiet"])
        raise SystemExit(0)
    assert int(caught.value.code or 0) == code
    report = json.loads(Path("out/report.json").read_text("utf-8"))
    return {part["name"]: part for part in report["parts"]}


def edges(part: dict[str, object], side: str = "flat") -> dict[str, float]:
    found = part[side]["edges"]  # type: ignore[index]
    assert isinstance(found, dict)
    return found


def area(part: dict[str, object], side: str = "flat") -> float:
    return float(part[side]["area"])  # type: ignore[index]


def findings(part: dict[str, object]) -> list[dict[str, object]]:
    return [finding for stage in part["stages"] for finding in stage["findings"]]  # type: ignore[attr-defined]


def metric(part: dict[str, object], name: str) -> float:
    rows = [row for stage in part["stages"] for row in stage["metrics"]]  # type: ignore[attr-defined]
    (row,) = [row for row in rows if row["name"] == name]
    return float(row["value"])


@cache
def branch(angle: int, offset: int) -> tuple[mpf, mpf, mpf]:
    """Return the length of the saddle, the area of the branch and the area of the main's opening."""
    r, rho, length, alpha, m = mpf(60), mpf(100), mpf(420), mp.radians(angle), mpf(offset)

    def at(a: mpf) -> tuple[mpf, mpf, mpf]:
        h = m + r * sin(a)
        z = sqrt(rho**2 - h**2)
        run = length - (r * cos(a) * cos(alpha) + z) / sin(alpha)
        return z, run, (r * sin(a) * cos(alpha) + h * r * cos(a) / z) / sin(alpha)

    turn = 2 * mp.pi
    saddle = oracles.Antiderivative(lambda v: turn * sqrt(r**2 + at(turn * v)[2] ** 2))(1)
    skin = oracles.Antiderivative(lambda v: turn * r * at(turn * v)[1])(1)
    hole = oracles.Antiderivative(lambda v: turn * rho * (r * cos(turn * v)) ** 2 / (at(turn * v)[0] * sin(alpha)))(1)
    return saddle, skin, hole


@pytest.mark.parametrize("case", TEES)
def test_tees_of_any_angle_and_offset_with_their_openings(case: tuple[int, int]) -> None:
    parts = made(job(TEES[case]))
    saddle, skin, hole = branch(*case)
    name = "tee-{}-{}".format(*case)
    pipe, opening = parts[f"{name}.1"], parts[f"{name}.2"]
    for side in ("flat", "surface"):
        assert_relative(edges(pipe, side)["c1"], float(saddle), bound=CLOSE, why="40 digits")
        assert_relative(edges(pipe, side)["c0"], float(120 * mp.pi), bound=CLOSE, why="circumference")
        assert_relative(area(pipe, side), float(skin), bound=CLOSE, why="40 digits")
        assert_relative(area(opening, side), float(hole), bound=CLOSE, why="40 digits")
    assert_relative(opening["flat"]["outline_length"], float(saddle), bound=CLOSE, why="one curve")  # type: ignore[index]
    assert_near(metric(opening, "seam_difference_mm"), 0.0, bound=CLOSE * 500.0, why="the same length twice")
    assert [mark["name"] for mark in opening["flat"]["marks"]] == ["main-axis", "branch-axis"]  # type: ignore[index]
    assert {pipe["class"], opening["class"]} == {"exact"}


@pytest.mark.parametrize(("face", "codes"), [("middle", set()), ("outer", {"seams-differ"})])
def test_the_opening_is_that_of_the_main_as_given_and_a_branch_of_another_face_differs(
    face: str, codes: set[str]
) -> None:
    text = TEES[60, -40].replace('"tee-60--40"', f'"tee"\nface = "{face}"')
    opening = made(job(text, sheet=SHEET))["tee.2"]
    assert {finding["code"] for finding in findings(opening)} == codes
    assert_relative(area(opening), float(branch(60, -40)[2]), bound=CLOSE, why="whatever the face")


def test_an_elbow_has_mitre_ellipses_and_seams_of_one_length() -> None:
    parts = made(job(ELBOW))
    mitre = mp.pi / 16
    ellipse = float(400 / cos(mitre) * ellipe(sin(mitre) ** 2))
    half = 200 * mp.pi * 300 * tan(mitre)
    assert list(parts) == [f"elbow.{n}" for n in range(1, 6)]
    for k, part in enumerate(parts.values()):
        ends = [200 * float(mp.pi) if k == 0 else ellipse, 200 * float(mp.pi) if k == 4 else ellipse]
        for side in ("flat", "surface"):
            assert_relative([edges(part, side)[key] for key in ("c0", "c1")], ends, bound=CLOSE, why="circle, ellipse")
            assert_relative(area(part, side), float(half if k in (0, 4) else 2 * half), bound=CLOSE, why="closed form")
        if k:
            assert_near(metric(part, "seam_difference_mm"), 0.0, bound=CLOSE * 640.0, why="the same length twice")


def test_a_cone_between_two_planes_has_two_ellipses() -> None:
    (part,) = made(job(CUT_CONE)).values()
    for key, height, slope in (("c0", 20, mpf("-0.25")), ("c1", 180, mpf("0.4"))):
        # z = height + slope x on x = +-(120 - 0.3 z)
        grow = mpf("0.3")
        ends = [sign * (120 - grow * height) / (1 + sign * grow * slope) for sign in (1, -1)]
        major, middle = (ends[0] - ends[1]) / 2 * sqrt(1 + slope**2), sum(ends) / 2
        minor = sqrt((120 - grow * (height + slope * middle)) ** 2 - middle**2)
        a, b = max(major, minor), min(major, minor)
        wanted = float(4 * a * ellipe(1 - (b / a) ** 2))
        for side in ("flat", "surface"):
            assert_relative(edges(part, side)[key], wanted, bound=CLOSE, why="complete elliptic integral")
    assert part["class"] == "exact"


def test_a_mitred_pipe_with_a_saddle_has_its_area_and_ellipse() -> None:
    (part,) = made(job(SADDLED)).values()
    r, rho, alpha = mpf(40), mpf(60), mp.radians(70)

    def run(v: mpf) -> mpf:
        a = 2 * mp.pi * v
        saddle = 150 - (r * cos(a) * cos(alpha) + sqrt(rho**2 - (r * sin(a)) ** 2)) / sin(alpha)
        return saddle + mpf("0.3") * r * cos(a)

    wanted = 2 * mp.pi * r * oracles.Antiderivative(run)(1)
    long = sqrt(1 + mpf("0.3") ** 2)
    for side in ("flat", "surface"):
        assert_relative(area(part, side), float(wanted), bound=CLOSE, why="40 digits")
        ellipse = float(4 * r * long * ellipe(1 - 1 / long**2))
        assert_relative(edges(part, side)["c0"], ellipse, bound=CLOSE, why="complete elliptic integral")


@pytest.mark.parametrize("face", ["middle", "inner", "outer"])
def test_a_transition_of_sheet_is_made_whatever_face_its_sizes_are_of(face: str) -> None:
    (part,) = made(job(TRANSITION.format(face=face), sheet=SHEET)).values()
    assert part["class"] == "exact"
    rectangle = edges(part)["c0"]
    codes = {finding["code"] for finding in findings(part)}
    assert ("apex-tapered" in codes) == (face == "outer")
    assert "k-default" not in codes
    if face == "inner":
        assert rectangle > 1400.0, "the corners open into arcs of half the thickness"
    else:
        assert_relative(rectangle, 1400.0, bound=CLOSE, why="2 (400 + 300)")
    if face == "middle":
        assert_relative(edges(part)["c1"], float(250 * mp.pi), bound=CLOSE, why="circumference")


@pytest.mark.parametrize(
    ("text", "code", "key"),
    [
        (TEES[90, 0].replace("branch = 120", "branch = 201"), "saddle-misses", "largest_branch_mm"),
        (TEES[90, 30].replace("offset = 30", "offset = 41"), "saddle-misses", "largest_offset_mm"),
        (TEES[90, 0].replace("length = 420", "length = 90"), "saddle-too-near", "least_length_mm"),
        (CUT_CONE.replace("normal = [-0.4, 0, 1]", "normal = [-4, 0, 1]"), "plane-misses", "past_parallel_deg"),
        (CUT_CONE.replace("[0, 0, 180]", "[0, 0, 50]"), "planes-cross", "length_mm"),
    ],
)
def test_what_cannot_be_made_exits_1_with_what_would_do(text: str, code: str, key: str) -> None:
    parts = made(job(text), code=1)
    fatal = [finding for part in parts.values() for finding in findings(part) if finding["fatal"]]
    assert {finding["code"] for finding in fatal} == {code}
    assert all(key in finding["where"] for finding in fatal)  # type: ignore[operator]
