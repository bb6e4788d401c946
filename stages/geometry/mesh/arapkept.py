"""As rigid as possible with lengths held: the least strain among the maps that keep the edges which must keep theirs.

The energy of `arap` is minimised under the equations of `ties` by Newton's method on the conditions of Lagrange [1]_.
It starts from the minimum without ties and takes the ties there by degrees: they are asked for the lengths that they
have, then for those and a share of what is missing, then for the whole.  The share is 1 at first and halved where
Newton's steps do not shrink.  So the way leads along minima, and ends on one: in the end the second derivatives are
positive definite along all motions that keep the ties (with enough times the square of the ties added they are so along
all [2]_), or it is said that they are not.  Shoe uppers are flattened so, with the lengths of their lasting edges kept
[3]_.

.. [1] J. Nocedal, S. Wright, "Numerical Optimization", 2nd ed., 2006, section 18.1.
.. [2] G. Debreu, "Definite and semidefinite quadratic forms", Econometrica 20 (2), 1952, 295-300.
.. [3] P. Azariadis, N. Aspragathos, "Geodesic curvature preservation in surface flattening through constrained global
   optimization", Computer-Aided Design 33 (8), 2001, 581-591.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Numbers, Points2, norm
from stages.geometry.mesh.arap import Settled, Sheet, energy, free_unknowns, second, settled, slope_of, slots_of
from stages.geometry.mesh.ties import Ties, derivatives, left_sides, off_by, second_derivatives
from stages.geometry.numeric.sparsesolve import factorised

WHAT = "flattening with the lengths that are to be kept"
MOST_STEPS = 12
"""Newton's steps at one share; from a good start five are enough."""
GROWN = 2.0
"""A step longer than the one before by this leads away."""
SMALLEST = 1.0 / 64.0
"""A share of what is missing below which the ties are taken for impossible."""
KEPT = 1e-9
"""By how much of itself a kept length may be off."""
STIFF = 1e4
"""Of the squares of the ties, over the second derivatives of the energy (which are about 1): enough to see them."""


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """The triangles at rest, their ties, and what Newton's method needs to know of both."""

    rest: Sheet
    ties: Ties
    free: Numbers
    slots: tuple[csc_array, Numbers]
    still: float


def settled_with(rest: Sheet, start: Points2, ties: Ties, *, still: float) -> Settled:
    """Return the positions of least energy near `start` among those that keep the ties to `KEPT`.

    Raises NoSolutionError if the ties contradict each other or cannot be reached.
    """
    found = settled(rest, start, still=still)
    if not len(ties):
        return found
    positions, multipliers = found.positions, np.zeros(len(ties))
    problem = _Problem(rest, ties, free_unknowns(rest, positions), slots_of(rest), still)
    missing = ties.wanted - left_sides(ties, positions)
    left, share, last = 1.0, 1.0, found.step_mm
    while left > 0.0:
        share = min(share, left)
        nearer = _solved(problem, positions, multipliers, ties.wanted - (left - share) * missing)
        if nearer is None:
            share /= 2.0
            if share < SMALLEST:
                raise NoSolutionError(WHAT, reached=off_by(ties, positions), wanted=KEPT)
            continue
        (positions, multipliers, last), left, share = nearer, left - share, 2.0 * share
    if off_by(ties, positions) > KEPT or not _is_minimum(problem, positions, multipliers):
        raise NoSolutionError(f"{WHAT}: it buckles", reached=off_by(ties, positions), wanted=KEPT)
    return Settled(positions, last, energy(rest, positions))


def _solved(
    problem: _Problem, positions: Points2, multipliers: Array, wanted: Array
) -> tuple[Points2, Array, float] | None:
    """Return positions, multipliers and the length of the last step at rest, or None where the steps do not shrink."""
    last = np.inf
    for _ in range(MOST_STEPS):
        step = _step(problem, positions, multipliers, wanted)
        if step is None:
            return None
        moved, multipliers = step
        longest = float(norm(moved).max())
        if not longest <= GROWN * last:
            return None
        positions = positions + moved
        if longest <= problem.still:
            return positions, multipliers, longest
        last = longest
    return None


def _step(problem: _Problem, positions: Points2, multipliers: Array, wanted: Array) -> tuple[Points2, Array] | None:
    """Return Newton's step and the new multipliers, or None where the equations contradict each other."""
    free, ties = problem.free, problem.ties
    across = csr_array(derivatives(ties, positions)[:, free])
    whole = _bent(problem, positions, multipliers)
    system = csc_array(block_array([[whole, across.T], [across, None]]))
    right = np.concatenate([-slope_of(problem.rest, positions)[free], wanted - left_sides(ties, positions)])
    try:
        solution = splu(system, permc_spec="COLAMD").solve(right)
    except RuntimeError:
        return None
    if not np.isfinite(solution).all():
        return None
    step = np.zeros(2 * problem.rest.count)
    step[free] = solution[: len(free)]
    return step.reshape(-1, 2), np.asarray(solution[len(free) :])


def _bent(problem: _Problem, positions: Points2, multipliers: Array) -> csc_array:
    """Return the second derivatives of energy plus multipliers times ties by the free unknowns."""
    pattern, places = problem.slots
    data = np.bincount(places, second(problem.rest, positions, convex=False).ravel(), minlength=len(pattern.data))
    whole = csc_array((data, pattern.indices, pattern.indptr), shape=pattern.shape)
    whole = whole + second_derivatives(problem.ties, multipliers, problem.rest.count)
    return csc_array(csc_array(whole)[problem.free][:, problem.free])


def _is_minimum(problem: _Problem, positions: Points2, multipliers: Array) -> bool:
    """Return whether the energy rises along every motion that keeps the ties."""
    across = csr_array(derivatives(problem.ties, positions)[:, problem.free])
    stiffened = _bent(problem, positions, multipliers) + STIFF * (across.T @ across)
    return factorised(csc_array(stiffened)).positive
