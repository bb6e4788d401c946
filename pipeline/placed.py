"""Complaints about the tables of a file as problems with line and column, in the order of the file."""

from collections.abc import Sequence
from pathlib import Path as FilePath

from pipeline.decode import Complaint
from pipeline.locate import Place, nearest, places
from pipeline.parse import is_json
from pipeline.paths import Path, written
from stages.errors import Problem


def placed(
    complaints: Sequence[Complaint], text: str, file: FilePath, set_paths: dict[Path, str] | None = None
) -> list[Problem]:
    """Return complaints about a file of that text as problems; what was set has no place in it, but an origin."""
    try:
        found = places(text, is_json=is_json(file), wanted=[complaint.path for complaint in complaints])
    except RecursionError:
        found = {}
    origins = set_paths or {}
    problems = [_problem(complaint, nearest(found, complaint.path), str(file), origins) for complaint in complaints]
    return sorted(problems, key=lambda problem: (problem.file, problem.line or 0, problem.column or 0))


def _problem(complaint: Complaint, place: Place | None, file: str, set_paths: dict[Path, str]) -> Problem:
    """Return one complaint with the file and place it comes from, or with what set it: the last that did."""
    path = written(complaint.path)
    origin = next((set_paths[given] for given in reversed(set_paths) if complaint.path[: len(given)] == given), None)
    if origin is not None:
        return Problem(complaint.message, path=path, hint=complaint.hint, file=origin)
    line, column = (None, None) if place is None else place.key if complaint.at == "key" else place.value
    return Problem(complaint.message, path=path, hint=complaint.hint, file=file, line=line, column=column)
