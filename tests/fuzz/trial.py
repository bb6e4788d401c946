"""One job file from its bytes to its output folder, watched: what it raised, what it wrote where, how long it computed.

Time is the processor's, so that a busy machine condemns no job; who waits without computing is ended from outside.
Every file that Python opens for writing, makes, renames or removes is reported by an audit hook: nothing written
outside the root goes unseen.  A name relative to an opened folder has no way out of it if it is one plain step.
"""

import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from types import FrameType

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from pipeline.store import replacement, write_files
from stages.errors import BadInputError
from tests.fuzz.grammar import Drawn

LIMIT_S = 2.0
GRACE_S = 0.5
"""The signal comes again after so long, in case a library swallows the exception."""
CODES = {0, 1, 2, 3}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGING = {"os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.symlink", "os.link", "os.truncate", "os.chmod"}


class TooLongError(BaseException):
    """The limit is reached; no `Exception`, so that no guard takes it for a fault of a file."""


@dataclass(frozen=True, slots=True)
class Fault:
    """What must not happen: sort (traceback, slow, outside, code), where in the program, the whole of it."""

    sort: str
    where: str
    text: str


class Watch:
    """What was written outside the root while it is on."""

    def __init__(self) -> None:
        self.root: str | None = None
        self.seen: list[str] = []
        sys.addaudithook(self._hook)

    def _hook(self, event: str, arguments: tuple[object, ...]) -> None:
        if self.root is None or not (event == "open" or event in CHANGING):
            return
        if event == "open":
            _, mode, flags = arguments
            if not (isinstance(flags, int) and flags & WRITING) and not set(str(mode or "")) & {*"wax+"}:
                return
        for path in arguments[:1] if event == "open" else [one for one in arguments if isinstance(one, str | bytes)]:
            text = os.fsdecode(path) if isinstance(path, str | bytes) else None
            if text is not None and not self._inside(text):
                self.seen.append(f"{event} {text}")

    def _inside(self, path: str) -> bool:
        """Return whether a path lies in the root; one plain step is relative to an opened folder."""
        if "/" not in path:
            return path not in ("", ".", "..")
        return path == "/dev/null" or os.path.normpath(path).startswith(str(self.root))


WATCH = Watch()


@contextmanager
def limited() -> Iterator[None]:
    """Raise `TooLongError` where the computing reaches the limit."""

    def ring(_signal: int, _frame: FrameType | None) -> None:
        raise TooLongError

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S, GRACE_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def exit_code(file: Path, root: Path) -> int:
    """Return the exit code of a job whose output goes below the root."""
    try:
        job = job_of(read(file))
        with replacement(root / "out", keep=[file]) as draft:
            result = run_job(job)
            _, files = outputs(result)
            write_files(draft, files)
    except BadInputError as error:
        str(error).encode()
        return 2
    return result.exit_code


def fault_of(drawn: Drawn, root: Path) -> Fault | None:
    """Return what goes wrong with a job file that is laid into a root of its own; None: nothing."""
    file = root / drawn.name
    file.write_bytes(drawn.content)
    (root / "tmp").mkdir()
    temporary, tempfile.tempdir = tempfile.tempdir, str(root / "tmp")
    WATCH.root, WATCH.seen = str(root), []
    start = process_time()
    try:
        with limited():
            code = exit_code(file, root)
    except TooLongError as error:
        return _fault("slow", error)
    except Exception as error:
        return _fault("traceback", error)
    finally:
        WATCH.root, tempfile.tempdir = None, temporary
    seconds = process_time() - start
    if seconds > LIMIT_S:
        return Fault("slow", "in one call", f"{seconds:.2f} s of computing")
    if code not in CODES:
        return Fault("code", str(code), f"exit code {code}")
    return Fault("outside", WATCH.seen[0], "\n".join(WATCH.seen)) if WATCH.seen else None


def _fault(sort: str, error: BaseException) -> Fault:
    """Return the fault of an exception: its place is the innermost line of the program."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "/tests/fuzz/" not in frame.filename]
    own = [frame for frame in frames if any(part in frame.filename for part in ("/pipeline/", "/stages/"))]
    where = " < ".join(
        f"{Path(frame.filename).stem}.{frame.name}" for frame in own[: -4 if sort == "slow" else -2 : -1]
    )
    return Fault(sort, f"{type(error).__name__} in {where}", "".join(traceback.format_exception(error)))
