"""Where a run of the benchmark is made, and the versions of what it compares."""

import os
import subprocess
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed
from pathlib import Path

from tests.bench.rows import Asked
from tests.bench.tables import Heading

ROOT = Path(__file__).parents[2]
PACKAGES = ("numpy", "scipy", "numba", "shapely", "ezdxf", "libigl", "spyrrow", "distributed")


def heading(asked: Asked) -> Heading:
    """Return date, machine, load before the run, and versions."""
    from tests.bench.nest.table import machine, today

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    load = f"{cores} cores, load {os.getloadavg()[0]:.1f} before" if hasattr(os, "getloadavg") else f"{cores} cores"
    versions = ", ".join(f"{name} {found}" for name in PACKAGES if (found := version(name)))
    extent = {"quick": "Small sizes only", "usual": "Usual sizes", "full": "All sizes"}[asked.extent]
    return Heading(today(), machine(), load, f"planish {version('planish')}{commit()}, {versions}.", extent)


def version(package: str) -> str:
    """Return the version of a package; nothing where it is not installed."""
    try:
        return installed(package)
    except PackageNotFoundError:
        return ""


def commit() -> str:
    """Return the commit that is measured, where that can be told."""
    words = ["git", "describe", "--always", "--dirty", "--abbrev=9"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=ROOT)
    except OSError:
        return ""
    return f" ({done.stdout.strip()})" if done.returncode == 0 else ""
