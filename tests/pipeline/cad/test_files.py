"""CAD files of a job: which faces, what is said of files that cannot be read, and libraries that are missing."""

import random
import sys
from pathlib import Path

import pytest

from pipeline.cad import files as cadfiles
from pipeline.cad.child import Unreadable
from pipeline.cad.files import CHILD, cad_source, faces_named, read_guarded
from pipeline.cli import main
from pipeline.decode import ResolveError
from pipeline.reach import Reach
from stages.model.cadface import CadBody
from stages.model.faces import FaceFile
from tests import cad, cadrhino

JOB = """\
schema = 1
[report]
formats = ["json"]
[[part]]
name = "p"
[part.surface]
kind = "face"
"""


def refusal(folder: Path, name: str, **keys: object) -> ResolveError:
    with pytest.raises(ResolveError) as caught:
        cad_source(Reach(folder), FaceFile(file=name, **keys))  # type: ignore[arg-type]
    return caught.value


def test_one_face_all_faces_or_the_list_of_them(tmp_path: Path) -> None:
    cad.step(tmp_path / "Blech groß ä.step", cad.filleted_box())
    name = "Blech groß ä.step"
    one = cad_source(Reach(tmp_path), FaceFile(file=name, index=2))
    every = cad_source(Reach(tmp_path), FaceFile(file=name, all=True))
    assert [face.sort for face in one.body.faces] == ["cylinder"]
    assert [face.index for face in every.body.faces] == list(range(7))
    assert one.digest == every.digest
    unsaid = refusal(tmp_path, name)
    assert (unsaid.key, unsaid.message) == ("file", f"{name} holds 7 faces")
    assert unsaid.hint.startswith("say which by index, or all = true: 0 plane 2000 mm2, 1 plane 5978.54 mm2, 2 cylin")
    beyond = refusal(tmp_path, name, index=7)
    assert (beyond.key, beyond.message) == ("index", f"{name} has no face 7: it holds 7")


def test_faces_of_a_3dm_file_are_listed_by_their_extents(tmp_path: Path) -> None:
    cadrhino.rhino(tmp_path / "a.3dm", cadrhino.rhino_pipe(20.0, 50.0), unit="Inches", name="Rohr")
    hint = refusal(tmp_path, "a.3dm").hint
    assert '0 "Rohr" cylinder 1016 x 1016 x 1270 mm, 1 "Rohr" plane 1016 x 1016 x 0 mm' in hint


def test_a_file_that_is_missing_or_no_cad_file_is_refused(tmp_path: Path) -> None:
    assert refusal(tmp_path, "a.step").message == "there is no file a.step"
    assert refusal(tmp_path, "a.dwg").message == "a.dwg is no CAD file by its name"
    (tmp_path / "b.stp").mkdir()
    assert refusal(tmp_path, "b.stp").message == "b.stp is a folder"


@pytest.mark.parametrize("package", ["OCP", "rhino3dm"])
def test_a_missing_library_is_said_plainly(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    name = "a.3dm" if package == "rhino3dm" else "a.igs"
    (tmp_path / name).write_bytes(b"0")
    job = tmp_path / "job.toml"
    job.write_text(f'{JOB}file = "{name}"\n')
    with pytest.raises(SystemExit) as ended:
        main(["check", str(job)])
    assert ended.value.code == 2
    word = "3DM" if package == "rhino3dm" else "IGES"
    assert (
        f"{word} files are read by a library that is not installed (pip install planish[cad])"
        in capsys.readouterr().err
    )


def test_garbage_and_files_cut_short_are_errors_of_the_job(tmp_path: Path) -> None:
    step, iges = cad.step(tmp_path / "a.step", cad.channel()), cad.iges(tmp_path / "a.iges", cad.channel())
    for file in (step, iges):
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2])
        assert (
            f"{file.name} is no {file.suffix[1:].upper()} file that can be read: "
            in refusal(tmp_path, file.name).message
        )
    (tmp_path / "b.3dm").write_bytes(random.Random(1).randbytes(4000))
    assert refusal(tmp_path, "b.3dm").message == "b.3dm is no 3DM file that can be read: it cannot be read"


def test_a_face_that_the_library_leaves_out_is_missed(tmp_path: Path) -> None:
    file = cad.step(tmp_path / "a.step", cad.channel())
    text = file.read_bytes()
    assert faces_named(text, "step") == 5
    line = next(line for line in text.split(b";") if b"CYLINDRICAL_SURFACE" in line)
    file.write_bytes(text.replace(line, line.replace(b"CYLINDRICAL_SURFACE", b"UNHEARD_OF_SURFACE"), 1))
    assert refusal(tmp_path, "a.step").message.endswith("1 of its 5 faces are broken")


def test_the_faces_that_an_iges_file_names_are_counted(tmp_path: Path) -> None:
    content = cad.iges(tmp_path / "a.iges", cad.filleted_box()).read_bytes()
    assert faces_named(content, "iges") == 7
    assert faces_named(content[: len(content) // 2], "iges") is None
    assert faces_named(b"", "step") is None


def child(code: str) -> tuple[str, ...]:
    return sys.executable, "-P", "-c", code


def test_a_reader_that_crashes_hangs_or_says_nothing_ends_no_job() -> None:
    crashed = read_guarded(child("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"), 20.0)
    assert crashed == Unreadable("the reader crashed over it")
    assert read_guarded(child("pass"), 20.0) == Unreadable("the reader crashed over it")
    assert read_guarded(child("import time; time.sleep(60)"), 0.5) == Unreadable("reading it takes longer than 0.5 s")


@pytest.mark.parametrize("sort", ["step", "iges", "3dm"])
def test_files_damaged_anywhere_are_read_or_refused(tmp_path: Path, sort: str) -> None:
    rng = random.Random(7)
    file = tmp_path / f"a.{sort}"
    if sort == "3dm":
        cadrhino.rhino(file, cadrhino.rhino_pipe())
    else:
        (cad.step if sort == "step" else cad.iges)(file, cad.filleted_box())
    content = bytearray(file.read_bytes())
    for _ in range(30):
        content[rng.randrange(len(content))] = rng.randrange(256)
    file.write_bytes(bytes(content))
    found = read_guarded((*child(CHILD), str(file), sort), 60.0)
    assert isinstance(found, Unreadable | CadBody)


def test_stdout_holds_nothing_of_the_libraries(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    cad.iges(tmp_path / "a.iges", cad.prism([(0, 0), (60, 0), (10, 40)], 20.0))
    job = tmp_path / "job.toml"
    job.write_text(f'{JOB}file = "a.iges"\nindex = 0\n')
    capfd.readouterr()
    main(["check", str(job), "--json"])
    assert capfd.readouterr().out == '{"errors": []}\n'


def test_the_digest_of_a_job_follows_the_file(tmp_path: Path) -> None:
    from pipeline.job import job_of
    from pipeline.jobfile import read

    job = tmp_path / "job.toml"
    job.write_text(f'{JOB}file = "a.3dm"\nindex = 0\n')
    digests = []
    for radius in (20.0, 20.0, 21.0):
        cadrhino.rhino(tmp_path / "a.3dm", cadrhino.rhino_pipe(radius))
        digests.append(job_of(read(job)).digest)
    assert digests[2] not in digests[:2]
    digest = cadfiles.cad_source(Reach(tmp_path), FaceFile(file="a.3dm", index=0)).digest
    assert ("a.3dm", digest) in job_of(read(job)).inputs
