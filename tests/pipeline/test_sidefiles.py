"""Side files: bend table, rolls, placements and contours against the drawing beside them or a closed form."""

import copy
import json
from functools import cache
from hashlib import sha256
from io import StringIO
from math import pi, radians
from pathlib import Path
from tempfile import TemporaryDirectory

import ezdxf
import jsonschema
import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from pipeline.sidefiles import side_schema
from stages.geometry.arrays import Array
from tests.near import assert_near, assert_relative
from tests.pipeline.jobs import PLATE, STOCK, write_job
from tests.stages.write.pictures import svg_shapes

Doc = dict[str, list[dict[str, object]]]
JOB = """\
schema = 1
[job]
name = "bent"
revision = "B"
[material]
name = "mild steel"
thickness = 2
k_factor = 0.4
[report]
formats = ["json"]
[nest]
gap = 4
rotations = [0, 90, 37]
{nest}
[dxf]
also = ["svg"]
{dxf}
[[stock]]
id = "S/1"
width = 900
height = 330
[[part]]
name = "cone <b>"
quantity = 2
{part}
[part.surface]
kind = "cone"
radius0 = 100
radius1 = 60
height = 80
sweep = 180
[[part.bend]]
max_angle = 30
[[part.hole]]
name = "window"
kind = "circle"
at = ["0.5", "0.5"]
diameter = 30
[[part]]
name = "shell"
[part.surface]
kind = "cylinder"
directrix = {{ arc = {{ center = [0, 0, 0], radius = 50, normal = [0, 0, 1], start = 0, end = 90 }} }}
direction = [0, 0, 1]
length = 120
[[part.bend]]
max_angle = 10
"""


@cache
def made(nest: str = "", dxf: str = "", part: str = "") -> dict[str, bytes]:
    with TemporaryDirectory() as folder:
        result = run_job(job_of(read(write_job(Path(folder), JOB.format(nest=nest, dxf=dxf, part=part)))))
    assert result.status == "made", result.nest.report.findings
    return outputs(result)[1]


WAYS = {
    "sheet": {},
    "part, lines and arcs": {"dxf": 'one_file_per = "part"\nflavour = "lines-arcs"\nlayers = "inventor"'},
    "material": {"dxf": 'one_file_per = "material"'},
    "turned over": {"nest": "mirror = true"},
    "pairs": {"part": "pair = true"},
}


def sides(files: dict[str, bytes]) -> dict[str, Doc]:
    return {path: json.loads(content) for path, content in files.items() if "/" in path and path.endswith(".json")}


@pytest.mark.parametrize("way", WAYS)
def test_every_drawing_has_one_and_it_keeps_the_schema(way: str) -> None:
    files = made(**WAYS[way])
    assert {path.rpartition(".")[0] for path in sides(files)} == {
        path.rpartition(".")[0] for path in files if path.startswith(("cut/", "flat/"))
    }
    validator = jsonschema.Draft202012Validator(json.loads(side_schema()))
    for side in sides(files).values():
        validator.validate(side)


@pytest.mark.parametrize("fault", ["no angle", "a word", "another layer", "a point in space", "another schema"])
def test_the_schema_refuses_what_is_none(fault: str) -> None:
    side = copy.deepcopy(sides(made())["flat/shell.json"])
    bend = side["bends"][0]
    if fault == "no angle":
        del bend["angle_deg"]
    elif fault == "a word":
        bend["angle_deg"] = "9"
    elif fault == "another layer":
        bend["layer"] = "BEND"
    elif fault == "a point in space":
        bend["ends"] = [[0, 0, 0], [1, 0, 0]]
    else:
        side["schema"] = "planish-cut/2"  # type: ignore[assignment]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft202012Validator(json.loads(side_schema())).validate(side)


def bend_lines(text: bytes, names: dict[str, object]) -> list[tuple[str, Array]]:
    """Return the lines on the layers of bends in a DXF file, in its order: what the layer means, and both ends."""
    meanings = {str(layer["name"]): meaning for meaning, layer in names.items() if meaning.startswith("BEND")}  # type: ignore[index]
    space = ezdxf.read(StringIO(text.decode())).modelspace()  # type: ignore[attr-defined]
    lines = [entity for entity in space if entity.dxf.layer in meanings]
    return [(meanings[e.dxf.layer], np.array([e.dxf.start.vec2, e.dxf.end.vec2])) for e in lines]  # type: ignore[index]


