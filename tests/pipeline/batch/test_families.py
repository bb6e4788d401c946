"""A template with a table of values: a job for each row."""

import json
import pickle
from pathlib import Path

import pytest

from pipeline.batch import guard
from pipeline.batch.families import rows, settings, table_of
from pipeline.batch.journal import Place
from pipeline.batch.places import Places
from pipeline.batch.work import Limits
from stages.errors import BadInputError
from tests.pipeline.batch.inprocess import tree
from tests.pipeline.batch.runs import go

HEAD = "id,part[0].surface.k0,job.name\n"


def family(folder: Path, text: str) -> Path:
    (folder / "blade.toml").write_text("schema = 1\n")
    (folder / "rows.csv").write_text(text, encoding="utf-8", newline="")
    return folder / "rows.csv"


def names(table: Path) -> list[str]:
    return [entry.name for _, entry in rows(table_of(table, table.with_name("blade.toml")))]


def test_a_row_goes_by_its_id_or_by_its_number(tmp_path: Path) -> None:
    assert names(family(tmp_path, f"{HEAD}left,1,a\n,2,b\n\nright,3,c")) == ["left", "blade-0000002", "right"]


def test_a_cell_in_quotes_may_hold_commas_quotes_and_ends_of_lines(tmp_path: Path) -> None:
    table = table_of(family(tmp_path, f'{HEAD}a,1,"x, ""y""\nz"\nb,2,w\n'), tmp_path / "blade.toml")
    content = table.file.read_bytes()
    found = [content[entry.offset :][: entry.length] for _, entry in rows(table)]
    assert [settings(table.columns, row) for row in found] == [
        ("part[0].surface.k0=1", 'job.name=x, "y"\nz'),
        ("part[0].surface.k0=2", "job.name=w"),
    ]


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_a_quote_within_a_cell_is_a_quote_and_no_row_is_lost(tmp_path: Path, between: str) -> None:
    body = 'a,1/4",x\nb,1 1/2 in,"3"" pipe\n,""1/8"""\nc,"5""",5" by 3"\nd,2,\n'
    table = table_of(family(tmp_path, (HEAD + body).replace(",", between)), tmp_path / "blade.toml")
    content = table.file.read_bytes()
    found = [(entry, content[entry.offset :][: entry.length]) for _, entry in rows(table)]
    assert [(entry.name, entry.line) for entry, _ in found] == [("a", 2), ("b", 3), ("c", 4), ("d", 5)]
    cells = [[pair.partition("=")[2] for pair in settings(table.columns, row, between)] for _, row in found]
    wanted = [['1/4"', "x"], ["1 1/2 in", f'3" pipe\n{between}"1/8"'], ['5"', '5" by 3"'], ["2"]]
    assert cells == wanted


def test_a_row_that_quotes_have_swallowed_others_into_says_how_many(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"cannot be read: .*; its quotes take 3 lines for one row"):
        settings(("a", "b"), b'"x,1\ny,2\nz,3')


