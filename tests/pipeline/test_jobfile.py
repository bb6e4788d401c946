"""Job files: what is read from good ones, and everything that is wrong with bad ones, with place and remedy."""

import copy
import json
import tomllib
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.decode import MOST_COMPLAINTS, canonical
from pipeline.jobfile import read
from pipeline.parse import LARGEST_FILE
from stages.errors import BadInputError
from stages.model.part import Cone
from stages.model.quintics import QuinticCylinder
from tests.pipeline.bad_jobs import BAD, BAD_JSON, CYLINDER
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job


def problems(folder: Path, text: str, name: str = "job.toml", sets: tuple[str, ...] = ()) -> list[str]:
    """Return the error lines of a job file, without its folder."""
    with pytest.raises(BadInputError) as caught:
        read(write_job(folder, text, name), sets)
    return [str(problem).replace(f"{folder}/", "") for problem in caught.value.problems]


def test_numbers_are_kept_as_typed(tmp_path: Path) -> None:
    surface = read(write_job(tmp_path, CYLINDER)).tables.part[0].surface
    assert isinstance(surface, QuinticCylinder)
    assert list(surface.t0) == [Fraction(3, 5), Fraction(4, 5), 0]
    assert surface.k0 == surface.k1 == Fraction(1, 200)


def test_the_unit_of_the_job_scales_lengths_and_curvatures_but_not_directions(tmp_path: Path) -> None:
    surface = read(write_job(tmp_path, f'units = "in"\n{CYLINDER}')).tables.part[0].surface
    assert isinstance(surface, QuinticCylinder)
    assert surface.q0[2] == 80 * Fraction(127, 5)
    assert surface.k0 == Fraction(1, 200) * Fraction(5, 127)
    assert surface.k1 == Fraction(1, 200)
    assert surface.t0[0] == Fraction(3, 5)


def test_json_of_the_same_shape_is_the_same_job(tmp_path: Path) -> None:
    text = PLATE + STOCK + CONE
    as_json = json.dumps(tomllib.loads(text))
    toml, plain = read(write_job(tmp_path, text)), read(write_job(tmp_path, as_json, "job.json"))
    assert canonical(toml.tables) == canonical(plain.tables)


def test_defaults_are_those_of_the_contract(tmp_path: Path) -> None:
    tables = read(write_job(tmp_path, CYLINDER)).tables
    assert (tables.units, tables.tolerance.chord, tables.tolerance.accept) == ("mm", Fraction(1, 20), "fabrication")
    assert (tables.part[0].quantity, tables.dxf.flavour, tables.stock) == (1, "polyline-arcs", ())


def test_windows_line_ends_and_a_byte_order_mark_are_no_error(tmp_path: Path) -> None:
    file = tmp_path / "job.toml"
    file.write_bytes(b"\xef\xbb\xbf" + PLATE.replace("\n", "\r\n").encode())
    assert read(file).tables.part[0].name == "plate"


@pytest.mark.parametrize("name", BAD)
def test_a_bad_job_file_is_told_everything_at_once(tmp_path: Path, name: str) -> None:
    text, wanted = BAD[name]
    assert problems(tmp_path, text) == wanted


@pytest.mark.parametrize("name", BAD_JSON)
def test_a_bad_json_file_is_told_everything_at_once(tmp_path: Path, name: str) -> None:
    text, wanted = BAD_JSON[name]
    assert problems(tmp_path, text, "job.json") == wanted


@pytest.mark.parametrize(
    ("name", "text", "start"),
    [
        ("job.toml", "schema = 1\nname = = 3\n", "job.toml:2:8: TOML: "),
        ("job.toml", "schema = 1\nschema = 1\n", "job.toml:2:"),
        ("job.toml", "a = [\n1,\n", "job.toml:2:1: TOML: "),
        ("job.json", '{"schema": 1,\n}', "job.json:"),
        ("job.json", "", "job.json:1:1: JSON: "),
    ],
)
def test_a_syntax_error_has_its_place(tmp_path: Path, name: str, text: str, start: str) -> None:
    (line,) = problems(tmp_path, text, name)
    assert line.startswith(start)


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("radius0 = 40 mm", 'a number with its unit stands in quotes: "40 mm"'),
        ("at = [1/8 in, 3]", 'a number with its unit stands in quotes: "1/8 in"'),
        ("radius0 = 1,5", "decimals come after a point: 1.5"),
        ("name = bow", 'a text stands in quotes: "bow"'),
        ("c = { name = left bow, x = 1 }", 'a text stands in quotes: "left bow"'),
        ("name = = 3", ""),
        (f"name = {'a ' * 10_000_000}", 'a text stands in quotes: "a a'),
    ],
)
def test_a_syntax_error_says_what_is_most_likely_meant(tmp_path: Path, line: str, hint: str) -> None:
    with pytest.raises(BadInputError) as caught:
        read(write_job(tmp_path, f"schema = 1\n{line}\n"[:LARGEST_FILE]))
    (problem,) = caught.value.problems
    assert problem.line == 2
    assert problem.hint.startswith(hint)
    assert bool(problem.hint) is bool(hint)


def test_a_file_that_is_not_there_is_told_with_the_one_that_may_be_meant(tmp_path: Path) -> None:
    file = write_job(tmp_path, PLATE, "bracket.toml")
    for asked, hint in [
        (tmp_path / "braket.toml", f"did you mean {file}?"),
        (tmp_path, f"did you mean {file}?"),
        (tmp_path / "quite" / "another.toml", f"there is no folder {tmp_path / 'quite'}"),
        (tmp_path / "quite-another", ""),
    ]:
        with pytest.raises(BadInputError) as caught:
            read(asked)
        assert caught.value.problems[0].hint == hint


