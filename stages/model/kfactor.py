"""The K-factor: how far the neutral line lies from the inside face of a bend, as a share of the thickness.

A bend by theta at the inside radius r takes the length theta (r + K t) of the flat sheet (bend allowance).  K comes as
one value, as the rule of DIN 6935 [1]_, or as a table of r/t and K with straight lines between.  DIN 6935 prints
k = 0.65 + 0.5 log10(r/t), between 0 and 1, for half the thickness: K = k / 2, and 0.5 from r/t = 5.01 on.

Rules of experience for steel, not mechanics: the true K depends on material, tool and method.

.. [1] DIN 6935, "Kaltbiegen von Flacherzeugnissen aus Stahl", 2011.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stages.geometry.arrays import Values

Rule = float | Literal["din6935"] | tuple[tuple[float, float], ...]
"""One K, DIN 6935, or rows (r/t, K) in rising order of r/t."""

MIDDLE = 0.5
"""K of a neutral line in the middle of the sheet: rolled work."""


@dataclass(frozen=True, slots=True)
class KFactor:
    """A rule for K and who gave it: the job, or nobody (`given` false: rolled work is taken for granted)."""

    rule: Rule = MIDDLE
    given: bool = False

    @property
    def convention(self) -> str:
        """Return what K means and where it is from, in words."""
        share = "K t from the inside face to the neutral line, bend allowance = angle (r + K t)"
        if self.rule == "din6935":
            return f"{share}; K = k/2 with k of DIN 6935"
        if isinstance(self.rule, tuple):
            return f"{share}; K by the job's table of r/t, straight lines between its rows"
        return f"{share}; K {'as the job gives it' if self.given else '= 0.5, rolled work (default)'}"


def k_at(rule: Rule, ratio: Values) -> Values:
    """Return K at inside radius over thickness (infinite: flat), by a rule; a table holds its ends beyond its rows."""
    if isinstance(rule, tuple):
        rows = np.array(rule)
        k: Values = np.interp(ratio, rows[:, 0], rows[:, 1])
    elif rule == "din6935":
        with np.errstate(divide="ignore"):
            k = np.clip(0.65 + 0.5 * np.log10(np.maximum(ratio, 0.0)), 0.0, 1.0) / 2.0
    else:
        k = np.full_like(ratio, rule)
    return k