@pytest.mark.parametrize("between", [";", "\t"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_a_table_of_a_spreadsheet_is_read_whatever_stands_between_its_cells(
    tmp_path: Path, between: str, mark: str
) -> None:
    text = f'{mark}{HEAD}left,1.5,"a;b\t,x"\n,2,c\n'.replace(",", between).replace("\n", "\r\n")
    table = table_of(family(tmp_path, text), tmp_path / "blade.toml")
    content = table.file.read_bytes()
    found = list(rows(table))
    assert [entry.name for _, entry in found] == ["left", "blade-0000002"]
    cells = [settings(table.columns, content[row.offset :][: row.length], table.between) for _, row in found]
    assert cells == [("part[0].surface.k0=1.5", f"job.name=a;b\t{between}x"), ("part[0].surface.k0=2", "job.name=c")]
    assert go(tmp_path / "out", rows(table)) == ["left", "blade-0000002"]
    assert b"part[0].surface.k0=1.5" in tree(tmp_path / "out")["left/report.json"]


def test_a_table_of_one_column_is_read(tmp_path: Path) -> None:
    table = table_of(family(tmp_path, "job.name\nx\n"), tmp_path / "blade.toml")
    assert (table.columns, table.between) == (("job.name",), ",")


@pytest.mark.parametrize(
    ("encoding", "why"), [("utf-16", "it is UTF-16 text; save it as CSV in UTF-8"), ("latin-1", "not UTF-8 text; save")]
)
def test_a_table_in_another_encoding_is_refused_with_the_cure(tmp_path: Path, encoding: str, why: str) -> None:
    file = family(tmp_path, "")
    file.write_bytes("id,job.näme\n".encode(encoding))
    with pytest.raises(BadInputError, match=why):
        table_of(file, tmp_path / "blade.toml")


def test_an_empty_cell_leaves_the_template_as_it_is(tmp_path: Path) -> None:
    assert settings(("a", "b"), b",2") == ("b=2",)


@pytest.mark.parametrize(
    ("row", "why"),
    [
        (b"1", "1 cells where the table has 2 columns"),
        (b"1,2,3", "3 cells"),
        (b"\xff,1", "not UTF-8"),
        (b'"1,2', "cannot be read"),
    ],
)
def test_a_row_that_sets_nothing_says_why(row: bytes, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        settings(("a", "b"), row)


def test_a_bad_row_is_a_bad_job_and_the_others_are_run(tmp_path: Path) -> None:
    table = table_of(family(tmp_path, f"{HEAD}a,1,x\nb,1\nc,1,z\n"), tmp_path / "blade.toml")
    assert go(tmp_path / "out", rows(table)) == ["a", "c"]
    assert b"2 cells where the table has 3 columns" in tree(tmp_path / "out")["b/failure.json"]


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("a,a", 'the column "a" is there 2 times'),
        ("a b", '"a b" is no path into a job file'),
        ('"x"".y=1"', "is no path"),
        (",,", "no paths"),
        ("", "no paths"),
        ('"""\\q"""', "is no path"),
        ("id;a b", '"a b" is no path'),
        (",".join(f"c{i}" for i in range(2000)), "2000 columns"),
    ],
)
def test_a_first_row_that_is_not_one_of_paths_is_refused(tmp_path: Path, head: str, message: str) -> None:
    with pytest.raises(BadInputError, match=message.replace("[", r"\[")):
        table_of(family(tmp_path, f"{head}\n1,2\n"), tmp_path / "blade.toml")


def test_the_template_counts_towards_what_a_row_is(tmp_path: Path) -> None:
    file = family(tmp_path, f"{HEAD}a,1,x\n")
    template = tmp_path / "blade.toml"
    go(tmp_path / "out", rows(table_of(file, template)))
    assert go(tmp_path / "out", rows(table_of(file, template))) == []
    template.write_text("schema = 1 # other\n")
    assert go(tmp_path / "out", rows(table_of(file, template))) == ["a"]


def test_a_quote_that_is_not_closed_spoils_some_rows_and_not_the_table(tmp_path: Path) -> None:
    body = 'bad,1,"x\n' + "".join(f"r{i},1,y\n" for i in range(1500))
    found = names(family(tmp_path, HEAD + body))
    assert found[0] == "blade-0000001"
    assert found[-1] == "r1499"


CONE = """\
schema = 1
[[part]]
name = "bow"
[part.surface]
kind = "cone"
radius0 = 40
radius1 = 40
height = 50
"""


@pytest.mark.parametrize(
    ("head", "row", "wanted"),
    [
        ("radius0,height", "abc,40", 'part[0].surface.radius0: "abc" is not a number with a unit (a length such as'),
        ("radius0,height", "30,-40", "part[0].surface.height: -40 mm (the height may not be negative)"),
        ("radios0,height", "30,40", 'part[0].surface.radios0: unknown key (did you mean "radius0"?)'),
    ],
)
def test_a_wrong_cell_is_told_with_its_table_row_and_path(tmp_path: Path, head: str, row: str, wanted: str) -> None:
    """What crosses to the process that runs the job still knows where it was said; rows are those of a sheet."""
    columns = ",".join(f"part[0].surface.{name}" for name in head.split(","))
    file, template = tmp_path / "rows.csv", tmp_path / "cone.toml"
    file.write_text(f"{columns}\n30,40\n\n{row}\n")
    template.write_text(CONE)
    places = Places((), Limits(60.0, 1 << 30))
    found = list(rows(table_of(file, template)))
    at = [Place(0, e.name, source, e.offset, e.length, e.line, e.content, 0) for source, e in found]
    works = [pickle.loads(pickle.dumps(places.work(place, str(tmp_path / place.name))[1])) for place in at]
    places.close()
    record = guard.run(works[1])
    assert record.cause.startswith(f"{file}: row 4: {wanted}")
    (problem, *_) = json.loads((Path(works[1].draft) / "errors.json").read_text())["errors"]
    assert problem["file"] == f"{file}: row 4"
