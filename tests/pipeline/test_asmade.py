"""`planish compare`: sheets read strictly, verdicts on their limits, values fitted within their stated intervals."""

import csv
import io
import json
from fractions import Fraction
from math import pi
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pipeline.asmade import comparison
from pipeline.asmade_document import compare_document, compare_lines, compare_schema
from pipeline.asmade_fits import k_offer, kerf_offer, springback_offer
from pipeline.asmade_nominal import Nominal, nominal_of
from pipeline.asmade_rows import COLUMNS, Measured, Reading, exact
from pipeline.asmade_sheet import read_sheet, template
from pipeline.asmade_sizes import ISO_2768_ANGLES, ISO_2768_M, length_tolerance
from pipeline.cli import main
from stages.errors import BadInputError
from stages.model.material import Material
from stages.unroll.rolls import tool_radius
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job

JOB = """\
schema = 1
[report]
formats = ["json"]
[material]
name = "DC01"
thickness = 2
k_factor = 0.4
[process]
type = "laser"
kerf = 0.15
[[part]]
name = "=plate()"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [400, 0], [400, 300], [0, 300], [0, 0]] }
[[part.hole]]
name = "bore"
kind = "circle"
at = [100, 100]
diameter = 40
[[part]]
name = "shell"
[part.surface]
kind = "cylinder"
directrix = { arc = { center = [0, 0, 0], radius = 300, normal = [0, 0, 1], start = 0, end = 120 } }
direction = [0, 0, 1]
length = 250
[[part]]
name = "angle"
face = "inner"
[part.surface]
kind = "strip"
[[part.surface.pieces]]
kind = "cylinder"
directrix = { line = [[0, 40, 0], [0, 4, 0]] }
direction = [0, 0, 1]
length = 50
[[part.surface.pieces]]
kind = "cylinder"
directrix = { arc = { center = [4, 4, 0], radius = 4, normal = [0, 0, 1], start = 180, end = 270 } }
direction = [0, 0, 1]
length = 50
[[part.surface.pieces]]
kind = "cylinder"
directrix = { line = [[4, 0, 0], [60, 0, 0]] }
direction = [0, 0, 1]
length = 50
[[part.bend]]
max_angle = 90
"""
PLATE_NAME = "=plate()"
U_MM, U_DEG = Fraction(1, 20), Fraction(1, 5)
COVER = 1.959963984540054
HEAD = "part,what,measured,unit,uncertainty\n"