def test_one_table_where_several_belong_is_told_how_they_are_written(tmp_path: Path) -> None:
    (told,) = problems(tmp_path, PLATE.replace("[[part]]", "[part]"))
    assert "part: a table where an array belongs (" in told
    assert told.endswith("; in TOML write [[part]] over each)")


def test_deep_chains_of_curves_are_refused(tmp_path: Path) -> None:
    curve = '{"chain":[' * 400 + '{"line":[[0,0],[1,0]]}' + "]}" * 400
    text = '{"schema":1,"part":[{"name":"a","surface":{"kind":"flat","outline":' + curve + "}}]}"
    try:
        read(write_job(tmp_path, text, "job.json"))
    except BadInputError as error:
        assert "nested too deeply" in str(error)


def test_a_file_too_large_or_not_text_or_not_there_is_refused(tmp_path: Path) -> None:
    large, binary = tmp_path / "large.toml", tmp_path / "binary.toml"
    with large.open("wb") as stream:
        stream.truncate(LARGEST_FILE + 1)
    binary.write_bytes(b"schema = 1\nname = '\xff'")
    for file, message in [
        (large, "large.toml: larger than 20 MB (is this a job file?)"),
        (binary, "binary.toml:2:9: not UTF-8 text (save the file as UTF-8)"),
        (tmp_path / "none.toml", "none.toml: cannot be read: No such file or directory"),
        (tmp_path, "cannot be read: it is a folder"),
    ]:
        with pytest.raises(BadInputError) as caught:
            read(file)
        assert str(caught.value).endswith(message)


def test_a_flood_of_errors_is_cut_off(tmp_path: Path) -> None:
    text = PLATE + "".join(f"x{i} = 1\n" for i in range(3 * MOST_COMPLAINTS))
    *told, more = problems(tmp_path, text)
    assert len(told) == MOST_COMPLAINTS
    assert "there may be more" in str(more)


def test_set_replaces_values_before_they_are_read(tmp_path: Path) -> None:
    file = write_job(tmp_path, PLATE + CONE)
    sets = ("part[1].surface.radius0=1/8 in", "part[1].quantity=3", "material.name=mild steel", "tolerance.chord = 0.1")
    tables = read(file, sets).tables
    surface = tables.part[1].surface
    assert isinstance(surface, Cone)
    assert (surface.radius0, tables.part[1].quantity) == (Fraction(127, 40), 3)
    assert (tables.material.name, tables.tolerance.chord) == ("mild steel", Fraction(1, 10))


def test_errors_of_set_name_the_option_and_not_a_line(tmp_path: Path) -> None:
    assert problems(tmp_path, PLATE, sets=("part[0].quantity=-1",)) == [
        "--set: part[0].quantity: -1 is out of range (a whole number from 1 to 100000 is needed)"
    ]
    hint = "the tables and arrays on the way must be there, or be tables"
    assert problems(tmp_path, PLATE, sets=("part[1].quantity=1", "nonsense", "a b=1")) == [
        f"--set: part[1].quantity: no such place in the job file ({hint})",
        '--set: "nonsense" is not path=value (write --set part[0].surface.k0=1)',
        '--set: "a b=1" is not path=value (write --set part[0].surface.k0=1)',
    ]


WHOLE = tomllib.loads(PLATE + STOCK + TWISTED + CONE + CYLINDER[CYLINDER.index("[[part]]") :], parse_float=Decimal)
NASTY = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(["1e999999", "nan", "1/0", "flat", [], {}, [[]], [{}], {"file": "x.dxf"}, 10**400, [0, 0, 0]]),
)


def spoiled(raw: object, data: st.DataObject) -> object:
    """Return a value with one place changed, removed or doubled."""
    if not isinstance(raw, dict | list) or not raw or data.draw(st.integers(0, 5)) == 0:
        return copy.deepcopy(data.draw(NASTY))
    key = data.draw(st.sampled_from(sorted(raw) if isinstance(raw, dict) else range(len(raw))))
    action = data.draw(st.sampled_from(["inside", "inside", "inside", "drop", "rename"]))
    if action == "drop":
        del raw[key]
    elif action == "rename" and isinstance(raw, dict):
        raw[data.draw(st.text(max_size=5))] = raw.pop(key)
    else:
        raw[key] = spoiled(raw[key], data)
    return raw


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_no_spoiled_job_breaks_the_reader(tmp_path: Path, data: st.DataObject) -> None:
    raw: object = copy.deepcopy(WHOLE)
    for _ in range(data.draw(st.integers(1, 3))):
        raw = spoiled(raw, data)
    file = write_job(tmp_path, json.dumps(raw, default=float), "job.json")
    try:
        read(file)
    except BadInputError as error:
        assert all(problem.message and problem.file for problem in error.problems)


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_no_spoiled_text_breaks_the_reader(tmp_path: Path, data: st.DataObject) -> None:
    text = PLATE + STOCK + CONE
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(start + 10, len(text))))
    file = tmp_path / "job.toml"
    file.write_bytes(text[:start].encode() + data.draw(st.binary(max_size=6)) + text[end:].encode())
    try:
        read(file)
    except BadInputError as error:
        assert all(problem.message and problem.file for problem in error.problems)
