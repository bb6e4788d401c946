"""The command line: exit codes, what goes where, and that no error leaves a traceback."""

import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from pipeline import __version__
from pipeline.cli import main
from pipeline.kinds import kind_names, template
from stages.errors import NoSolutionError
from tests.pipeline.jobs import PLATE, STOCK, TWISTED, write_job

NO_STOCK = ("--set", "stock=[]")
NO_PICTURES = ("--set", 'report.formats=["json"]')


def planish(*words: str | Path) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as caught:
        main([str(word) for word in words])
        raise SystemExit(0)
    return int(caught.value.code or 0)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


JOBS = {
    "made": (PLATE + STOCK, 0, "made: 1 piece on 1 sheet, 2 drawings and report.json in out"),
    "flat": (PLATE, 0, "made: 1 piece, 1 drawing and report.json in out"),
    "pages": (
        PLATE.replace('["json"]', '["json", "html", "traveller"]'),
        0,
        "made: 1 piece, 1 drawing, report.html, traveller.pdf and report.json in out",
    ),
    "rejected": (PLATE + TWISTED, 1, "rejected: twisted; nothing nested, 1 drawing and report.json in out"),
    "too large": (
        PLATE + STOCK.replace("100", "10"),
        3,
        "no-solution: not all could be nested and written; 1 drawing and report.json in out",
    ),
}


