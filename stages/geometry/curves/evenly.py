"""Places at given lengths along a chain of edges, many at once.

Along lines and arcs t grows evenly.  Along any other edge the speed is resolved on panels of t (`quadrature`), its
antiderivative is the length up to each t, and Newton's method on the panel gives the t of a length, to rounding.
What it reached is looked at: a length that it does not meet is no solution.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Indices, Values, norm
from stages.geometry.curves.arclength import speed_of
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.numeric import quadrature

STEPS = 50
ROUNDING = 1e-15
"""A step of Newton's method below this share of its panel changes nothing."""
MET = 1e-12
"""Share of an edge within which a length must be met: the quadrature of the whole is known to a tenth of that."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured(ArrayValue):
    """The length of an edge up to each t: panels by their ends, (m + 1,), and on each the series of that length, mm.

    starts: the length at the beginning of each panel, and that of the whole edge, (m + 1,).
    """

    breaks: Values
    series: Array
    starts: Values

    @property
    def length_mm(self) -> float:
        """The length of the edge."""
        return float(self.starts[-1])

    def parameters(self, lengths_mm: Values) -> Values:
        """Return the t at lengths from the beginning, each within the edge.

        Raises NoSolutionError where a length is not met.
        """
        panel: Indices = np.clip(np.searchsorted(self.starts, lengths_mm, side="right") - 1, 0, len(self.series) - 1)
        rest, own = lengths_mm - self.starts[panel], self.series[panel]
        slope: Array = np.asarray(legendre.legder(own, axis=1))
        x = np.clip(2.0 * rest / (self.starts[panel + 1] - self.starts[panel]) - 1.0, -1.0, 1.0)
        for _ in range(STEPS):
            off = _value(own, x) - rest
            rate = _value(slope, x)
            step = np.divide(off, rate, out=np.zeros_like(off), where=rate > 0.0)
            x = np.clip(x - step, -1.0, 1.0)
            if np.abs(step).max(initial=0.0) <= ROUNDING:
                break
        missed = float(np.abs(_value(own, x) - rest).max(initial=0.0))
        if missed > MET * self.length_mm:
            raise NoSolutionError("place at a length", reached=missed, wanted=MET * self.length_mm, unit="mm")
        low, high = self.breaks[panel], self.breaks[panel + 1]
        t: Values = low + (high - low) * (x + 1.0) / 2.0
        return t


def _value(series: Array, x: Values) -> Values:
    value: Values = np.einsum("nk,nk->n", legendre.legvander(x, series.shape[1] - 1), series)
    return value


def measured(edge: PlaneCurve) -> Measured:
    """Return the length of an edge up to each t.  Raises NoSolutionError where its speed is not resolved."""
    if isinstance(edge, Segment | CircularArc):
        length = float(speed_of(edge)(np.array([0.5]))[0])
        return Measured(np.array([0.0, 1.0]), np.array([[length / 2.0, length / 2.0]]), np.array([0.0, length]))
    breaks, values = quadrature.panels(lambda t: norm(edge.derivative(t))[:, None], "length along an edge")
    series = quadrature.coefficients(values)[:, :, 0] @ quadrature.ANTIDERIVATIVE.T * np.diff(breaks)[:, None] / 2.0
    whole = _value(series, np.ones(len(series)))
    return Measured(breaks, series, np.concatenate([[0.0], np.cumsum(whole)]))


def along(edges: Sequence[Measured], lengths_mm: Values) -> tuple[Indices, Values]:
    """Return the numbers of the edges and the t on them at lengths from the beginning of their chain.

    What is beyond an end of the chain lies at that end.
    """
    ends = np.concatenate([[0.0], np.cumsum([edge.length_mm for edge in edges])])
    number: Indices = np.clip(np.searchsorted(ends, lengths_mm, side="right") - 1, 0, len(edges) - 1)
    t = np.zeros(lengths_mm.size)
    for i, edge in enumerate(edges):
        here = number == i
        t[here] = edge.parameters(np.clip(lengths_mm[here] - ends[i], 0.0, edge.length_mm))
    return number, t
