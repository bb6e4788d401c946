"""What the construction of one kind hands back: patches, what was measured on the way, what is wrong."""

from collections.abc import Callable
from dataclasses import dataclass, field

from stages.geometry.ruled.ruled import RuledPatch
from stages.model.report import Finding, Metric


@dataclass(frozen=True, slots=True)
class Built:
    """Patches and what was measured on the way; `residual` (of the size) becomes `theorem_residual`."""

    patches: tuple[RuledPatch, ...]
    measured: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    residual: Callable[[float], float] | None = None
    detail: dict[str, object] = field(default_factory=dict)

    def metrics(self, size_mm: float) -> tuple[Metric, ...]:
        """Return the metrics, the theorem's residual among them once the size is known."""
        if self.residual is None or not size_mm > 0.0:
            return self.measured
        return (*self.measured, Metric("theorem_residual", self.residual(size_mm), "", "proved"))
