"""Numbers of extreme size in every kind's own job file: made, refused or fallen short, never an internal error."""

import json
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from importlib.resources import files
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.run import run_job
from pipeline.store import digest
from stages.errors import BadInputError
from stages.model.curves import MOST_TURNS

TEMPLATES = files("pipeline").joinpath("data", "init")
FROM_FILES = {"mesh", "face"}
"""Their numbers are in other files."""
SLOW = {"bezier-pair", "rails"}
"""Some numbers make a proof or a search of seconds of them."""
KINDS = sorted(entry.name.removesuffix(".toml") for entry in TEMPLATES.iterdir())
SIZES = st.sampled_from(
    ["0", "1e-390", "1e-204", "1e-21", "1e-20", "6.1e-17", "1e-13", "1e-9", "1e-6", "1e4", "1e6", "1e9", "1e10"]
)
Path_ = tuple[str | int, ...]


def template(kind: str) -> dict[str, object]:
    """Return the job of a kind without stock and pictures, its numbers as texts."""
    table = tomllib.loads(TEMPLATES.joinpath(f"{kind}.toml").read_text("utf-8"), parse_float=str)
    table.pop("stock", None)
    return table | {"report": {"formats": ["json"]}}


def numbers(value: object, path: Path_ = ()) -> Iterator[Path_]:
    """Yield the ways to all numbers of a table."""
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers(item, (*path, key))
    elif (isinstance(value, int) and not isinstance(value, bool)) or (
        isinstance(value, str) and value.lstrip("+-")[:1].isdigit()
    ):
        yield path


def with_number(value: object, path: Path_, size: str) -> None:
    """Set one number."""
    for step in path[:-1]:
        value = value[step]  # type: ignore[index]
    value[path[-1]] = size  # type: ignore[index]


def exit_code(folder: Path, table: dict[str, object]) -> int:
    """Return the exit code of a job."""
    file = folder / f"{digest(json.dumps(table).encode())[:16]}.json"
    file.write_text(json.dumps(table), "utf-8")
    try:
        return run_job(job_of(read(file))).exit_code
    except BadInputError:
        return 2


def check_numbers(kind: str, data: st.DataObject, folder: Path) -> None:
    """Set up to three numbers of a kind's job to what no one means, and run it."""
    table = deepcopy(template(kind))
    surface = table["part"][0]["surface"]  # type: ignore[index]
    for path in data.draw(st.lists(st.sampled_from(list(numbers(surface))), min_size=1, max_size=3, unique=True)):
        with_number(surface, path, data.draw(st.sampled_from(["", "-"])) + data.draw(SIZES))
    assert exit_code(folder, table) in {0, 1, 2, 3}


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in SLOW | FROM_FILES])
@given(data=st.data())
@settings(max_examples=2, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_number_of_a_job_ends_in_an_internal_error(kind: str, data: st.DataObject, tmp_path: Path) -> None:
    check_numbers(kind, data, tmp_path)


@pytest.mark.parametrize("kind", sorted(SLOW))
@given(data=st.data())
@settings(max_examples=1, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_none_of_a_kind_that_takes_seconds_does_either(kind: str, data: st.DataObject, tmp_path: Path) -> None:
    check_numbers(kind, data, tmp_path)


PLANES = """\
schema = 1
[report]
formats = ["json"]
[[part]]
name = "part"
[part.surface]
kind = "cone"
apex = [0, 0, 400]
directrix = {{ bezier = [[100, 0, 0], [100, 80, 0], [0, 100, 0]] }}
end_plane = {{ point = [0, 0, 200], normal = {normal} }}
"""


@pytest.mark.parametrize("least", ["1e-204", "1e-320", "1e-21"])
@pytest.mark.parametrize("normal", ["[0, {least}, 1]", "[{least}, {least}, {least}]"])
def test_a_direction_that_is_all_but_nothing_is_refused_with_a_cure(tmp_path: Path, least: str, normal: str) -> None:
    file = tmp_path / "job.toml"
    file.write_text(PLANES.format(normal=normal.format(least=least)), "utf-8")
    with pytest.raises(BadInputError) as caught:
        read(file)
    problem = caught.value.problems[0]
    assert "absurdly small" in problem.message
    assert problem.hint is not None
    assert problem.hint.startswith("0, or at least 1e-20")


@pytest.mark.parametrize("least", ["6.1e-17", "1e-20"])
def test_what_rounding_leaves_of_a_zero_is_taken(tmp_path: Path, least: str) -> None:
    file = tmp_path / "job.toml"
    file.write_text(PLANES.format(normal=f"[{least}, -{least}, 1]"), "utf-8")
    assert run_job(job_of(read(file))).exit_code == 0


@pytest.mark.parametrize(
    ("kind", "path", "size"),
    [("quintic-cylinder", ("q0", 2), "1e-6"), ("cylinder", ("directrix", "circle", "radius"), "1e-13")],
)
def test_a_part_too_thin_to_cut_is_refused_by_geometry(tmp_path: Path, kind: str, path: Path_, size: str) -> None:
    table = template(kind)
    with_number(table["part"][0]["surface"], path, size)  # type: ignore[index]
    assert exit_code(tmp_path, table) == 1


def test_a_helix_of_countless_turns_is_refused(tmp_path: Path) -> None:
    helix = {"helix": {"radius": 10, "pitch": 5, "turns": MOST_TURNS + 1}}
    table = template("tangent") | {
        "part": [{"name": "part", "surface": {"kind": "tangent", "edge": helix, "from": 1, "to": 2}}]
    }
    assert exit_code(tmp_path, table) == 2
