"""Problems of a job file as a document: `{"errors": [{file, line, column, path, message, hint}]}`."""

import json
from collections.abc import Sequence
from dataclasses import asdict

from stages.errors import Problem

ORDER = ("file", "line", "column", "path", "message", "hint")


def complaints(problems: Sequence[Problem]) -> str:
    """Return the document of some problems."""
    rows = [asdict(problem) for problem in problems]
    return json.dumps({"errors": [{key: row[key] for key in ORDER} for row in rows]}, indent=1)
