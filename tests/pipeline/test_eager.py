"""What a job loads by itself: what its kinds ask for, and not what is loaded for children that run any."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.pipeline.jobs import CONE, PLATE, write_job

ALL_THAT_IS_LOADED = """
import sys
from pipeline.__main__ import main
try:
    main()
finally:
    print(*sorted(sys.modules))
"""
UNUSED = {"numba", "matplotlib", "trimesh", "stages.nest", "stages.geometry.mesh.topology", "stages.construct.faces"}
"""What neither a plate nor a cone without stock asks for."""


@pytest.mark.parametrize(
    ("more", "unused"), [("", {"scipy"}), (CONE, {"stages.construct.rails"})], ids=["plate", "cone"]
)
def test_a_job_loads_what_its_kinds_ask_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, more: str, unused: set[str]
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    write_job(tmp_path, PLATE + more)
    command = [sys.executable, "-c", ALL_THAT_IS_LOADED, "run", "job.toml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    loaded = {*done.stdout.split()}
    assert {"ezdxf", "stages.construct.assemble"} <= loaded
    assert not (UNUSED | unused) & loaded
