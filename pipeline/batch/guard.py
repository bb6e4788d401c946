"""One job from its bytes to its files and to what became of it; nothing it does gets out of here but a `Record`.

The child that runs this is another process than the one that keeps the journal: what is worse than an exception
(a crash, an endless loop, `os._exit`) is seen there.  The memory that a job may take is what the process may map
beyond what it had mapped before (`RLIMIT_AS`, setrlimit(2)): address space, so it counts what is asked for and not
what is touched, and a process that the job starts has the same limit for itself.
"""

import resource
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from pipeline.batch import draft
from pipeline.batch.named import Named
from pipeline.batch.work import Record, Status, Work, one_line
from pipeline.complaints import complaints
from pipeline.job import job_of
from pipeline.jobfile import Given, ReadJob, read
from pipeline.outputs import outputs
from pipeline.run import JobResult, run_job
from stages.errors import BadInputError

ERRORS, TRACEBACK = "errors.json", "traceback.txt"

Files = Mapping[str, bytes]
NO_FILES: Files = {}


def run(work: Work) -> Record:
    """Run a job and return what became of it; raises nothing."""
    start = perf_counter()
    named = Named()
    try:
        record, files = _ended(work, named)
        inputs = named.inputs()
        if named.changed:
            record, files = _moved(named.changed), NO_FILES
        return replace(_kept(work, record, files), seconds=perf_counter() - start, inputs=inputs)
    except BaseException as error:
        return replace(_record("internal", _said(error)), seconds=perf_counter() - start)


def _kept(work: Work, record: Record, files: Files) -> Record:
    """Write the files of a job, and return its record with their digest; a disk that takes none is no job's fault."""
    if not files:
        return record
    try:
        return replace(record, digest=draft.write(Path(work.draft), files))
    except OSError as error:
        said = f"the files of the job could not be written: {error.strerror or error}"
        return replace(_record("crashed", said), own=False)


def _ended(work: Work, named: Named) -> tuple[Record, Files]:
    """Return how a job ended, and its files: those of a failed one say why."""
    try:
        with memory(work.limits.memory_bytes):
            result = run_job(job_of(_read(work, named)))
            _, files = outputs(replace(result, seconds={}))
            return _record(result.status, cause(result)), files
    except BadInputError as error:
        return _record("bad-input", str(error.problems[0])), {ERRORS: complaints(error.problems).encode()}
    except BaseException as error:
        if out_of_memory(error):
            megabytes = work.limits.memory_bytes / MEGABYTE
            return _record("out-of-memory", f"needs more than {megabytes:.0f} MB of memory"), NO_FILES
        told = "".join(traceback.format_exception(error))
        return _record("internal", _said(error)), {TRACEBACK: told.encode("utf-8", "replace")}


def _moved(name: str) -> Record:
    """Return the record of a job that no one can say what it was made from: it is tried again, but not for ever."""
    return _record("crashed", f"{name} has changed while the job read it")


def _record(status: Status, said: str) -> Record:
    return Record(status, one_line(said), 0.0, (), "", own=True)


def _said(error: BaseException) -> str:
    notes = "; ".join(getattr(error, "__notes__", []))
    return f"{type(error).__name__}: {error}" + (f" ({notes})" if notes else "")


def _read(work: Work, named: Named) -> ReadJob:
    """Return the job as read; note which files it names."""
    file = Path(work.file)
    given = Given(work.text, work.line, tuple(Path(folder) for folder in work.allow), named.seen)
    job = read(file, work.settings, given=given)
    return job if work.line is None else replace(job, file=file.with_name(f"{work.job}.json"))


def cause(result: JobResult) -> str:
    """Return the first finding that a job was not made for; nothing for one that was made."""
    steps = [*(step for run in result.parts for step in run.steps), result.nest, result.write]
    fatal = [(step.report.subject, finding) for step in steps for finding in step.report.findings if finding.fatal]
    failed = [f"{step.report.subject}: {step.report.stage} failed" for step in steps if step.status == "fail"]
    return next((f"{subject}: {finding.message}" for subject, finding in fatal), next(iter(failed), ""))


MEGABYTE = 2**20
PAGE = resource.getpagesize()
MAPPED = Path("/proc/self/statm")
"""Where the kernel tells how much is mapped; one that does not sets no limit here."""


@contextmanager
def memory(most_bytes: int) -> Iterator[None]:
    """Let the process map so many bytes more than now for the block; then `MemoryError` is raised."""
    if not MAPPED.exists():
        yield
        return
    before, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = _mapped_bytes() + most_bytes
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (before, hard))


def _mapped_bytes() -> int:
    return int(MAPPED.read_bytes().split()[0]) * PAGE


def out_of_memory(error: BaseException) -> bool:
    """Return whether an error is, or comes from, memory that was not to be had; C++ says std::bad_alloc."""
    seen: set[int] = set()
    now: BaseException | None = error
    while now is not None and id(now) not in seen:
        if isinstance(now, MemoryError) or "bad_alloc" in str(now):
            return True
        seen.add(id(now))
        now = now.__cause__ or now.__context__
    return False
