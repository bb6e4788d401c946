"""The engines, each in a child process, and the environment in which the rivals live.

One call of each as its documentation shows it, its own settings kept but for gap, seed and time.  planish and spyrrow
run from the project's own environment; the other rivals, on which planish does not depend, from one in `.bench`, made
on request.  A child that takes more than `GRACE_S` and twice its time is ended, and counts with what it told.
"""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

import msgspec

from tests.bench.nest.instances import Instance
from tests.bench.nest.layouts import Said
from tests.bench.nest.tasks import task

ROOT = Path(__file__).parents[3]
ENVIRONMENT = ROOT / ".bench" / "rivals"
PYTHON = ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
ADAPTERS = Path(__file__).with_name("rivals")

GRACE_S = 20.0
"""To start, and to end a step in hand."""


@dataclass(frozen=True, slots=True)
class Engine:
    """An engine: its name here, the module that must be there, what pip calls it (none: ours), its adapter."""

    name: str
    module: str
    package: str
    script: tuple[str, ...] = ()

    @property
    def ours(self) -> bool:
        return not self.script

    @property
    def python(self) -> str:
        """The Python that runs it."""
        return sys.executable if self.module in ("stages", "spyrrow") else str(PYTHON)

    @property
    def command(self) -> list[str]:
        """How it is started."""
        if self.ours:
            return [self.python, "-m", "tests.bench.nest.ours"]
        return [self.python, str(ADAPTERS / self.script[0]), *self.script[1:]]


ENGINES = (
    Engine("planish", "stages", "planish"),
    Engine("spyrrow", "spyrrow", "spyrrow", ("with_spyrrow.py", "1")),
    Engine("spyrrow-2", "spyrrow", "spyrrow", ("with_spyrrow.py", "2")),
    Engine("compas-collision", "compas_nest", "compas-nest==0.1.1.post5", ("with_compas_nest.py", "collision")),
    Engine("compas-nfp", "compas_nest", "compas-nest==0.1.1.post5", ("with_compas_nest.py", "nfp")),
    Engine("u-nesting", "u_nesting", "u-nesting==0.28.1", ("with_u_nesting.py",)),
)


@dataclass(frozen=True, slots=True)
class Run:
    """What an engine told, in order, and the seconds it took, by the wall and on the processor."""

    said: tuple[Said, ...]
    wall_s: float
    cpu_s: float


def install() -> None:
    """Make the environment of the rivals; one that cannot be installed leaves the others."""
    ENVIRONMENT.parent.mkdir(exist_ok=True)
    if not PYTHON.exists():
        subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
    for package in dict.fromkeys(one.package for one in ENGINES if one.python == str(PYTHON)):
        words = [str(PYTHON), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]
        if subprocess.run(words, check=False).returncode:
            print(f"{package}: not installed", file=sys.stderr)


def version(engine: Engine) -> str | None:
    """Return the version that would run, None where it is not installed."""
    if not Path(engine.python).exists():
        return None
    package = engine.package.partition("==")[0]
    ask = f"import importlib.metadata as m, {engine.module}; print(m.version('{package}'))"
    done = subprocess.run([engine.python, "-c", ask], capture_output=True, text=True, check=False, cwd=ROOT)
    return None if done.returncode else done.stdout.strip()


def run(engine: Engine, instance: Instance, seconds: float, seed: int, limit_s: float | None = None) -> Run:
    """Return what an engine tells of an instance within the time; limit_s: when to end it, if not as said above."""
    if engine.ours:
        request = pickle.dumps((instance, seconds, seed))
    else:
        request = msgspec.json.encode(task(instance, seconds, seed))
    return run_command(engine.command, request, 2.0 * seconds + GRACE_S if limit_s is None else limit_s)


def run_command(command: Sequence[str], request: bytes, limit_s: float) -> Run:
    """Return what a child tells when given a request, ended at the limit at the latest."""
    before, start = _cpu_of_children(), monotonic()
    child = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=ROOT,
        start_new_session=True,
    )
    late = False
    try:
        out, errors = child.communicate(request, timeout=limit_s)
    except subprocess.TimeoutExpired:
        late = True
        _end(child)
        out, errors = child.communicate()
    finally:
        if child.poll() is None:
            _end(child)
    wall, cpu = monotonic() - start, _cpu_of_children() - before
    said = [_decoded(line) for line in out.splitlines()]
    if child.returncode and not late:
        lines = errors.decode(errors="replace").strip().splitlines()
        said.append(Said(error=f"exit code {child.returncode}: {lines[-1] if lines else 'no message'}"))
    return Run(tuple(said), wall, cpu)


def _decoded(line: bytes) -> Said:
    """Return what a line tells; what is no answer is an error, not an end of the benchmark."""
    try:
        return msgspec.json.decode(line, type=Said)
    except msgspec.DecodeError as error:
        return Said(error=f"not understood: {error}")


def _end(child: subprocess.Popen[bytes]) -> None:
    """End a child and what it started."""
    if os.name == "nt":
        child.kill()
    else:
        os.killpg(child.pid, signal.SIGKILL)


def _cpu_of_children() -> float:
    """Return the processor seconds of all children that have ended."""
    times = os.times()
    return times.children_user + times.children_system


@contextmanager
def core_limit(cores: int) -> Iterator[int]:
    """Keep this process and its children to so many cores, where the system can; give how many they have."""
    if not hasattr(os, "sched_setaffinity"):
        yield os.cpu_count() or 1
        return
    before = os.sched_getaffinity(0)
    kept = sorted(before)[:cores]
    os.sched_setaffinity(0, kept)
    try:
        yield len(kept)
    finally:
        os.sched_setaffinity(0, before)
