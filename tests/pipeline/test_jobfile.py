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
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job

CYLINDER = """\
schema = 1
[[part]]
name = "shell"
  [part.surface]
  kind = "quintic-cylinder"
  p0 = [0, 0, 0]
  q0 = [0, 0, 80]
  p1 = [120, 0, 0]
  t0 = [0.6, 0.8, 0]
  t1 = [0.6, -0.8, 0]
  n0 = [0.8, -0.6, 0]
  n1 = [-0.8, -0.6, 0]
  k0 = 0.005
  k1 = "1/200 1/mm"
  alpha0 = 120
  alpha1 = 120
  s0 = 1
  s1 = 1
  g = 1
"""


def problems(folder: Path, text: str, name: str = "job.toml", sets: tuple[str, ...] = ()) -> list[str]:
    """Return the error lines of a job file, without its folder."""
    with pytest.raises(BadInputError) as caught:
        read(write_job(folder, text, name), sets)
    return [str(problem).replace(f"{folder}/", "") for problem in caught.value.problems]


def replaced(*pairs: tuple[str, str], text: str = CYLINDER) -> str:
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


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


VECTOR = "an array of 3 numbers is needed"
LENGTH = 'a length such as 12.5, "12.5 mm" or "1/8 in"'
BAD: dict[str, tuple[str, list[str]]] = {
    "a missing key": (
        replaced(("  p1 = [120, 0, 0]\n", "")),
        ["job.toml:4:3: part[0].surface.p1: missing (an array of 3 lengths is needed)"],
    ),
    "an unknown key": (
        replaced(("  g = 1\n", "  g = 1\n  alhpa0 = 1\n")),
        ['job.toml:20:3: part[0].surface.alhpa0: unknown key (did you mean "alpha0"?)'],
    ),
    "a wrong type": (
        replaced(("alpha0 = 120", "alpha0 = true"), ("t0 = [0.6, 0.8, 0]", "t0 = [0.6, 0.8]")),
        [
            f"job.toml:9:8: part[0].surface.t0: an array of 2 does not fit ({VECTOR})",
            f"job.toml:15:12: part[0].surface.alpha0: true where a length belongs ({LENGTH})",
        ],
    ),
    "numbers that are not finite": (
        replaced(("[0, 0, 80]", "[0, nan, inf]")),
        [
            f"job.toml:7:12: part[0].surface.q0[1]: nan is not a finite number ({LENGTH})",
            f"job.toml:7:17: part[0].surface.q0[2]: inf is not a finite number ({LENGTH})",
        ],
    ),
    "a tangent of length zero, and another error in the same table": (
        replaced(("[0.6, -0.8, 0]", "[0, 0, 0]"), ("  s0 = 1\n", "")),
        [
            "job.toml:4:3: part[0].surface.s0: missing (a number is needed)",
            "job.toml:10:8: part[0].surface.t1: the tangent has length 0 (give the direction of the curve at this end)",
        ],
    ),
    "points that coincide": (
        replaced(("[120, 0, 0]", "[0, 0, 0]")),
        ["job.toml:8:8: part[0].surface.p1: p1 is the same point as p0 (the two ends must differ)"],
    ),
    "a negative thickness": (
        CYLINDER + "[material]\nthickness = -2\n",
        ["job.toml:21:13: material.thickness: -2 (must be above 0)"],
    ),
    "an empty part list": (
        "schema = 1\npart = []\n",
        ["job.toml:2:8: part: an array of 0 (an array of one or more tables is needed)"],
    ),
    "no part and no schema": (
        "",
        [
            "job.toml:1:1: schema: missing (1 is needed)",
            "job.toml:1:1: part: missing (an array of one or more tables is needed)",
        ],
    ),
    "duplicate names, upper and lower case alike, beside an error in another part": (
        replaced(("g = 1", "g = 0")) + PLATE[PLATE.index("[[part]]") :].replace('"plate"', '"SHELL"'),
        [
            "job.toml:19:7: part[0].surface.g: 0 (must be above 0)",
            'job.toml:21:8: part[1].name: "SHELL" is taken (upper and lower case count as the same)',
        ],
    ),
    "duplicate stock": (
        PLATE + STOCK + STOCK,
        ['job.toml:15:6: stock[1].id: "sheet" is taken (upper and lower case count as the same)'],
    ),
    "a wrong kind": (
        replaced(('"quintic-cylinder"', '"quintic-zylinder"')),
        ['job.toml:5:10: part[0].surface.kind: unknown kind "quintic-zylinder" (did you mean "quintic-cylinder"?)'],
    ),
    "no kind": (
        replaced(('  kind = "quintic-cylinder"\n', "")),
        [
            'job.toml:4:3: part[0].surface.kind: missing (one of "quintic-ruled", "quintic-planar", '
            '"quintic-cylinder", "quintic-cone", "quintic-strip", "ruled", "flat", "cone", "cylinder")'
        ],
    ),
    "a kind that is no text": (
        replaced(('kind = "quintic-cylinder"', "kind = 3")),
        [
            'job.toml:5:10: part[0].surface.kind: unknown kind 3 (one of "quintic-ruled", "quintic-planar", '
            '"quintic-cylinder", "quintic-cone", "quintic-strip", "ruled", "flat", "cone", "cylinder")'
        ],
    ),
    "wrong words and ranges": (
        replaced(("schema = 1", 'schema = 2\nunits = "inch"'), ('name = "shell"', 'name = ""\nquantity = 0')),
        [
            "job.toml:1:10: schema: 2 is not allowed (only 1)",
            'job.toml:2:9: units: "inch" is not allowed (did you mean "in"?)',
            'job.toml:4:8: part[0].name: "" is out of range (a text from 1 to 80 characters is needed)',
            "job.toml:5:12: part[0].quantity: 0 is out of range (a whole number from 1 to 100000 is needed)",
        ],
    ),
    "control characters": (
        replaced(('"shell"', '"a\\u001bb"')),
        ['job.toml:3:8: part[0].name: "a?b" holds a control character (write plain text on one line)'],
    ),
    "a table where a value belongs, and the other way round": (
        "schema = 1\nmaterial = 3\n[units]\n[[part]]\nname = []\nsurface = 3\n",
        [
            "job.toml:2:12: material: 3 where a table belongs "
            "(a table with the keys name, thickness, density, bend_radius_min, max_strain)",
            'job.toml:3:1: units: a table is not allowed (one of "cm", "in", "m", "mm")',
            "job.toml:5:8: part[0].name: an array of 0 where a text from 1 to 80 characters belongs",
            "job.toml:6:11: part[0].surface: 3 where a table belongs (write a table with a kind)",
        ],
    ),
    "a sheet that is none": (
        PLATE + STOCK.replace("60", "0").replace("price = 12.5", 'price = -1\nkind = "hide"'),
        [
            "job.toml:12:10: stock[0].height: 0 (must be above 0)",
            "job.toml:13:9: stock[0].price: -1 (may not be negative)",
            'job.toml:14:8: stock[0].kind: "hide" is not allowed (only "sheet")',
        ],
    ),
    "wishes that no nest can grant": (
        PLATE + "[nest]\ngap = -1\nrotations = []\ntime_limit = 0\nseed = 1.5\n",
        [
            "job.toml:10:7: nest.gap: -1 (may not be negative)",
            'job.toml:11:13: nest.rotations: no angle is allowed (list at least one, such as [0], or write "free")',
            "job.toml:12:14: nest.time_limit: 0 (must be above 0)",
            "job.toml:13:8: nest.seed: 1.5 where a whole number from 0 to 2147483648 belongs",
        ],
    ),
    "a key of the future": (
        PLATE + '[process]\ntype = "laser"\n',
        [
            'job.toml:9:1: process: unknown key (one of "schema", "part", "units", "job", "material", "stock", '
            '"nest", "tolerance", "dxf", "report")'
        ],
    ),
    "a dotted key and an inline table": (
        'schema = 1\njob.nam = "x"\npart = [{ name = "a", surface = { kind = "cone", radius0 = 3, hight = 2 } }]\n',
        [
            'job.toml:2:1: job.nam: unknown key (did you mean "name"?)',
            'job.toml:3:63: part[0].surface.hight: unknown key (did you mean "height"?)',
        ],
    ),
    "a number of thousands of digits": (
        f"schema = 1\nx = {'9' * 5000}\n",
        ["job.toml:2:5: a number of thousands of digits"],
    ),
    "a number whose exponent explodes": (
        replaced(("alpha0 = 120", "alpha0 = 1e999999999")),
        [
            "job.toml:15:12: part[0].surface.alpha0: 1E+999999999 has absurdly many digits or an absurd exponent "
            f"({LENGTH})"
        ],
    ),
    "deep nesting": ("a = " + "[" * 5000 + "]" * 5000, ["job.toml: tables or arrays are nested too deeply"]),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_job_file_is_told_everything_at_once(tmp_path: Path, name: str) -> None:
    text, wanted = BAD[name]
    assert problems(tmp_path, text) == wanted


BAD_JSON: dict[str, tuple[str, list[str]]] = {
    "a wrong value": (
        '{"schema": 1,\n "part": [{"name": "a", "quantity": -1,\n  "surface": {"kind": "cone", "radius0": NaN}}]}',
        [
            "job.json:2:37: part[0].quantity: -1 is out of range (a whole number from 1 to 100000 is needed)",
            f"job.json:3:42: part[0].surface.radius0: nan is not a finite number ({LENGTH})",
        ],
    ),
    "a key that is there twice": (
        '{"schema": 1, "part": [{"name": "a",\n"name": "b", "surface": {"kind": "cone", "radius0": 3, "radius1": 1,'
        ' "height": 2}}]}',
        ["job.json:1:25: part[0].name: the key is there twice (leave one of them out)"],
    ),
    "no table": ("[1]", ["job.json:1:1: a job file is one table"]),
    "deep nesting": ("[" * 100_000, ["job.json: tables or arrays are nested too deeply"]),
}


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
        (tmp_path, "cannot be read: Is a directory"),
    ]:
        with pytest.raises(BadInputError) as caught:
            read(file)
        assert str(caught.value).endswith(message)


def test_a_flood_of_errors_is_cut_off(tmp_path: Path) -> None:
    text = PLATE + "".join(f"x{i} = 1\n" for i in range(3 * MOST_COMPLAINTS))
    assert len(problems(tmp_path, text)) == MOST_COMPLAINTS


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
