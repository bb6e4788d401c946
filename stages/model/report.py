"""What a stage says of its own work: metrics, findings, a report, and the product that goes on.

A metric that has a limit passes while its value is at most the limit (a boolean passes while it equals the limit).
No clock reads here: a report is a function of the inputs.
"""

from dataclasses import dataclass, field
from typing import Generic, Literal, TypeVar

Evidence = Literal["proved", "sampled"]
Stage = Literal["construct", "verify", "unroll", "nest", "write"]
Where = dict[str, float | int | str]
T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Metric:
    """One measured number: `value` in `unit`; None where it is not defined.

    evidence: `proved` if it holds at every point or is exact, `sampled` otherwise.
    limit: what it is held against, or None.
    where: place of the extreme, such as {"piece": 0, "v": 0.2, "u": 1.0}.
    """

    name: str
    value: float | bool | None
    unit: str = ""
    evidence: Evidence = "sampled"
    limit: float | bool | None = None
    where: Where | None = None

    @property
    def passed(self) -> bool:
        """Whether the value keeps its limit."""
        if self.limit is None or self.value is None:
            return True
        if isinstance(self.limit, bool):
            return self.value == self.limit
        return self.value <= self.limit

    @property
    def margin(self) -> float | None:
        """Return the limit less the value, in `unit`; None where one of them is no number."""
        numbers = [one for one in (self.limit, self.value) if one is not None and not isinstance(one, bool)]
        return numbers[0] - numbers[1] if len(numbers) == len(("limit", "value")) else None


@dataclass(frozen=True, slots=True)
class Finding:
    """Something an engineer must know; `fatal` if the part or job cannot be made because of it."""

    code: str
    message: str
    fatal: bool = False
    where: Where | None = None


@dataclass(frozen=True, slots=True)
class StageReport:
    """What one stage found out about one subject.

    detail: further numbers by name (coefficients of a theorem, say), for whoever wants to recompute.
    """

    stage: Stage
    subject: str
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    detail: dict[str, object] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether every metric keeps its limit and no finding is fatal."""
        return all(metric.passed for metric in self.metrics) and not any(finding.fatal for finding in self.findings)

    def metric(self, name: str) -> Metric:
        """Return the metric of that name; KeyError if there is none."""
        for metric in self.metrics:
            if metric.name == name:
                return metric
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Outcome(Generic[T_co]):
    """A product, or None where the stage refuses to make one, and the report that says why."""

    product: T_co
    report: StageReport
