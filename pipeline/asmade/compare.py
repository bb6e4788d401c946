"""`compare`: what was measured of made parts beside what the job asked for, and what that says for the tables.

A reading passes if it differs from nominal by no more than its tolerance, computed in decimals, not in doubles: what is
printed on its limit is on its limit.  A verdict is `sure` if it stays the same at both ends of the instrument's
uncertainty [1]_.  A failed reading that two neighbouring digits exchanged would put right is said to look like that.

.. [1] ISO 14253-1, "Decision rules for verifying conformity or nonconformity with specifications".
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.asmade.fits import Offer, offers
from pipeline.asmade.nominal import Nominal, nominal_of
from pipeline.asmade.rows import Measured, Reading, exact
from pipeline.asmade.sheet import read_sheet
from stages.errors import BadInputError, Problem

if TYPE_CHECKING:
    from pipeline.asmade.points import Cloud
    from pipeline.job import Job

FAR = 3
"""Tolerances that a reading must be off before exchanged digits are suspected: nearer, some exchange fits by chance."""


@dataclass(frozen=True, slots=True)
class Compared:
    """A reading with its verdict, mm or degrees.  passed, sure: None without a tolerance."""

    reading: Reading
    difference: Fraction
    passed: bool | None
    sure: bool | None
    slip: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """Everything that was measured, beside what was asked for."""

    nominal: Nominal
    dimensions: tuple[Compared, ...]
    clouds: "tuple[Cloud, ...]"
    offers: tuple[Offer, ...]
    left: int

    @property
    def failed(self) -> int:
        """Return how many readings and points are out of tolerance."""
        return sum(passed is False for passed in self._verdicts())

    @property
    def unjudged(self) -> int:
        """Return how many readings and points no tolerance is known of."""
        return sum(passed is None for passed in self._verdicts())

    @property
    def count(self) -> int:
        """Return how many readings and points there are."""
        return sum(1 for _ in self._verdicts())

    def _verdicts(self) -> Iterator[bool | None]:
        yield from (one.passed for one in self.dimensions)
        yield from (point.passed for cloud in self.clouds for point in cloud.points)


def comparison(out: Path, sheet: Path, job: "Job | None", *, fitted: bool = False) -> Comparison:
    """Return a sheet of measurements beside the job of an output folder.

    job: the job file read again, needed for points.  fitted: the points of a copy are moved to where they lie best.
    Raises `BadInputError`.
    """
    nominal = nominal_of(out)
    measured = read_sheet(sheet, nominal)
    dimensions = tuple(compared(one) for one in measured.readings)
    found = _clouds(measured, nominal, job, str(sheet), fitted=fitted)
    return Comparison(nominal, dimensions, found, offers(measured, nominal), measured.left)


def _clouds(
    measured: Measured, nominal: Nominal, job: "Job | None", sheet: str, *, fitted: bool
) -> "tuple[Cloud, ...]":
    if not measured.points:
        if fitted:
            raise BadInputError(Problem("there are no points to fit", "x", "leave --best-fit out", sheet))
        return ()
    if job is None:
        hint = "add --job JOB.toml, the job file of this folder: a report holds no surfaces"
        raise BadInputError(Problem("points need the surfaces of the parts", "x", hint, sheet, measured.points[0].line))
    from pipeline.asmade.points import clouds

    return clouds(measured.points, nominal, job, sheet, fitted=fitted)


def compared(one: Reading) -> Compared:
    """Return a reading with its verdict."""
    difference = one.measured - exact(one.of.nominal)
    if one.tolerance is None:
        return Compared(one, difference, None, None, "")
    passed = abs(difference) <= one.tolerance
    margin = abs(abs(difference) - one.tolerance)
    sure = one.uncertainty <= margin if passed else one.uncertainty < margin
    return Compared(one, difference, passed, sure, "" if passed else slip(one))


def slip(one: Reading) -> str:
    """Return the reading with two neighbouring digits exchanged that is within tolerance; empty: there is none."""
    text, limit = one.text, one.tolerance
    if limit is None or abs(one.measured - exact(one.of.nominal)) <= FAR * limit:
        return ""
    for i in range(len(text) - 1):
        a, b = text[i], text[i + 1]
        if a.isdigit() and b.isdigit() and a != b:
            other = text[:i] + b + a + text[i + 2 :]
            if abs(Fraction(other) * one.per_unit - exact(one.of.nominal)) <= limit:
                return other
    return ""


FILE = "compare.json"
SCHEMA = "planish-compare/1"


def keep(file: Path, content: bytes) -> None:
    """Write a comparison, in place of an earlier one only; `BadInputError` for what is another file or cannot be."""
    hint = "choose another with -o"
    try:
        if file.exists() and not _is_ours(file.read_bytes()):
            raise BadInputError(Problem("is there already, and is no comparison", hint=hint, file=str(file)))
        file.write_bytes(content)
    except OSError as error:
        raise BadInputError(Problem(f"cannot be written: {error.strerror}", hint=hint, file=str(file))) from None


def _is_ours(content: bytes) -> bool:
    try:
        found = json.loads(content)
    except (ValueError, RecursionError):
        return False
    return isinstance(found, dict) and found.get("schema") == SCHEMA
