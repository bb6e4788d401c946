"""What can go wrong, in three kinds.

A job that is wrong raises `BadInputError`: every problem of the file, each with its place and its cure.  A method that
falls short of the asked accuracy raises `NoSolutionError` with both numbers.  A surface that cannot be made is neither:
it is a `Finding` in a report.  Anything else is a defect of the program and is left uncaught.
"""

from dataclasses import dataclass


class PlanishError(Exception):
    """The base of the errors that planish raises on purpose."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing wrong with what the user gave: where it is, what was read, what would be right."""

    message: str
    path: str = ""
    hint: str = ""
    file: str = ""
    line: int | None = None
    column: int | None = None

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        text = ": ".join(part for part in (place, self.path, self.message) if part)
        return f"{text} ({self.hint})" if self.hint else text


class BadInputError(PlanishError):
    """The usage or the job file is wrong; carries every problem found, not the first."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems


class NoSolutionError(PlanishError):
    """A method fell short: what it was about, the figure reached, the figure wanted, and their unit."""

    def __init__(self, subject: str, *, reached: float, wanted: float, unit: str = "") -> None:
        super().__init__(f"{subject}: reached {reached:g} {unit}, wanted {wanted:g} {unit}".replace(" ,", ","))
        self.subject = subject
        self.reached = reached
        self.wanted = wanted
        self.unit = unit

    def __reduce__(self) -> tuple[object, ...]:
        return _no_solution, (self.subject, self.reached, self.wanted, self.unit)


def _no_solution(subject: str, reached: float, wanted: float, unit: str) -> NoSolutionError:
    return NoSolutionError(subject, reached=reached, wanted=wanted, unit=unit)