@pytest.mark.parametrize("way", WAYS)
def test_bends_lie_where_the_drawing_has_them(way: str) -> None:
    files = made(**WAYS[way])
    for path, side in sides(files).items():
        names = side["layers"]
        drawn = bend_lines(files[path.replace(".json", ".dxf")], names)  # type: ignore[arg-type]
        told = [(str(bend["layer"]), ends) for bend in side["bends"] for ends in bend["pieces_in_drawing"]]  # type: ignore[attr-defined]
        assert [layer for layer, _ in told] == [layer for layer, _ in drawn]
        pairs = [(np.array(one), other) for (_, one), (_, other) in zip(told, drawn, strict=True)]
        # a mirror turns a path round; the table goes on from c0 to c1
        alike = [
            other if np.abs(one - other).max() < np.abs(one - other[::-1]).max() else other[::-1]
            for one, other in pairs
        ]
        assert_near([one for one, _ in pairs], alike, bound=1e-9, why="ten decimals")


@pytest.mark.parametrize("way", WAYS)
def test_contours_have_the_areas_and_lengths_of_the_picture(way: str) -> None:
    files = made(**WAYS[way])
    for path, side in sides(files).items():
        shapes = svg_shapes(files[path.replace(".json", ".svg")].decode())
        cut = [shape for shape in shapes if shape.about["data-kind"].startswith("CUT")]
        rows = side["contours"]
        assert [row["layer"] for row in rows] == [shape.about["data-kind"] for shape in cut]
        assert_relative(
            [row["area_mm2"] for row in rows], [abs(shape.area) for shape in cut], bound=1e-9, why="rounding"
        )
        assert_relative([row["length_mm"] for row in rows], [shape.length for shape in cut], bound=1e-9, why="rounding")
        lengths = {name: sum(s.length for s in shapes if s.about["data-kind"] == name) for name in side["layers"]}
        for name, layer in side["layers"].items():  # type: ignore[attr-defined]
            assert_near(layer["length_mm"], lengths[name], bound=1e-9 * (1.0 + lengths[name]), why="rounding")


@pytest.mark.parametrize("way", ["sheet", "material", "turned over", "pairs"])
def test_the_matrix_takes_the_flat_frame_to_the_drawing(way: str) -> None:
    files = made(**WAYS[way])
    told = sides(files)
    flat = {str(side["contours"][0]["part"]): path for path, side in told.items() if path.startswith("flat/")}
    for path, side in ((path, side) for path, side in told.items() if path.startswith("cut/")):
        shapes = svg_shapes(files[path.replace(".json", ".svg")].decode())
        for placed in side["placements"]:
            rows = np.array(placed["matrix"])
            own = svg_shapes(files[flat[str(placed["part"])].replace(".json", ".svg")].decode())
            points = next(shape for shape in own if shape.about["data-kind"] == "CUT_OUTER").points
            moved = points @ rows[:, :2].T + rows[:, 2]
            (there,) = (
                shape.points for shape in shapes
                if shape.about["data-kind"] == "CUT_OUTER"
                and (shape.about["data-part"], shape.about["data-copy"]) == (placed["drawn_as"], str(placed["copy"]))
            )  # fmt: skip
            low_high = [(p.min(axis=0), p.max(axis=0)) for p in (moved, there)]
            assert_near(low_high[0], low_high[1], bound=0.05, why="64 points on an arc, begun elsewhere if mirrored")
            assert np.linalg.det(rows[:, :2]) * (-1.0 if placed["mirrored"] else 1.0) == pytest.approx(1.0)


def test_what_is_turned_over_bends_the_other_way_and_mirror_images_do_not() -> None:
    def layers(way: str) -> set[tuple[object, object, object]]:
        told = sides(made(**WAYS[way]))
        side = next(side for path, side in told.items() if path.startswith("cut/"))
        over = {(placed["part"], placed["copy"]): placed["turned_over"] for placed in side["placements"]}
        return {(over[bend["part"], bend["copy"]], bend["side"], bend["layer"]) for bend in side["bends"]}

    assert layers("turned over") <= {(False, "up", "BEND_UP"), (True, "up", "BEND_DOWN")}
    assert layers("pairs") == {(False, "up", "BEND_UP")}
    placed = next(side for path, side in sides(made(**WAYS["pairs"])).items() if path.startswith("cut/"))["placements"]
    assert {one["mirrored"] for one in placed} == {True, False}


