"""Set-up and chores in one command each: `python3 dev.py demo`, `test`, `lint`, `types`, `imports`, `bench`, `gallery`.

`bench` is one table of planish beside what else there is, `bench nest`, `bench batch` and `bench kernels` go deeper;
`soak` kills batches, `fuzz` runs jobs that nobody would write, `mutants` plants faults; each says how with `--help`.
The standard library only, Python 3.11 or later.  The environment lies in `.venv`; its
packages are those of `requirements.lock`, checked by their hashes, through `uv` where it is on the PATH and through
venv and pip where it is not.  A stamp of lock, project file and Python version makes the second run quick.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
ENVIRONMENT = ROOT / ".venv"
PROGRAMS = ENVIRONMENT / ("Scripts" if os.name == "nt" else "bin")
PYTHON = PROGRAMS / ("python.exe" if os.name == "nt" else "python")
STAMP = ENVIRONMENT / "planish-stamp"
LOCK = ROOT / "requirements.lock"
OLDEST = (3, 11)

DEMO = "samples/hopper/job.toml", "out/hopper"
CHORES: dict[str, list[list[str]]] = {
    "demo": [["-m", "pipeline", "run", DEMO[0], "-o", DEMO[1]]],
    "test": [["-m", "pytest", "-n", "auto", "--dist", "loadfile"]],
    "lint": [["-m", "ruff", "check", "."], ["-m", "ruff", "format", "--check", "."]],
    "types": [["-m", "mypy"]],
    "imports": [["-c", "from importlinter.cli import lint_imports_command; lint_imports_command()"]],
    "gallery": [["samples/gallery.py"]],
    "bench": [["-m", "tests.bench"]],
    "bench kernels": [["-m", "pytest", "-o", "addopts=", "--benchmark-only", "tests/bench"]],
    "bench nest": [["-m", "tests.bench.nest"]],
    "bench batch": [["-m", "tests.bench.batch"]],
    "soak": [["-m", "tests.bench.soak"]],
    "fuzz": [["-m", "tests.fuzz"]],
    "mutants": [["-m", "tests.mutants"]],
}


def stamp() -> str:
    """Return what the environment is made from: lock, project file, Python."""
    digest = hashlib.sha256()
    for file in (LOCK, ROOT / "pyproject.toml"):
        digest.update(file.read_bytes())
    return f"{digest.hexdigest()} {platform.python_implementation()} {platform.python_version()}\n"


def call(*command: str | Path) -> None:
    """Run a command in the project's folder; end with its exit code if it fails."""
    code = subprocess.run([str(word) for word in command], cwd=ROOT, check=False).returncode
    if code:
        print(f"dev.py: failed with exit code {code}: {' '.join(map(str, command))}", file=sys.stderr)
        sys.exit(code)


def set_up() -> None:
    """Make `.venv` what the lock says, unless it is."""
    wanted = stamp()
    if PYTHON.exists() and STAMP.exists() and STAMP.read_text("utf-8") == wanted:
        return
    print(f"dev.py: setting up {ENVIRONMENT}", file=sys.stderr)
    STAMP.unlink(missing_ok=True)
    uv = shutil.which("uv")
    install: list[str | Path]
    if uv:
        call(uv, "venv", "--quiet", "--clear", "--python", sys.executable, ENVIRONMENT)
        install = [uv, "pip", "install", "--quiet", "--python", PYTHON]
    else:
        venv.create(ENVIRONMENT, clear=True, with_pip=True, symlinks=os.name != "nt")
        install = [PYTHON, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    call(*install, "--require-hashes", "-r", LOCK)
    call(*install, "--no-deps", "--no-build-isolation", "-e", ROOT)
    STAMP.write_text(wanted, "utf-8")


def main() -> None:
    """Set up, and do what was asked for; further words go to the last command of the chore."""
    count = 2 if " ".join(sys.argv[1:3]) in CHORES else 1
    name = " ".join(sys.argv[1 : 1 + count])
    if sys.version_info < OLDEST:
        sys.exit("dev.py: Python 3.11 or later is needed")
    if name not in CHORES:
        sys.exit(f"usage: python3 dev.py {' | '.join(CHORES)}")
    set_up()
    *before, last = CHORES[name]
    for words in (*before, [*last, *sys.argv[1 + count :]]):
        call(PYTHON, *words)
    if name == "demo":
        print(f"The report, the cut files and a picture of every part lie in {ROOT / DEMO[1]}")
        print(f"The command planish for your own parts: {PYTHON.with_name('planish')}")


if __name__ == "__main__":
    main()
