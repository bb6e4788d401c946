"""What the children of a batch find loaded: all that jobs go through, whatever their kinds, and no compiler."""

import subprocess
import sys
from pathlib import Path
from pkgutil import walk_packages

import pytest

import stages

LOADED = "import sys; import pipeline.batch.warm; print(*sorted(sys.modules))"


def test_children_share_every_stage_but_the_search_of_a_nest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[3]))
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=True)
    loaded = {*done.stdout.split()}
    there = {module.name for module in walk_packages(stages.__path__, "stages.")}
    assert {name for name in there - loaded if not name.startswith("stages.nest.separation")} == set()
    assert {"scipy.interpolate", "scipy.optimize", "scipy.spatial", "ezdxf", "matplotlib"} <= loaded
    assert "numba" not in loaded
