"""The rigid motion that brings measured points nearest to a strip: the best fit of Gauss, sum of squares least.

Points are fitted to the surface at given heights along its normal, the faces that were touched.  A point beneath which
the surface lies counts with its distance along the normal, one beyond an edge with its whole distance: edges hold
points back, and a motion that nothing holds back (round the axis of a cylinder, between its edges) is not made.

A start is sought without knowing one: the frame given and the 24 turns that lay the principal axes of the points along
those of the surface, each drawn nearer by nearest points of a lattice [1]_.  The best of them are settled by damped
Gauss-Newton steps on the distances along the normals [2]_, and all points from the least of those, with exact feet.
Where another as good lies elsewhere, `alone` is false.  That none is better is sampled, not proved: points on a small
share of the part may find a wrong start.

.. [1] P. J. Besl, N. D. McKay, "A method for registration of 3-D shapes", IEEE PAMI 14 (1992) 239-256.
.. [2] Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", Image and Vision Computing 10
   (1992) 145-155.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from scipy.spatial.transform import Rotation

from stages.geometry.arrays import Array, ArrayValue, Points3, Values, Vector3, cross3, norm
from stages.geometry.ruled.feet import Feet, exact_feet
from stages.geometry.ruled.lattice import Off, Target, principal_axes, root_mean_square
from stages.geometry.ruled.strip import Strip

MOTIONS = 6
"""Of a rigid body: three turns, three shifts."""
MOST_TRIED = 300
"""Points, evenly taken, that starts are tried with; all are then settled from the best one."""
DRAWN = 60
"""Steps that draw a start nearer: what they do not bring near in so many is no good start."""
TRIED_STARTS, TRIED_STEPS, SETTLED_STARTS = 25, 20, 4
"""Different starts that are taken so many steps against the lattice, and the best of them that are settled."""
MOST_STEPS = 60
"""Gauss-Newton steps: near the end each squares what is left, far from it some are held back."""
EXACT_ROUNDS = 3
"""Settled again with exact feet so often at most: once, unless that brings a point to another part of the surface."""
FLAT = 1e-4
"""A motion by 1 mm that changes the root mean square of the distances by less than this, mm, is not told by points."""
STILL = 1e-12
"""A step by less than this share of the size is rounding."""
ELSEWHERE, AS_GOOD = 1e-2, 1.05
"""Two fits are different if a point lies so large a share of the size apart, and equally good up to this factor."""
ROUNDED = 1e-12
"""A root mean square that grows by less than this share has not grown."""
DAMPING, HARDER, SOFTER = 1e-6, 10.0, 0.1
"""First damping, beside the squares of what points tell of a motion; its factors after a step that failed or helped."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion3(ArrayValue):
    """A rigid motion of space, x -> turn x + shift.

    turn: shape (3, 3), a proper rotation.  shift: mm.
    """

    turn: Array
    shift: Vector3

    def moved(self, points: Points3) -> Points3:
        """Return points moved."""
        there: Points3 = points @ self.turn.T + self.shift
        return there

    @property
    def angle_rad(self) -> float:
        """Return the angle that it turns by, 0 to pi."""
        return float(Rotation.from_matrix(self.turn).magnitude())


UNMOVED = Motion3(np.eye(3), np.zeros(3))


@dataclass(frozen=True, slots=True, eq=False)
class BestFit(ArrayValue):
    """The best motion found.

    rms_mm: of the distances there.  last_step_mm: how far the last step moved any point.  free: motions of the six that
    the points do not tell.  alone: nothing as good was found elsewhere.
    """

    motion: Motion3
    rms_mm: float
    last_step_mm: float
    free: int
    alone: bool = True


