"""Files that a job names: out of its folder only where that is allowed, and nothing that is no plain file."""

import json
import os
import socket
import threading
from contextlib import closing, suppress
from pathlib import Path
from time import monotonic

import pytest

from pipeline.cli import main
from pipeline.decode import ResolveError
from pipeline.job import job_of
from pipeline.jobfile import Given, read
from pipeline.kinds import json_schema
from pipeline.layoutfile import read_layout
from pipeline.parse import read_bytes
from pipeline.reach import Reach, TooLargeError, limited, plain
from stages.errors import BadInputError
from tests.pipeline.jobs import write_job

SECRET = b"what only its owner may see"
MOST = 1000
RACED_S = 1.0
SOON_S = 20.0
"""Beyond what a busy machine takes; what waits, waits for ever."""

MESH = 'schema = 1\n[[part]]\nname = "p"\nsurface = {{ kind = "mesh", file = "{file}" }}\n'
FACE = 'schema = 1\n[[part]]\nname = "p"\nsurface = {{ kind = "face", file = "{file}" }}\n'
OUTLINE = 'schema = 1\n[[part]]\nname = "p"\nsurface = {{ kind = "flat", outline = {{ file = "{file}" }} }}\n'
NORMALS = (
    'schema = 1\n[[part]]\nname = "p"\nsurface = {{ kind = "ribbon", width = 3,'
    ' curve = {{ line = [[0, 0, 0], [9, 0, 0]] }}, normals = {{ file = "{file}" }} }}\n'
)
STOCK = OUTLINE.replace('{{ file = "{file}" }}', "{{ circle = {{ center = [0, 0], radius = 9 }} }}") + (
    '[[stock]]\nid = "s"\nfile = "{file}"\n'
)
LAYOUT = STOCK.replace('[[stock]]\nid = "s"\nfile = ', "[nest]\nlayout = ")
JOBS = {"mesh": (MESH, "a.stl"), "face": (FACE, "a.step"), "outline": (OUTLINE, "a.dxf"), "normals": (NORMALS, "a.stl")}
JOBS |= {"stock": (STOCK, "a.dxf"), "pieces": (STOCK, "a.json"), "layout": (LAYOUT, "a.json")}


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A folder of a job, with a secret beside it."""
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "key").write_bytes(SECRET)
    folder = tmp_path / "job"
    folder.mkdir()
    (folder / "own").write_bytes(b"own")
    return folder


def refusal(reach: Reach, name: str) -> ResolveError:
    with pytest.raises(ResolveError) as caught:
        reach.content(name, MOST, "make it smaller")
    return caught.value


@pytest.mark.parametrize("name", ["../secret/key", "own/../../secret/key", "link", "folder/key", "deep/link"])
def test_a_name_that_leads_out_is_refused_with_the_remedy(home: Path, name: str) -> None:
    (home / "link").symlink_to("../secret/key")
    (home / "folder").symlink_to("../secret")
    (home / "deep").mkdir()
    (home / "deep" / "link").symlink_to("../folder/key")
    refused = refusal(Reach(home), name)
    assert refused.message == f"{name} lies outside of the folder of the job file"
    assert refused.hint == f"copy it there, or run with --allow {home.parent / 'secret'}"
    assert Reach(home, (home.parent / "secret",)).content(name, MOST, "") == SECRET
    assert Reach(home, None).content(name, MOST, "") == SECRET


def test_a_name_without_an_end_and_one_that_is_absolute(home: Path) -> None:
    assert "outside" in refusal(Reach(home), str(home.parent / "secret" / "key")).message
    assert Reach(home).content(str(home / "own"), MOST, "") == b"own"
    assert refusal(Reach(home), "../secret/none").message.endswith("lies outside of the folder of the job file")
    assert refusal(Reach(home), "none").message == "there is no file none"


def test_a_folder_whose_name_begins_alike_is_another_one(home: Path) -> None:
    (home.parent / "job2").mkdir()
    (home.parent / "job2" / "key").write_bytes(SECRET)
    assert "outside" in refusal(Reach(home), "../job2/key").message


def test_links_within_the_folder_and_to_it_are_followed(home: Path) -> None:
    (home / "link").symlink_to("own")
    (home.parent / "other").symlink_to(home)
    assert Reach(home.parent / "other").content("link", MOST, "") == b"own"


@pytest.mark.parametrize(
    ("name", "what"), [("/dev/zero", "a device"), ("pipe", "a pipe"), ("socket", "a socket"), (".", "a folder")]
)
def test_what_is_no_plain_file_is_refused_and_not_waited_for(home: Path, name: str, what: str) -> None:
    os.mkfifo(home / "pipe")
    with closing(socket.socket(socket.AF_UNIX)) as made:
        here = Path.cwd()
        try:
            os.chdir(home)
            made.bind("socket")
        finally:
            os.chdir(here)
        start = monotonic()
        assert refusal(Reach(home, (Path("/dev"),)), name).message == f"{name} is {what}"
        with pytest.raises(BadInputError, match=f"cannot be read: it is {what}"):
            read_bytes(home / name)
        assert monotonic() - start < SOON_S


@pytest.mark.parametrize("name", ["a\0b", "\ud800", "x" * 5000, "x/" * 3000 + "x"])
def test_a_name_that_no_system_takes_is_a_problem_of_the_job(home: Path, name: str) -> None:
    assert refusal(Reach(home), name).key == "file"


def test_a_file_at_the_limit_is_read_and_one_beyond_is_not(home: Path) -> None:
    (home / "at").write_bytes(b"x" * MOST)
    (home / "beyond").write_bytes(b"x" * (MOST + 1))
    assert len(Reach(home).content("at", MOST, "")) == MOST
    refused = refusal(Reach(home), "beyond")
    assert (refused.message, refused.hint) == ("beyond is larger than 0 MB", "make it smaller")


def test_a_file_that_says_it_is_empty_is_read_no_further_than_the_limit() -> None:
    with pytest.raises(TooLargeError):
        limited(plain(Path("/proc/self/smaps")), 10)


def test_a_folder_that_is_exchanged_for_a_link_while_files_are_read_leads_nowhere(home: Path) -> None:
    inner = home / "inner"
    inner.mkdir()
    (inner / "key").write_bytes(b"own")
    over = threading.Event()

    def swap() -> None:
        while not over.is_set():
            with suppress(OSError):
                inner.rename(home / "aside")
                inner.symlink_to("../secret")
                inner.unlink()
                (home / "aside").rename(inner)

    thread = threading.Thread(target=swap)
    thread.start()
    seen, end = set(), monotonic() + RACED_S
    while monotonic() < end:
        with suppress(ResolveError):
            seen.add(Reach(home).content("inner/key", MOST, ""))
    over.set()
    thread.join()
    assert seen <= {b"own"}


@pytest.mark.parametrize("kind", JOBS)
def test_every_way_to_name_a_file_is_held_to_that(home: Path, kind: str) -> None:
    text, file = JOBS[kind]
    (home.parent / "secret" / file).write_bytes(SECRET)
    job = write_job(home, text.format(file=f"../secret/{file}"))
    with pytest.raises(BadInputError, match="lies outside of the folder of the job file"):
        read(job)
    with pytest.raises(BadInputError) as caught:
        job_of(read(job, given=Given(allow=(home.parent / "secret",))))
    assert "lies outside" not in str(caught.value), "it is no file of that format, but it may be read"


def test_there_is_no_other_way_to_name_a_file() -> None:
    tables = json.loads(json_schema())["$defs"]
    keys = {(table, key) for table, rows in tables.items() for key in rows.get("properties", ())}
    names = {(table, key) for table, key in keys if set(key.split("_")) & {"file", "path", "folder", "layout", "url"}}
    named = {(table, "file") for table in ("CurveSpec", "MeshFile", "MeshNormals", "FaceFile", "StockTable")}
    assert names - {("DxfTable", "one_file_per")} == named | {("NestTable", "layout")}


@pytest.mark.parametrize("name", ["/dev/zero", "pipe"])
def test_a_layout_that_is_no_plain_file_is_refused_and_not_waited_for(home: Path, name: str) -> None:
    os.mkfifo(home / "pipe")
    start = monotonic()
    with pytest.raises(BadInputError, match="cannot be read: it is a"):
        read_layout(home / name)
    assert monotonic() - start < SOON_S


@pytest.mark.parametrize("kind", ["mesh", "face"])
def test_a_sample_is_none_but_those_that_come_with_planish(home: Path, kind: str) -> None:
    text, file = JOBS[kind]
    (home / file).write_bytes(SECRET)
    job = write_job(home, text.format(file=f"sample:../../../../../../../..{home / file}"))
    with pytest.raises(BadInputError, match=r"no mesh|there is no file"):
        read(job)


@pytest.mark.parametrize("command", ["run", "check"])
def test_the_command_line_takes_folders(home: Path, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    (home.parent / "secret" / "a.stl").write_bytes(SECRET)
    job = write_job(home, MESH.format(file="../secret/a.stl"))
    for more, words in (
        ([], f"--allow {home.parent / 'secret'}"),
        (["--allow", str(home.parent / "secret")], "a.stl announces"),
    ):
        with pytest.raises(SystemExit) as caught:
            main([command, str(job), *more])
        assert caught.value.code == 2
        assert words in capsys.readouterr().err
