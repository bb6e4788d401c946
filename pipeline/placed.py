"""Complaints about the tables of a file as problems with line and column, in the order of the file."""

from collections.abc import Sequence
from pathlib import Path as FilePath

from pipeline.decode import Complaint
from pipeline.locate import Place, nearest, places
from pipeline.parse import SET, is_json
from pipeline.paths import Path, written
from stages.errors import Problem


def placed(complaints: Sequence[Complaint], text: str, file: FilePath, set_paths: Sequence[Path] = ()) -> list[Problem]:
    """Return complaints about a file of that text as problems; those of `--set` have no place in it."""
    try:
        found = places(text, is_json=is_json(file), wanted=[complaint.path for complaint in complaints])
    except RecursionError:
        found = {}
    problems = [_problem(complaint, nearest(found, complaint.path), str(file), set_paths) for complaint in complaints]
    return sorted(problems, key=lambda problem: (problem.file, problem.line or 0, problem.column or 0))


def _problem(complaint: Complaint, place: Place | None, file: str, set_paths: Sequence[Path]) -> Problem:
    """Return one complaint with the file and place it comes from, or `--set`."""
    path = written(complaint.path)
    if any(complaint.path[: len(given)] == given for given in set_paths):
        return Problem(complaint.message, path=path, hint=complaint.hint, file=SET)
    line, column = (None, None) if place is None else place.key if complaint.at == "key" else place.value
    return Problem(complaint.message, path=path, hint=complaint.hint, file=file, line=line, column=column)
