"""The list: spread over packages and kinds, the same for a seed, found again in a program that has moved."""

from collections import Counter
from pathlib import Path

import pytest

from tests.mutants.drawn import COUNT, ROOT, Mutant, draw, found_again, kept, list_of, package, read_as, written
from tests.mutants.known import EQUIVALENT
from tests.mutants.operators import changes

SOURCE = b"def f(a, b):\n    x = a < b\n    return x + 1\n\n\ndef g(a, b):\n    x = a < b\n    return x - 1\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name in ("pipeline/a.py", "pipeline/batch/b.py", "stages/errors.py", "stages/model/c.py", "stages/write/d.py"):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(SOURCE)
    return tmp_path


def test_every_package_has_its_share_of_different_kinds(tree: Path) -> None:
    drawn = draw(tree, 7, 12)
    assert Counter(package(one.file) for one in drawn) == {
        "pipeline": 3, "pipeline/batch": 3, "stages/model": 3, "stages/write": 3,
    }  # fmt: skip
    for name in ("pipeline", "stages/write"):
        assert {one.kind for one in drawn if package(one.file) == name} == {"comparison", "arithmetic", "constant"}
    assert [one.number for one in drawn] == [*range(1, 13)]


def test_a_seed_draws_the_same_again_and_another_draws_others(tree: Path) -> None:
    assert draw(tree, 7, 12) == draw(tree, 7, 12) != draw(tree, 8, 12)


def test_a_list_is_read_as_it_was_written(tree: Path) -> None:
    drawn = draw(tree, 7, 12)
    (tree / "list.json").write_text(written(drawn), "utf-8")
    assert kept(tree / "list.json") == drawn


def lowest(source: bytes) -> Mutant:
    change = next(change for change in reversed(changes(source)) if change.after == "<=")
    return read_as("a.py", source, 1, change)


def test_line_and_column_are_those_of_an_editor() -> None:
    assert (lowest(SOURCE).line, lowest(SOURCE).column, lowest(SOURCE).text) == (7, 11, "x = a < b")


@pytest.mark.parametrize(("before", "moved"), [(b"", 0), (b"import os\n\n", 2)])
def test_a_mutant_is_found_where_its_line_stands_now(before: bytes, moved: int) -> None:
    """Two lines read alike: the nearer one is meant."""
    source = before + SOURCE
    change = found_again(lowest(SOURCE), source)
    assert change is not None
    assert read_as("a.py", source, 1, change).line == 7 + moved


def test_a_mutant_whose_line_was_written_anew_is_gone() -> None:
    assert found_again(lowest(SOURCE), SOURCE.replace(b"x = a < b", b"x = a < 2 * b")) is None


@pytest.mark.parametrize("number", [1, 2])
def test_a_list_that_is_kept_is_whole(number: int) -> None:
    """It is never drawn again: what it says was decided before any of it ran."""
    mutants = kept(list_of(number))
    assert [one.number for one in mutants] == [*range(1, COUNT + 1)]
    share = Counter(package(one.file) for one in mutants)
    assert max(share.values()) - min(share.values()) <= 1
    assert set(share) == {package(f"{name}/x.py") for name in packages()}
    assert set(EQUIVALENT.get(number, {})) <= {one.number for one in mutants}


def packages() -> list[str]:
    stages = [path.name for path in (ROOT / "stages").iterdir() if (path / "__init__.py").exists()]
    return ["pipeline", "pipeline/batch", "pipeline/report", *(f"stages/{name}" for name in sorted(stages))]
