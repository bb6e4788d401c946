"""Which features of a divided part lie on one of its blanks, and which a cut would go through.

By v where a feature has a place or a curve on the surface; a hole that is round about its place, in the pattern or
drilled, by its flat edges against the end rulings of the blank.  Curves are asked at points: one that reaches beyond a
cut between two of them is taken for on the blank, and told by its web (`webs`).
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from stages.geometry.arrays import Values, cross2
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.flatmap import Development
from stages.model.report import Finding
from stages.model.surface import Placed

SAMPLES = 257
"""Points of each edge that are asked: between them a smooth edge strays from its chords by some 2e-6 of its size."""
ON_CUT = 1e-9
"""How far beyond an end of the blank, in v, a curve may run by rounding."""

Share = Literal["on", "off", "cut"]


def share_of(one: Placed, knots: Values) -> Share:
    """Return whether a feature lies on a blank, off it, or partly so, by its v."""
    low, high = knots[0], knots[-1]
    if one.at is not None:
        return "on" if low <= one.at[1] <= high else "off"
    v = np.concatenate([edge.at(np.linspace(0.0, 1.0, SAMPLES)) for edge in one.curve])[:, 1]
    inside = (v >= low - ON_CUT) & (v <= high + ON_CUT)
    return "on" if inside.all() else "cut" if inside.any() else "off"


def cut_through(one: Placed) -> Finding:
    """Refuse a feature that two blanks would share."""
    message = f"{one.name} lies on both sides of a ruling along which the part is divided"
    return Finding("feature-cut", message, fatal=True, where={"feature": one.name})


def crosses_end(edges: Sequence[PlaneCurve], development: Development) -> bool:
    """Return whether flat edges cross the first or the last ruling of a blank."""
    u, flat = np.array([0.0, 1.0]), development.pieces
    ends = (flat[0].positions(u, np.zeros(2)), flat[-1].positions(u, np.ones(2)))
    t = np.linspace(0.0, 1.0, SAMPLES)
    around = np.concatenate([edge.at(t) for edge in edges])
    sides = [cross2(end[1] - end[0], around - end[0]) for end in ends]
    return any(bool(side.min() < 0.0 < side.max()) for side in sides)
