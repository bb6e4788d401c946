"""Where machine code is kept: a folder of its own for each state of the sources, or nowhere."""

from math import inf, isnan
from pathlib import Path
from typing import no_type_check

import numba
import pytest

from stages.nest.separation import compiled as here
from stages.nest.separation.compiled import compiled

KERNEL = "@no_type_check\ndef kernel(x):\n    return x\n"


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of sources in place of the true ones."""
    for name in ("first", "second"):
        (tmp_path / f"{name}.py").write_text(f"# {name}\n{KERNEL}")
    (tmp_path / "state.py").write_text("NOWHERE = -2\n")
    monkeypatch.setattr(here, "HERE", tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    return tmp_path


@pytest.mark.parametrize(
    ("name", "text"), [("second", f"# second, changed\n{KERNEL}"), ("state", "NOWHERE = -3\n"), ("third", KERNEL)]
)
def test_kernels_or_their_tuples_that_change_give_another_folder(sources: Path, name: str, text: str) -> None:
    before = here._folder()
    assert here._folder() == before
    (sources / f"{name}.py").write_text(text)
    assert here._folder() != before


def test_a_source_without_kernels_may_change(sources: Path) -> None:
    before = here._folder()
    (sources / "strategy.py").write_text("# no kernel\n")
    assert here._folder() == before


def test_code_of_earlier_sources_is_removed(sources: Path) -> None:
    assert here._kept()
    before = here._folder()
    (sources / "second.py").write_text(f"# changed\n{KERNEL}")
    assert here._kept()
    assert here._folder().is_dir()
    assert not before.exists()


def test_code_is_kept_in_that_folder(sources: Path) -> None:
    assert here._kept()
    assert here._folder().is_dir()
    assert str(here._folder()) == numba.config.CACHE_DIR


def test_where_no_folder_can_be_made_no_code_is_kept(sources: Path) -> None:
    (sources / "__pycache__").write_text("a file where a folder would be")
    before = numba.config.CACHE_DIR
    assert not here._kept()
    assert before == numba.config.CACHE_DIR


def test_a_kernel_divides_by_zero_as_numpy_does_and_takes_what_checkers_of_shapes_would_refuse() -> None:
    @no_type_check
    def quotient(a, b):
        return a / b

    kernel = compiled(quotient)
    assert kernel(1.0, 0.0) == inf
    assert isnan(kernel(0.0, 0.0))
    assert kernel(1.0, 4.0) == 0.25