@pytest.mark.parametrize("name", JOBS)
def test_exit_codes_are_the_same_with_and_without_json(
    tmp_path: Path, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    text, code, last = JOBS[name]
    write_job(tmp_path, text)
    assert planish("run", "job.toml", "-o", "out") == code
    plain = capfd.readouterr()
    assert plain.out == ""
    assert plain.err.splitlines()[-1] == last
    assert planish("run", "job.toml", "-o", "out", "--json", "--quiet") == code
    quiet = capfd.readouterr()
    assert quiet.err == ""
    assert quiet.out == (tmp_path / "out" / "report.json").read_text("utf-8")


def test_a_rejection_says_where_how_much_what_is_allowed_and_what_to_do(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    planish("run", write_job(tmp_path, PLATE + TWISTED), "-o", "out")
    lines = capfd.readouterr().err.splitlines()
    (failed,) = [line for line in lines if "FAILED" in line]
    assert failed.startswith(  # atan(40 / 100)
        "twisted  verify  FAILED  warp 21.8014 deg (proved)"
    )
    told = next(line for line in lines if "not developable enough" in line)
    assert " at v = " in told
    assert "allowed 0.1 deg" in told
    assert told.endswith("or accept a wider class under [tolerance]")


def test_the_output_folder_is_named_after_the_job(tmp_path: Path) -> None:
    write_job(tmp_path, PLATE + '[job]\nname = "Auftrag 7/a"\n')
    assert planish("run", "job.toml", "--quiet") == 0
    assert (tmp_path / "out" / "Auftrag-7-a" / "report.json").exists()
    write_job(tmp_path, PLATE, "plates.toml")
    assert planish("run", "plates.toml", "--quiet") == 0
    assert (tmp_path / "out" / "plates" / "flat" / "plate.dxf").exists()


def test_a_wrong_job_file_is_told_on_stderr_and_as_a_document(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_job(tmp_path, PLATE.replace('"flat"', '"flatt"') + "quantity = 0\n")
    wanted = 'job.toml:7:8: part[0].surface.kind: unknown kind "flatt" (did you mean "flat"?)\n'
    for words in (("run", "job.toml"), ("check", "job.toml")):
        assert planish(*words) == 2
        assert capfd.readouterr() == ("", wanted)
        assert planish(*words, "--json") == 2
        shown = capfd.readouterr()
        assert shown.err == wanted
        (error,) = json.loads(shown.out)["errors"]
        assert error == {
            "file": "job.toml",
            "line": 7,
            "column": 8,
            "path": "part[0].surface.kind",
            "message": 'unknown kind "flatt"',
            "hint": 'did you mean "flat"?',
        }
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("run",),
        ("run", "job.toml", "--nonsense"),
        ("nonsense",),
        ("run", "none.toml"),
        ("run", "."),
        ("run", "job.toml", "-o", "job.toml"),
        ("run", "job.toml", "-o", "job.toml/out"),
        ("run", "job.toml", "-o", "."),
        ("run", "job.toml", "-o", "full"),
        ("run", "job.toml", "--set", "nonsense"),
        ("run", "job.toml", "--set", "part[0].quantity=0"),
        ("check", "none.toml"),
        ("init", "nonsense"),
    ],
    ids=" ".join,
)
def test_a_wrong_usage_ends_with_2_and_writes_nothing(
    tmp_path: Path, words: tuple[str, ...], capfd: pytest.CaptureFixture[str]
) -> None:
    write_job(tmp_path)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.doc").touch()
    before = sorted(tmp_path.rglob("*"))
    for more in ((), ("--json",)):
        assert planish(*words, *more) == 2
        shown = capfd.readouterr()
        assert shown.err
        assert "Traceback" not in shown.err
        assert sorted(tmp_path.rglob("*")) == before
        if more:
            assert json.loads(shown.out)["errors"]


def test_a_check_says_that_all_is_well(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    write_job(tmp_path)
    assert planish("check", "job.toml") == 0
    assert capfd.readouterr() == ("", "job.toml: 1 part, no errors\n")
    assert planish("check", "job.toml", "--json") == 0
    assert json.loads(capfd.readouterr().out) == {"errors": []}


def test_a_defect_ends_with_4_and_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("by nought")

    monkeypatch.setattr("pipeline.run.run_job", broken)
    assert planish("run", write_job(tmp_path), "-o", "out") == 4
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("internal error: ZeroDivisionError: by nought; set PLANISH_TRACEBACK=1")
    assert not (tmp_path / "out").exists()
    monkeypatch.setenv("PLANISH_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        main(["run", "job.toml"])


def test_a_method_that_falls_short_ends_with_3_and_both_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def short(*_: object) -> None:
        raise NoSolutionError("fit of K", reached=0.25, wanted=0.125, unit="mm")

    monkeypatch.setattr("pipeline.run.run_job", short)
    assert planish("run", write_job(tmp_path), "-o", "out") == 3
    assert capfd.readouterr().err == "fit of K: reached 0.25 mm, wanted 0.125 mm\n"
    assert not (tmp_path / "out").exists()


def test_ctrl_c_ends_with_130_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("pipeline.run.run_job", interrupted)
    assert planish("run", write_job(tmp_path), "-o", "out") == 130
    assert capfd.readouterr().err.strip() == "interrupted"
    assert [entry.name for entry in tmp_path.iterdir()] == ["job.toml"]


def test_lists_name_every_kind_and_material(capfd: pytest.CaptureFixture[str]) -> None:
    assert planish("kinds") == 0
    listed = capfd.readouterr().out
    assert [line.split(":")[0] for line in listed.splitlines() if not line.startswith(" ")] == kind_names()
    assert planish("materials") == 0
    assert "mild steel" in capfd.readouterr().out


def test_the_schema_of_side_files_is_printed_on_request(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert planish("schema", "--side") == 0
    schema = json.loads(capfd.readouterr().out)
    assert planish("run", str(write_job(tmp_path)), "-o", str(tmp_path / "out")) == 0
    side = json.loads((tmp_path / "out" / "flat" / "plate.json").read_text("utf-8"))
    jsonschema.Draft202012Validator(schema).validate(side)
    assert [file["path"] for file in side["files"]] == ["flat/plate.dxf"]


def test_the_schema_accepts_what_the_reader_accepts(capfd: pytest.CaptureFixture[str]) -> None:
    import tomllib

    assert planish("schema") == 0
    schema = json.loads(capfd.readouterr().out)
    validator = jsonschema.Draft202012Validator(schema)
    for text in (PLATE + STOCK, *(template(kind) for kind in kind_names())):
        validator.validate(tomllib.loads(text))
    assert not validator.is_valid(tomllib.loads(PLATE + "nonsense = 1\n"))


@pytest.mark.parametrize("kind", kind_names())
def test_a_template_is_commented_and_runs_unedited(
    tmp_path: Path, kind: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert planish("init", kind) == 0
    text = capfd.readouterr().out
    assert text.count("#") >= 8
    write_job(tmp_path, text)
    assert planish("run", "job.toml", "-o", "out", *NO_PICTURES, "--quiet") == 0
    assert capfd.readouterr() == ("", "")


def start(*words: str) -> tuple[subprocess.CompletedProcess[str], float]:
    """Return a command run in a process of its own, and the seconds of processor time it took."""
    begin = children_seconds()
    environment = os.environ | {"PYTHONWARNINGS": ""}
    done = subprocess.run(
        [sys.executable, "-m", "pipeline", *words], capture_output=True, text=True, check=False, env=environment
    )
    return done, children_seconds() - begin


def children_seconds() -> float:
    times = os.times()
    return times.children_user + times.children_system


def test_the_version_is_told_fast_and_without_heavy_imports(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    assert min(start("--version")[1] for _ in range(5)) <= 0.060
    assert start("--version")[0].stdout == f"planish {__version__}\n"
    code = "import sys, pipeline.cli; print(*sorted(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "scipy", "msgspec", "ezdxf", "matplotlib", "shapely", "tree_sitter"} & set(loaded)


def test_the_module_runs_as_the_command_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    write_job(tmp_path, PLATE + TWISTED)
    done, _ = start("run", "job.toml")
    assert done.returncode == 1
    assert done.stdout == ""
    assert "\x1b" not in done.stderr
    assert start("run", "none.toml")[0].returncode == 2
