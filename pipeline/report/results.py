"""`results.csv`: one row for every number of a report, RFC 4180 [1]_, UTF-8 without a mark of the byte order.

Decimals are the shortest that give the same double, truths are true and false, what is not known is empty.  Text that a
spreadsheet would take for a formula gets a leading apostrophe, which it shows or hides, and which a program takes off.

.. [1] Y. Shafranovich, "Common Format and MIME Type for Comma-Separated Values (CSV) Files", RFC 4180, 2005.
"""

import csv
import io
import json
from collections.abc import Mapping

from pipeline.report.entries import Value, entries
from pipeline.report.rows import Row, rows

COLUMNS = ("part", "stage", "metric", "value", "unit", "limit", "pass", "evidence")
FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n")
"""Beginnings that spreadsheets read as a formula, or skip on the way to one."""


def results_csv(report: Mapping[str, object]) -> bytes:
    """Return the rows of a report as JSON has it."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    writer.writerows(cells(row) for row in rows(entries(report)))
    return text.getvalue().encode()


def cells(row: Row) -> tuple[str, ...]:
    """Return the cells of a row."""
    part, stage, metric, unit, evidence = map(guarded, (row.part, row.stage, row.metric, row.unit, row.evidence))
    return (part, stage, metric, number(row.value), unit, number(row.limit), number(row.passed), evidence)


def number(value: Value) -> str:
    """Return a number as JSON has it, and nothing for what is not known."""
    return "" if value is None else json.dumps(value)


def guarded(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(FORMULAS) else text
