"""The displacement of least strain energy on given elements, by Newton's method.

Each step solves the equations of the exact second derivatives; where these are not positive definite, or the energy
does not fall, their convex part is taken, which always leads downhill.  A step is halved until the energy falls by a
share of what the slope promises [1]_.

.. [1] J. Nocedal, S. J. Wright, "Numerical Optimization", 2nd ed., 2006, sections 3.1 and 3.4.
"""

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Values
from stages.geometry.flat.strainenergy import Sheet, Stretched, energy, gradient, hessian, stretched
from stages.geometry.numeric.bordered import assembled, gathered, solved, spread
from stages.geometry.numeric.numbering import Numbering

MOST_STEPS = 60
"""From the map along the rulings it takes 3 to 6 steps; so many mean that the sheet buckles in its plane."""
SHARE = 1e-4
"""The least share of the promised fall of energy that is taken for one: Armijo's rule."""
SHORTEST = 2.0**-30
"""A step halved so often leads nowhere."""
SUMMED = 64 * EPS
"""How far an energy is off by rounding, relative: some thousand positive terms."""


def minimised(sheet: Sheet, numbering: Numbering, start: Values, *, still: float) -> Values:
    """Return the unknowns of least energy, mm; the last step is no longer than `still` anywhere.

    Raises NoSolutionError if steps do not become as short as that, or if something is free to move.
    """
    values, at = start, stretched(sheet, spread(start, numbering))
    for _ in range(MOST_STEPS):
        slope = gathered(gradient(sheet, at), numbering)
        step = _step(sheet, numbering, at, slope)
        longest = float(np.abs(step).max(initial=0.0))
        if longest <= still:
            return np.asarray(values + step)
        values = values + _share(sheet, numbering, values, step, fall=float(slope @ step)) * step
        at = stretched(sheet, spread(values, numbering))
    raise NoSolutionError("minimum of the strain energy", reached=longest, wanted=still, unit="mm")


def _step(sheet: Sheet, numbering: Numbering, at: Stretched, slope: Values) -> Values:
    """Return a step downhill, mm."""
    for convex in (False, True):
        step = solved(assembled(hessian(sheet, at, convex=convex), numbering), -slope)
        if step is not None:
            return step
    subject = "flattening by least strain: part of the strip is free to move"
    raise NoSolutionError(subject, reached=0.0, wanted=EPS, unit="of its stiffness")


def _share(sheet: Sheet, numbering: Numbering, values: Values, step: Values, *, fall: float) -> float:
    """Return the share of the step that lowers the energy, whose slope along the step is `fall`."""
    before = energy(sheet, stretched(sheet, spread(values, numbering)))
    share = 1.0
    while share > SHORTEST:
        after = energy(sheet, stretched(sheet, spread(values + share * step, numbering)))
        if after <= before * (1.0 + SUMMED) + SHARE * share * fall:
            return share
        share /= 2.0
    raise NoSolutionError("fall of the strain energy", reached=after - before, wanted=share * fall, unit="mm2")
