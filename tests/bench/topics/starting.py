"""Start-up: how long a command takes from the shell to its end, with nothing of it in memory but the files' pages.

Memory is that of the process at its peak as the system tells its parent, which is not less than the parent's own: a
figure that is no larger than that is not shown.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter

from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import ROOT, version

ABOUT = (
    "From the shell to the end of the process, modules compiled and in the page cache; memory of the whole process. "
    "The jobs write report.json and the DXF of one part; beside them a rectangle by a script of ezdxf."
)
ROUNDS: dict[Extent, int] = {"quick": 1, "usual": 7, "full": 15}
KB_PER_MB = 1024.0
JOB = 'schema = 1\n[report]\nformats = ["json"]\n[[part]]\nname = "part"\n[part.surface]\n'
PLATE = JOB + 'kind = "flat"\noutline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]] }\n'
CONE = JOB + 'kind = "cone"\nradius0 = 400\nradius1 = 125\nheight = 450\nsweep = 180\n'
RECTANGLE = (
    "import ezdxf; made = ezdxf.new('R2000'); "
    "made.modelspace().add_lwpolyline([(0, 0), (40, 0), (40, 30), (0, 30)], close=True); made.saveas('plate.dxf')"
)
QUICK = {"planish --version", "python, nothing"}
PYTHON = [sys.executable, "-c"]


def rows(asked: Asked) -> Iterator[Row]:
    """Yield how long every command takes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "plate.toml").write_text(PLATE)
        (folder / "cone.toml").write_text(CONE)
        for what, found, words in commands():
            if asked.extent != "quick" or what in QUICK:
                yield timed(what, found, words, folder, ROUNDS[asked.extent])


def commands() -> Iterator[tuple[str, str, list[str]]]:
    """Yield commands with the version of what is started."""
    planish, python = [sys.executable, "-m", "pipeline"], PYTHON
    ours, numpy, ezdxf = (version(name) for name in ("planish", "numpy", "ezdxf"))
    yield "python, nothing", sys.version.split()[0], [*python, "pass"]
    yield "planish --version", ours, [*planish, "--version"]
    yield "planish --help", ours, [*planish, "--help"]
    yield "import pipeline.cli", ours, [*python, "import pipeline.cli"]
    yield "import of all stages", ours, [*python, "import stages.construct, stages.verify, stages.unroll, stages.nest"]
    yield "import numpy", numpy, [*python, "import numpy"]
    yield "import ezdxf", ezdxf, [*python, "import ezdxf"]
    yield "smallest job to DXF: a plate", ours, [*planish, "run", "plate.toml", "--quiet"]
    yield "smallest job to DXF: a cone", ours, [*planish, "run", "cone.toml", "--quiet"]
    yield "a rectangle to DXF by ezdxf", ezdxf, [*python, RECTANGLE]


def timed(what: str, found: str, words: Sequence[str], folder: Path, rounds: int) -> Row:
    """Return how long a command takes; it is run once before it counts."""
    runs = [ended(words, folder) for _ in range(rounds + 1)][1:]
    floor, memory = own_mb(), median(size for _, size in runs)
    program = what.partition(" ")[0] if what.startswith("planish") else ("ezdxf" if "ezdxf" in what else "")
    seconds = median(each for each, _ in runs)
    return Row(what, "", program, found, None, "", seconds, memory if memory > floor else None, f"median of {rounds}")


def ended(words: Sequence[str], folder: Path) -> tuple[float, float]:
    """Return seconds and memory in MB of a command; one that fails is an error."""
    surroundings = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "", "PYTHONDONTWRITEBYTECODE": ""}
    start = perf_counter()
    child = subprocess.Popen(words, cwd=folder, env=surroundings, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    assert child.stderr is not None
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    seconds = perf_counter() - start
    child.stderr.close()
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise RuntimeError(f"{' '.join(words)}: exit code {child.returncode}: {said.decode(errors='replace')}")
    return seconds, used.ru_maxrss / KB_PER_MB


def own_mb() -> float:
    """Return the most memory that this process has used."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / KB_PER_MB
