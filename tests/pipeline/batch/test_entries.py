"""What the command line names, as jobs: ids, places, digests."""

from hashlib import sha256
from pathlib import Path

import pytest

from pipeline.batch.entries import Entry, entries, job_id
from pipeline.parse import LARGEST_FILE
from stages.errors import BadInputError


def names(*paths: Path) -> list[str]:
    return [entry.name for _, entry in entries(paths)]


def test_a_folder_gives_its_job_files_at_any_depth_in_order(tmp_path: Path) -> None:
    for name in ("b.toml", "a/job.toml", "a/.hidden.toml", ".git/x.toml", "a/stock.json", "c.jsonl"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("{}")
    assert names(tmp_path) == ["a-job", "b", "c-0000001"]


def test_the_output_of_a_batch_inside_a_folder_of_jobs_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "journal.sqlite").write_text("")
    (tmp_path / "out" / "b.toml").write_text("")
    assert names(tmp_path) == ["a"]


def test_a_link_to_a_folder_is_not_entered(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("")
    (tmp_path / "loop").symlink_to(tmp_path)
    assert names(tmp_path) == ["a"]


def test_a_glob_finds_json_files_too_and_in_order(tmp_path: Path) -> None:
    for name in ("z.json", "y.json"):
        (tmp_path / name).write_text("{}")
    assert names(tmp_path / "*.json") == ["y", "z"]


def test_lines_are_places_in_their_file(tmp_path: Path) -> None:
    file = tmp_path / "many.jsonl"
    file.write_bytes(b'{"a": 1}\n\n  {"b": 2} \r\n{"c": 3}')
    content = file.read_bytes()
    found = [entry for _, entry in entries([file])]
    assert [content[each.offset :][: each.length] for each in found] == [b'{"a": 1}', b'{"b": 2}', b'{"c": 3}']
    assert [each.line for each in found] == [1, 3, 4]
    assert [each.name for each in found] == ["many-0000001", "many-0000003", "many-0000004"]
    texts = (b'{"a": 1}', b'{"b": 2}', b'{"c": 3}')
    assert [each.content for each in found] == [sha256(text).digest() for text in texts]


def test_a_line_too_long_ends_at_the_cap_and_the_next_one_is_where_it_was(tmp_path: Path) -> None:
    file = tmp_path / "long.jsonl"
    file.write_bytes(b"x" * (2 * LARGEST_FILE + 7) + b'\n{"b": 2}\n')
    long, short = (entry for _, entry in entries([file]))
    assert long.length == LARGEST_FILE + 1
    assert short == Entry("long-0000002", 2 * LARGEST_FILE + 8, 8, 2, sha256(b'{"b": 2}').digest())


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("../../etc/passwd", "etc-passwd"),
        ("con", "_con"),
        ("journal.sqlite-wal", "_journal.sqlite-wal"),
        (".lock", "lock"),
        ("Öse", "Ose"),
        ("a\x00b", "a-b"),
        ("", "unnamed"),
    ],
)
def test_an_id_is_a_name_that_every_system_takes(name: str, safe: str) -> None:
    assert job_id(name) == safe


def test_long_ids_differ_where_the_names_do() -> None:
    one, other = job_id("a" * 300 + "1"), job_id("a" * 300 + "2")
    assert one != other
    assert len(one) == len(other) == 60


def test_all_paths_that_name_no_job_are_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("")
    with pytest.raises(BadInputError) as caught:
        entries([tmp_path / "none.toml", tmp_path / "*.json", tmp_path / "notes.txt"])
    assert [problem.message for problem in caught.value.problems] == [
        "no such file or folder",
        "nothing matches",
        "no job file by its name",
    ]