def best_fit(strip: Strip, measured: Points3, heights: Values) -> tuple[BestFit, Feet]:
    """Return the motion of measured points that brings them nearest to the strip at these heights along N, mm.

    And their feet there, sought on the whole surface.
    """
    every = -(-len(measured) // MOST_TRIED)
    some, points = Target(strip, heights[::every]), measured[::every]
    found = [_settled(points, start, some.near, MOST_STEPS, some.scale) for start in _starts(some, points)]
    least = min(one.rms_mm for one in found)
    as_good = [one for one in found if one.rms_mm <= AS_GOOD * least + STILL * some.scale]
    best = min(as_good, key=lambda one: one.motion.angle_rad)
    here = best.motion.moved(points)
    apart = [float(norm(one.motion.moved(points) - here).max()) for one in as_good]
    fit, feet = _exactly(Target(strip, heights), measured, best.motion)
    return fit.replace(alone=max(apart) <= ELSEWHERE * some.scale), feet


# Starts


def _starts(target: Target, points: Points3) -> list[Motion3]:
    """Return the frame given and the best different starts that are found without it."""
    drawn = [_drawn(target, points, start) for start in [UNMOVED, *_along_axes(target, points)]]
    drawn.sort(key=lambda one: root_mean_square(target.tree.query(one.moved(points))[0]))
    tried = [
        _settled(points, one, target.rough, TRIED_STEPS, target.scale)
        for one in _different(target, points, drawn, TRIED_STARTS)
    ]
    best = [one.motion for one in sorted(tried, key=lambda one: one.rms_mm)]
    return [UNMOVED, *_different(target, points, best, SETTLED_STARTS)]


def _different(target: Target, points: Points3, motions: Iterable[Motion3], most: int) -> list[Motion3]:
    """Return the first motions that lay points elsewhere than all before, so many at most."""
    chosen: list[Motion3] = []
    for motion in motions:
        there = motion.moved(points)
        if all(norm(one.moved(points) - there).max() > ELSEWHERE * target.scale for one in chosen):
            chosen.append(motion)
    return chosen[:most]


def _along_axes(target: Target, points: Points3) -> list[Motion3]:
    """Return the 24 motions that lay the principal axes of points along those of the surface."""
    middle, own = principal_axes(points, np.full(len(points), 1.0 / len(points)))
    centre, theirs = target.axes
    turns = [theirs.T @ change @ own for change in _quarter_turns()]
    return [Motion3(turn, centre - turn @ middle) for turn in turns]


def _quarter_turns() -> list[Array]:
    """Return the 24 rotations of a cube."""
    every = [
        np.eye(3)[list(order)] * sign for order in permutations(range(3)) for sign in product((1.0, -1.0), repeat=3)
    ]
    return [one for one in every if np.linalg.det(one) > 0.0]


def _drawn(target: Target, points: Points3, start: Motion3) -> Motion3:
    """Return a start drawn nearer to the lattice."""
    motion = start
    for _ in range(DRAWN):
        _, which = target.tree.query(motion.moved(points))
        motion = _overlaid(points, target.lattice.s[which])
    return motion


def _overlaid(points: Points3, there: Points3) -> Motion3:
    """Return the motion that brings points nearest to others, one to one."""
    middle, centre = points.mean(axis=0), there.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (there - centre))
    mirror = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    turn = right.T @ mirror @ left.T
    return Motion3(turn, centre - turn @ middle)


# Settling

Look = Callable[[Points3, Values | None], Off]
"""How far points are off; the v of their feet at the step before, or None at first."""


def _settled(measured: Points3, start: Motion3, look: Look, steps: int, scale: float) -> BestFit:
    """Return where Gauss-Newton steps from a start come to rest."""
    motion, damping, last, free = start, DAMPING, np.inf, MOTIONS
    here = motion.moved(measured)
    off = look(here, None)
    for _ in range(steps):
        middle = here.mean(axis=0)
        free, turning, shift = _step(here - middle, off, damping)
        turn = Rotation.from_rotvec(turning).as_matrix()
        there = (here - middle) @ turn.T + middle + shift
        last = float(norm(there - here).max())
        if last <= STILL * scale:
            break
        fresh = look(there, off.v)
        if fresh.rms <= off.rms * (1.0 + ROUNDED):
            here, off, damping = there, fresh, damping * SOFTER
            motion = Motion3(turn @ motion.turn, turn @ (motion.shift - middle) + middle + shift)
        else:
            damping = max(damping, DAMPING) * HARDER
    return BestFit(motion, off.rms, last, free)


def _step(arms: Points3, off: Off, damping: float) -> tuple[int, Vector3, Vector3]:
    """Return how many motions are not told, and the step of the others: a rotation vector, rad, and a shift, mm."""
    reach, root = root_mean_square(norm(arms)) or 1.0, np.sqrt(len(arms))
    change = np.concatenate([cross3(arms, off.along) / reach, off.along], axis=1) / root
    left, told, right = np.linalg.svd(change, full_matrices=False)
    share = np.where(told > FLAT, told / (told**2 + damping), 0.0)
    step = -right.T @ (share * (left.T @ (off.distance / root)))
    return MOTIONS - int((told > FLAT).sum()), step[:3] / reach, step[3:]


def _exactly(target: Target, measured: Points3, start: Motion3) -> tuple[BestFit, Feet]:
    """Return the fit of all points and their feet, sought on the whole surface; no last step is known if these move."""
    found = _settled(measured, start, target.near, MOST_STEPS, target.scale)
    for _ in range(EXACT_ROUNDS):
        here = found.motion.moved(measured)
        feet = exact_feet(target.strip, here)
        sure = target.at(here, feet)
        if sure.rms >= found.rms_mm - STILL * target.scale:
            return found, feet

        def look(points: Points3, v: Values | None, sure: Off = sure) -> Off:
            return sure if v is None else target.near(points, v)

        found = _settled(measured, found.motion, look, MOST_STEPS, target.scale)
    return found.replace(last_step_mm=np.inf), exact_feet(target.strip, found.motion.moved(measured))