def test_the_bends_of_a_shell_have_closed_forms() -> None:
    """A quarter pipe of radius 50 in nine steps of 10 deg: inside 49, neutral 49.8, each takes theta (49 + 0.8)."""
    bends = sides(made())["flat/shell.json"]["bends"]
    assert [bend["order"] for bend in bends] == list(range(1, 10))
    taken = radians(10.0) * 49.8
    assert_relative([bend["angle_deg"] for bend in bends], np.full(9, 10.0), bound=1e-12, why="closed form")
    assert_relative([bend["radius_mm"] for bend in bends], np.full((9, 2), 49.0), bound=1e-12, why="closed form")
    assert_relative([bend["allowance_mm"] for bend in bends], np.full((9, 2), taken), bound=1e-12, why="closed form")
    assert_relative([bend["pitch_mm"] for bend in bends[:-1]], np.full((8, 2), taken), bound=1e-12, why="alike")
    assert bends[-1]["pitch_mm"] is None
    assert {bend["k_factor"] for bend in bends} == {0.4}
    heights = np.array([bend["ends"] for bend in bends])[:, :, 1]
    wanted = np.repeat(taken * (np.arange(9) + 0.5)[:, None], 2, axis=1)
    assert_near(np.abs(heights), wanted, bound=1e-9, why="in the middle of each step, along the neutral arc")


def test_the_rolls_lie_on_their_rulings() -> None:
    """On the sector of the cone every ruling points at the apex; angles between them are those of the distances."""
    rolls = sides(made())["flat/cone-b.json"]["rolls"]
    ends = np.array([roll["ends"] for roll in rolls])
    slant = np.hypot(40.0, 80.0)
    along = ends[:, 1] - ends[:, 0]
    assert_relative(np.hypot(*along.T), np.full(len(rolls), slant), bound=1e-9, why="rulings of one length")
    assert all(side["rolls"] is None for path, side in sides(made()).items() if path.startswith("cut/"))
    turn = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    assert_relative(
        abs(turn[-1] - turn[0]), pi * 40.0 / slant, bound=1e-9, why="half a turn times the sine of the cone"
    )
    at = np.array([roll["distance_mm"] for roll in rolls])
    assert_near((at - at[0]) / (at[-1] - at[0]), (turn - turn[0]) / (turn[-1] - turn[0]), bound=1e-9, why="one cone")


def test_it_says_which_files_it_is_of() -> None:
    files = made()
    for path, side in sides(files).items():
        stem = path.removesuffix(".json")
        assert [file["path"] for file in side["files"]] == [f"{stem}.dxf", f"{stem}.svg"]
        assert [file["sha256"] for file in side["files"]] == [
            sha256(files[str(file["path"])]).hexdigest() for file in side["files"]
        ]


def test_names_are_those_of_the_job_and_those_of_the_drawing() -> None:
    side = next(side for path, side in sides(made()).items() if path.startswith("cut/"))
    assert {(one["part"], one["drawn_as"]) for one in side["placements"]} == {
        ("cone <b>", "cone-b"),
        ("shell", "shell"),
    }
    assert {one["stock"] for one in side["sheets"]} == {"S/1"}
    assert {row["part"] for row in side["contours"]} == {"cone <b>", "shell"}
    assert {row["name"] for row in side["contours"] if row["layer"] == "CUT_INNER"} == {"window"}


def test_cuts_that_parts_share_belong_to_none(tmp_path: Path) -> None:
    extra = "[process]\nkerf = 0.2\n[nest]\ncommon_line = true\ngap = 0.2\nrotations = [0]\n"
    text = PLATE.replace('"plate"', '"plate"\nquantity = 2') + STOCK + extra
    result = run_job(job_of(read(write_job(tmp_path, text))))
    assert result.status == "made"
    side = sides(outputs(result)[1])["cut/sheet-1.json"]
    shared = [row for row in side["contours"] if row["part"] is None]
    assert len(shared) >= 1
    assert {row["area_mm2"] for row in shared} == {None}
    assert {(row["part"], row["copy"]) for row in side["contours"]} == {("plate", 1), ("plate", 2), (None, None)}


def test_a_part_that_does_not_bend_has_empty_tables(tmp_path: Path) -> None:
    side = sides(outputs(run_job(job_of(read(write_job(tmp_path)))))[1])["flat/plate.json"]
    assert (side["bends"], side["rolls"], side["frame"], side["placements"]) == ([], [], "flat", [])


PIECES = """\
[dxf]
flavour = "aama"
"""


def test_a_pattern_file_has_one_too(tmp_path: Path) -> None:
    produced = outputs(run_job(job_of(read(write_job(tmp_path, PLATE + STOCK + PIECES)))))[1]
    found = sides(produced)
    assert {"flat/plate.json", "cut/sheet-1.json"} == set(found)
    for side in found.values():
        jsonschema.Draft202012Validator(json.loads(side_schema())).validate(side)
        assert [(row["part"], row["area_mm2"], row["length_mm"]) for row in side["contours"]] == [("plate", 1200, 140)]
    assert len(found["cut/sheet-1.json"]["placements"]) == 1
