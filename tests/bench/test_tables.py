"""The tables of the benchmark: every figure as it is, anchors that stay, a failure that is told."""

import os

import pytest

from tests.bench.__main__ import parsed
from tests.bench.rows import Asked, Row, Section, identity
from tests.bench.sections import alone, section
from tests.bench.tables import HEADS, Heading, as_markdown, as_text, cells, longer, number

ROW = Row("right cone", "128 rulings", "triangle strip", "1.2", 1.6e-05, "of the size", 0.0123, 4.6, "median of 5")
HEAD = Heading("2026-01-02", "a machine", "2 cores, load 0.1 before", "planish 0.1.0.", "Usual sizes", 9.6)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0, "0"),
        (50.0, "50"),
        (1023, "1023"),
        (1.62e-5, "1.62e-05"),
        (86.789, "86.79"),
        (1234.6, "1235"),
        (2e7, "2e+07"),
    ],
)
def test_figures_have_three_or_four_digits_and_whole_numbers_all(value: float, shown: str) -> None:
    assert number(value) == shown


def test_a_row_is_shown_with_its_units() -> None:
    assert cells(ROW) == (
        "right cone", "128 rulings", "triangle strip 1.2", "1.6e-05 of the size", "12.3 ms", "5 MB", "median of 5",
    )  # fmt: skip
    assert cells(Row("a", "", "b", "", seconds=12.34))[3:6] == ("", "12.34 s", "")


def test_a_row_is_known_by_what_it_is_and_not_by_its_version() -> None:
    assert identity("unroll", ROW) == "unroll-right-cone-128-rulings-triangle-strip"
    assert identity("unroll", ROW._replace(version="2", figure=1.0)) == identity("unroll", ROW)


def test_both_forms_say_where_and_hold_every_row_and_every_failure() -> None:
    sections = [Section("unroll", "How far.", (ROW,)), Section("dxf", "How many.", (), "OSError: disk")]
    plain, page = as_text(HEAD, sections), as_markdown(HEAD, sections)
    for made in (plain, page):
        assert all(word in made for word in (*HEAD[:4], "10 minutes", *cells(ROW), "FAILED: OSError: disk"))
    assert '| <a id="unroll-right-cone-128-rulings-triangle-strip"></a>right cone | 128 rulings |' in page
    rows = [line for line in page.splitlines() if line.startswith("|")]
    assert {line.count("|") for line in rows} == {len(HEADS) + 1}


def test_a_bar_in_a_cell_does_not_end_it() -> None:
    page = as_markdown(HEAD, [Section("dxf", "", (ROW._replace(how="a | b"),))])
    assert r"a \| b" in page


def test_a_topic_that_fails_keeps_its_rows_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.bench.topics import starting

    def rows(_asked: Asked):
        yield ROW
        raise OSError("disk")

    monkeypatch.setattr(starting, "rows", rows)
    assert section("start-up", Asked("quick")) == Section("start-up", starting.ABOUT, (ROW,), "OSError: disk")


def test_a_topic_runs_in_a_process_of_its_own() -> None:
    found = alone("start-up", Asked("quick"))
    assert (found.failed, len(found.rows)) == ("", 2)


def gone(_name: str, _asked: Asked) -> Section:
    os._exit(3)


def test_a_topic_whose_process_ends_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.bench.sections.section", gone)
    assert alone("start-up", Asked("quick")).failed.startswith("its process ended: ")


def test_a_page_of_a_part_of_the_topics_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["--write", "x.md", "--only", "dxf"], ["--write", "x.md", "--quick"]):
        with pytest.raises(SystemExit):
            parsed(words)
        assert "--write keeps one run of all topics" in capsys.readouterr().err


def test_what_other_commands_measured_stays_on_the_page() -> None:
    page = as_markdown(HEAD, [Section("unroll", "far from exact", (ROW,))])
    assert longer(page) == ""
    assert longer("") == ""
    end = "\n## Longer runs\n\n| a | 1 s |\n"
    assert longer(page + end) == end
