"""A mutant counts as killed where a test fails or hangs with it, and with it alone."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutants import trial
from tests.mutants.drawn import Mutant, found_again, read_as
from tests.mutants.operators import changes
from tests.mutants.running import Ended
from tests.mutants.trial import Verdict, parts, planted, tried

SOURCE = b"def larger(a, b):\n    return a if a > b else b\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    (tmp_path / "stages").mkdir()
    (tmp_path / "stages" / "__init__.py").write_text("")
    (tmp_path / "stages" / "x.py").write_bytes(SOURCE)
    return tmp_path


@pytest.fixture
def mutant() -> Mutant:
    change = next(change for change in changes(SOURCE) if change.after == "<=")
    return read_as("stages/x.py", SOURCE, 1, change)


def answers(monkeypatch: pytest.MonkeyPatch, *ends: Ended) -> list[tuple[str, ...]]:
    """Let runs of tests end so, one after the other; return what they are asked."""
    asked: list[tuple[str, ...]] = []
    waiting = list(ends)

    def ended(tree: Path, words: list[str], seconds: float) -> Ended:
        asked.append((("mutant" if b"<=" in (tree / "stages/x.py").read_bytes() else "plain"), *words))
        return waiting.pop(0)

    monkeypatch.setattr(trial, "run", ended)
    return asked


def test_what_fails_with_the_mutant_and_passes_without_kills_it(
    monkeypatch: pytest.MonkeyPatch, tree: Path, mutant: Mutant
) -> None:
    asked = answers(monkeypatch, Ended("failed", "t::a", 4, 1.0), Ended("passed", "", 1, 1.0))
    assert tried(tree, mutant, ["t"], 60.0) == Verdict(1, "killed", "t::a", 4)
    assert asked == [("mutant", "t"), ("plain", "t::a")]


def test_what_fails_without_it_as_well_is_left_out(monkeypatch: pytest.MonkeyPatch, tree: Path, mutant: Mutant) -> None:
    broken = Ended("failed", "t::a", 0, 1.0)
    asked = answers(monkeypatch, broken, broken, Ended("passed", "", 9, 1.0))
    assert tried(tree, mutant, ["t"], 60.0) == Verdict(1, "survived", "", 9, whole=False)
    assert asked[-1] == ("mutant", "t", "--deselect=t::a")


@pytest.mark.parametrize(("seconds", "verdict"), [(1.0, "timed out"), (0.5 * trial.SILENT_S, "survived")])
def test_what_hangs_kills_it_only_where_the_test_is_quick_without_it(
    monkeypatch: pytest.MonkeyPatch, tree: Path, mutant: Mutant, seconds: float, verdict: str
) -> None:
    hung, without = Ended("silent", "t::a", 2, 240.0), Ended("passed", "", 1, seconds)
    answers(monkeypatch, hung, without, Ended("passed", "", 3, 1.0))
    assert tried(tree, mutant, ["t"], 600.0).verdict == verdict


def test_what_all_tests_pass_survives(monkeypatch: pytest.MonkeyPatch, tree: Path, mutant: Mutant) -> None:
    tests = [f"t{i}" for i in range(20)]
    asked = answers(monkeypatch, *[Ended("passed", "", 5, 1.0)] * 3)
    assert tried(tree, mutant, tests, 60.0) == Verdict(1, "survived", "", 15, whole=True)
    assert [len(words) - 1 for words in asked] == [3, 12, 5]


def test_what_outlives_its_time_survives_and_not_whole(
    monkeypatch: pytest.MonkeyPatch, tree: Path, mutant: Mutant
) -> None:
    answers(monkeypatch, Ended("spent", "t::a", 7, 60.0))
    assert tried(tree, mutant, ["t"], 60.0) == Verdict(1, "survived", "", 7, whole=False)


def test_a_mutant_whose_place_is_no_more_is_gone(tree: Path, mutant: Mutant) -> None:
    (tree / "stages" / "x.py").write_text("")
    assert tried(tree, mutant, [], 60.0) == Verdict(1, "gone")
    (tree / "stages" / "x.py").unlink()
    assert tried(tree, mutant, [], 60.0) == Verdict(1, "gone")


def test_all_tests_are_asked_once_the_likeliest_first() -> None:
    tests = [str(i) for i in range(40)]
    assert [one for some in parts(tests) for one in some] == tests
    assert list(parts(["a"])) == [["a"]] and not list(parts([]))


def test_a_planted_file_is_never_taken_for_the_one_before_it(tree: Path, mutant: Mutant) -> None:
    """Same length, same second: byte code would be mistaken by its stamp but for the time that is set."""
    change = found_again(mutant, SOURCE)
    assert change is not None
    ask = [sys.executable, "-c", "from stages.x import larger; print(larger(1, 2))"]

    def said() -> str:
        where = os.environ | {"PYTHONPATH": str(tree)}
        return subprocess.run(ask, env=where, cwd=tree, capture_output=True, text=True, check=True).stdout.strip()

    before = said()
    with planted(tree, mutant, change):
        within = said()
    assert (before, within, said()) == ("2", "1", "2")
    assert (tree / "stages" / "x.py").read_bytes() == SOURCE