def planish(*words: str | Path) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as caught:
        main([str(word) for word in words])
        raise SystemExit(0)
    return int(caught.value.code or 0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a job and its output in `out`."""
    here = tmp_path_factory.mktemp("asmade")
    planish("run", write_job(here, JOB), "-o", here / "out", "--quiet")
    return here


@pytest.fixture(scope="module")
def nominal(folder: Path) -> Nominal:
    return nominal_of(folder / "out")


def sheet(folder: Path, text: str, name: str = "measured.csv") -> Path:
    file = folder / name
    file.write_bytes(text.encode())
    return file


# What can be measured


def test_sizes_of_the_blank_and_of_the_formed_part_are_those_of_closed_forms(nominal: Nominal) -> None:
    sizes = {(one.part, one.what): one.nominal for one in nominal.dimensions}
    assert sizes[PLATE_NAME, "diagonal 1"] == 500.0
    assert sizes[PLATE_NAME, "hole bore"] == 40.0
    assert sizes["shell", "roll 1 radius"] == 299.0
    assert (sizes["angle", "flange 1"], sizes["angle", "flange 2"]) == (42.0, 62.0)
    assert_near(sizes["angle", "height"], 36 + 56 + pi / 2 * (4 + 0.4 * 2), bound=5e-7, why="rounded to 1e-6 mm")


def test_the_empty_sheet_names_everything_and_reads_as_nothing_measured(folder: Path, nominal: Nominal) -> None:
    text = template(nominal)
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == list(COLUMNS)
    assert {row["part"] for row in rows} == {"'=plate()", "shell", "angle"}
    with pytest.raises(BadInputError, match="nothing is measured"):
        read_sheet(sheet(folder, text), nominal)


@pytest.mark.parametrize(
    ("size", "limit"), [(0.4, None), (3.0, 0.1), (30.0, 0.2), (30.5, 0.3), (4000.0, 2.0), (4001.0, None)]
)
def test_general_tolerances_are_those_of_the_table(size: float, limit: float | None) -> None:
    assert length_tolerance(size) == limit


def test_both_tables_of_general_tolerances_are_those_of_the_standard() -> None:
    lengths = {3: "0.1", 6: "0.1", 30: "0.2", 120: "0.3", 400: "0.5", 1000: "0.8", 2000: "1.2", 4000: "2"}
    minutes = {10: 60, 50: 30, 120: 20, 400: 10, np.inf: 5}
    assert dict(ISO_2768_M) == {size: float(limit) for size, limit in lengths.items()}
    for (leg, limit), (most, minute) in zip(ISO_2768_ANGLES, minutes.items(), strict=True):
        assert leg == most
        assert_near(60.0 * limit, float(minute), bound=1e-12, why="minutes of arc as degrees")


# Verdicts


@pytest.mark.parametrize(("measured", "passed"), [("400.3", True), ("399.7", True), ("400.30000000000001", False)])
def test_a_value_on_its_limit_passes_and_the_next_one_fails(folder: Path, measured: str, passed: bool) -> None:
    file = sheet(folder, f"part,what,measured,unit,uncertainty,tolerance\n'=plate(),width,{measured},mm,0.05,0.3\n")
    (one,) = comparison(folder / "out", file, None).dimensions
    assert (one.passed, one.sure) == (passed, False)


def test_inches_are_exact_and_the_default_tolerance_is_told(folder: Path) -> None:
    file = sheet(folder, HEAD + "shell,width,9.8425196850393700787,in,0.002\n")
    (one,) = comparison(folder / "out", file, None).dimensions
    assert abs(float(one.difference)) < 1e-15
    assert (one.reading.tolerance, one.reading.by) == (Fraction(1, 2), "ISO 2768-1 m")
    assert one.reading.uncertainty == Fraction("0.0508")


def test_exchanged_digits_are_recognised_and_a_part_that_is_merely_off_is_not(folder: Path) -> None:
    file = sheet(folder, HEAD + "'=plate(),width,040.0,mm,0.05\nshell,width,520.0,mm,0.05\nangle,width,50.4,mm,0.05\n")
    slips = [one.slip for one in comparison(folder / "out", file, None).dimensions]
    assert slips == ["400.0", "250.0", ""]


# Strict reading

BAD = {
    "comma": ('angle,width,"50,1",mm,0.05', 'measured: "50,1" is no number (write a decimal point, not a comma)'),
    "bare comma": ("angle,width,50,1,mm,0.05", "6 cells, and 5 columns (a decimal comma? write a decimal point)"),
    "nan": ("angle,width,nan,mm,0.05", 'measured: "nan" is no number'),
    "inf": ("angle,width,1e99999,mm,0.05", 'measured: "1e99999" is no number'),
    "huge": ("angle,width,1e30,mm,0.05", 'measured: "1e30" is out of range'),
    "other digits": ("angle,width,٥٠,mm,0.05", "is no number"),
    "unit": ("angle,width,50,deg,0.05", 'unit: "deg" is no unit of this (mm | cm | m | in)'),
    "no unit": ("angle,width,50,,0.05", "unit: the unit is missing"),
    "uncertainty": ("angle,width,50,mm,", "uncertainty: the uncertainty is missing"),
    "certain": ("angle,width,50,mm,0", "no instrument measures without error"),
    "negative": ("angle,width,-50,mm,0.05", "is not above 0"),
    "part": ("angel,width,50,mm,0.05", 'part: "angel" is no part of this job (did you mean "angle"?)'),
    "what": ("angle,widht,50,mm,0.05", 'did you mean "width"?'),
    "twice": ("angle,width,50,mm,0.05\nangle,width,50,mm,0.05", "is on line 2 already (number the copies"),
    "formula": ("angle,width,=1+1,mm,0.05", 'measured: "=1+1" is no number'),
    "quote": ('angle,"width,50,mm,0.05', "is no table of commas"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_told_with_its_line_and_cure(folder: Path, nominal: Nominal, name: str) -> None:
    rows, told = BAD[name]
    file = sheet(folder, HEAD + rows + "\n")
    with pytest.raises(BadInputError) as caught:
        read_sheet(file, nominal)
    (problem,) = caught.value.problems
    assert told in str(problem)
    assert problem.file == str(file)
    assert problem.line == (3 if name == "twice" else 2)


def test_all_errors_come_at_once(folder: Path, nominal: Nominal) -> None:
    with pytest.raises(BadInputError) as caught:
        read_sheet(sheet(folder, HEAD + "angle,width,x,ell,\nnobody,y,1,mm,0.1\n"), nominal)
    assert [problem.line for problem in caught.value.problems] == [2, 2, 2, 3]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b"", "is empty"),
        (b"part;what;measured\n", "parted by semicolons"),
        (b"part,what,measured,unit\n", "uncertainty: the column is missing"),
        (b"part,part,what,measured,unit,uncertainty,sum\n", "the column is there twice"),
        (b"part,what,measured,unit,uncertainty\n\xff\xfe,1\n", "is not UTF-8"),
    ],
)
def test_what_is_no_sheet_is_told(folder: Path, nominal: Nominal, text: bytes, told: str) -> None:
    file = folder / "bad.csv"
    file.write_bytes(text)
    with pytest.raises(BadInputError) as caught:
        read_sheet(file, nominal)
    assert told in str(caught.value)


def test_a_sheet_of_another_run_is_refused(folder: Path, nominal: Nominal) -> None:
    rows = "part,what,nominal,measured,unit,uncertainty\nangle,width,51,50.0,mm,0.05\n"
    with pytest.raises(BadInputError, match="another run"):
        read_sheet(sheet(folder, rows), nominal)


def test_byte_order_marks_crlf_and_columns_in_any_order_are_read(folder: Path, nominal: Nominal) -> None:
    text = "\ufeffunit,what,Part,uncertainty,measured\r\nmm,width,angle,0.05, 50.1 \r\n\r\n"
    (one,) = read_sheet(sheet(folder, text), nominal).readings
    assert (one.measured, one.line) == (Fraction("50.1"), 2)


# Fits


def reading(
    nominal: Nominal, part: str, what: str, value: float, *, copy: int = 1, tool: float | None = None
) -> Reading:
    """Return a reading as an instrument shows it."""
    of = next(one for one in nominal.dimensions if (one.part, one.what) == (part, what))
    u = U_MM if of.unit == "mm" else U_DEG
    bent_to = None if tool is None else exact(tool)
    return Reading(2, copy, of, exact(value), u, None, "", bent_to, str(value), Fraction(1))


def blank(nominal: Nominal, kerf: float, rng: np.random.Generator) -> Measured:
    """Return all sizes of blanks cut with a kerf along nominal contours."""
    found = [
        reading(nominal, one.part, one.what, one.nominal + one.rate * kerf + rng.normal(0.0, float(U_MM) / COVER))
        for one in nominal.dimensions
        if one.rate is not None
    ]
    return Measured(tuple(found), (), 0)


def bent(nominal: Nominal, k: float, rng: np.random.Generator) -> Measured:
    """Return four angles bent from nominal blanks with another K, as measured."""
    found = []
    for copy in range(1, 5):
        true = {one.what: one.nominal for one in nominal.dimensions if one.part == "angle" and one.rate is None}
        true["height"] = 36 + 56 + pi / 2 * (4 + 0.4 * 2)
        true["flange 2"] += pi / 2 * (0.4 - k) * 2
        for what, value in true.items():
            u = float(U_DEG if what.endswith("angle") else U_MM) / COVER
            found.append(reading(nominal, "angle", what, value + rng.normal(0.0, u), copy=copy))
    return Measured(tuple(found), (), 0)


def rolled(nominal: Nominal, yield_mpa: float, rng: np.random.Generator) -> Measured:
    """Return the radii left of a shell rolled to those that would leave 299 mm."""
    tool = tool_radius(Material(thickness_mm=2.0, yield_strength_mpa=yield_mpa, youngs_modulus_gpa=210.0), 299.0)
    found = [
        reading(nominal, "shell", f"roll {i} radius", 299.0 + rng.normal(0.0, float(U_MM) / COVER), tool=tool)
        for i in range(1, 6)
    ]
    return Measured(tuple(found), (), 0)


FITS = {
    "kerf": (blank, kerf_offer, 0.18, 1.0),
    "k_factor": (bent, k_offer, 0.43, 1.0),
    "springback": (rolled, springback_offer, 260.0, 1.0 / 210e3),
}


@pytest.mark.parametrize("name", FITS)
def test_intervals_cover_the_truth_as_often_as_stated(nominal: Nominal, name: str) -> None:
    simulated, offer, truth, scale = FITS[name]
    rng = np.random.default_rng(11)
    made = [offer(simulated(nominal, truth, rng), nominal) for _ in range(200)]
    covered = np.mean([abs(one.value - truth * scale) <= one.half for one in made])
    assert covered >= 0.9  # 0.95 less 3.2 standard deviations of 200 draws
    assert np.mean([not one.reason for one in made]) >= 0.97
    assert all(one.toml for one in made if not one.reason)


def test_a_transposed_digit_is_named_and_not_averaged_away(nominal: Nominal) -> None:
    good = blank(nominal, 0.18, np.random.default_rng(2)).readings
    wrong = next(i for i, one in enumerate(good) if one.of.what == "height")
    spoilt = reading(nominal, PLATE_NAME, "height", 289.92)
    found = kerf_offer(Measured((*good[:wrong], spoilt, *good[wrong + 1 :]), (), 0), nominal)
    (outlier,) = found.outliers
    assert (outlier.tell.part, outlier.tell.what) == (PLATE_NAME, "height")
    assert abs(found.value - 0.18) <= found.half
    assert not found.reason


def test_too_few_readings_are_refused_with_what_to_measure(nominal: Nominal) -> None:
    two = Measured(blank(nominal, 0.2, np.random.default_rng(1)).readings[:2], (), 0)
    assert kerf_offer(two, nominal).reason.startswith("2 of at least 3 readings")
    four = bent(nominal, 0.4, np.random.default_rng(1)).readings
    without = Measured(tuple(one for one in four if one.of.what != "thickness"), (), 0)
    assert k_offer(without, nominal).reason.endswith("not measured: thickness")


def test_residuals_beyond_the_stated_uncertainty_are_refused(nominal: Nominal) -> None:
    rng = np.random.default_rng(5)
    coarse = [
        reading(nominal, one.part, one.what, one.nominal + rng.normal(0.0, 3 * float(U_MM)))
        for one in nominal.dimensions
        if one.rate is not None
    ]
    found = kerf_offer(Measured(tuple(coarse), (), 0), nominal)
    assert found.reason
    assert not found.toml


def test_no_kerf_is_offered_where_none_is_told_from_0(nominal: Nominal) -> None:
    assert kerf_offer(blank(nominal, 0.0, np.random.default_rng(1)), nominal).reason.startswith("not told from 0")


# The command


GOOD = HEAD + "'=plate(),width,399.82,mm,0.05\n'=plate(),height,299.83,mm,0.05\n'=plate(),hole bore,40.17,mm,0.05\n"


def test_the_command_writes_a_table_and_a_document_of_its_schema(
    folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = sheet(tmp_path, GOOD)
    assert planish("compare", folder / "out", file) == 0
    plain = capfd.readouterr()
    assert "kerf = 0.17" in plain.out
    assert plain.out.splitlines()[-1] == "3 measured; all within tolerance"
    assert planish("compare", folder / "out", file, "--json") == 0
    content = (tmp_path / "compare.json").read_text("utf-8")
    assert capfd.readouterr().out == content
    jsonschema.validate(json.loads(content), json.loads(compare_schema()))
    assert json.loads(content)["fits"][0]["interval_95"][0] < 0.1733 < json.loads(content)["fits"][0]["interval_95"][1]
    assert not (folder / "out" / "compare.json").exists()


def test_a_size_out_of_tolerance_ends_with_1_and_stands_first(folder: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, GOOD + "angle,width,51,mm,0.05\n")
    assert planish("compare", folder / "out", file, "--json") == 1
    lines = list(compare_lines(comparison(folder / "out", file, None)))
    assert lines[1].split()[0] == "angle"
    assert lines[1].endswith("FAIL")


def test_a_file_that_is_no_comparison_is_not_replaced(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "compare.json").write_text('{"my": "notes"}', "utf-8")
    assert planish("compare", folder / "out", sheet(tmp_path, GOOD)) == 2
    assert (tmp_path / "compare.json").read_text("utf-8") == '{"my": "notes"}'


def test_the_usage_is_told(folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert planish("compare", folder / "out") == 2
    assert "either a sheet of measurements or --template" in capfd.readouterr().err
    assert planish("compare", tmp_path, "x.csv") == 2
    assert "give the output folder of a finished job" in capfd.readouterr().err
    assert planish("compare", folder / "out", "x.csv") == 2
    assert planish("schema", "--compare") == 0


POINTS = "part,what,measured,unit,uncertainty,x,y,z\n"


def shell_points(off: float) -> str:
    """Return points on the outside of the shell, the middle of which has the radius 300, this far off."""
    angles = np.radians([5.0, 30.0, 50.0, 80.0, 110.0, 115.0, 60.0, 20.0])
    heights = [10.0, 200.0, 120.0, 30.0, 240.0, 100.0, 180.0, 90.0]
    radius = 301.0 + off
    rows = [f"{radius * np.cos(a):.6f},{radius * np.sin(a):.6f},{z}" for a, z in zip(angles, heights, strict=True)]
    side = "minus"
    return POINTS + "".join(f"shell,point {side},,mm,0.02,{row}\n" for row in rows)


def test_points_are_compared_in_the_frame_of_the_part(folder: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, shell_points(0.25))
    assert planish("compare", folder / "out", file, "--job", folder / "job.toml") == 0
    (cloud,) = json.loads((tmp_path / "compare.json").read_text("utf-8"))["points"]
    assert_near([abs(one["off_mm"]) for one in cloud["points"]], [0.25] * 8, bound=1e-6, why="six decimals")
    assert cloud["evidence"] == "sampled"


def test_points_need_the_job_of_the_folder(folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    file = sheet(tmp_path, shell_points(0.0))
    assert planish("compare", folder / "out", file) == 2
    assert "add --job JOB.toml" in capfd.readouterr().err
    assert planish("compare", folder / "out", file, "--job", write_job(tmp_path, PLATE)) == 2
    assert "not the one of this report" in capfd.readouterr().err
    assert (
        planish(
            "compare",
            folder / "out",
            sheet(tmp_path, POINTS + "'=plate(),point plus,,mm,0.1,1,2,3\n"),
            "--job",
            folder / "job.toml",
        )
        == 2
    )
    assert "is no ruled surface" in capfd.readouterr().err


def test_the_same_readings_give_the_same_document(folder: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, GOOD)
    one, other = (compare_document(comparison(folder / "out", file, None)) for _ in range(2))
    assert json.dumps(one) == json.dumps(other)
