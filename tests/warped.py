"""Ruled patches that are nearly developable, for tests of the flattening by least strain."""

import random
from fractions import Fraction
from math import radians, tan

import numpy as np

from stages.geometry.arrays import Array, norm
from stages.geometry.curves.curves import Bezier, Circular, bezier, elevated
from stages.geometry.flat.flatmap import Development
from stages.geometry.ruled.ruled import RuledPatch, between
from tests.parts import EXAMPLE_2_PRINTED, patches

Strip = tuple[RuledPatch, ...]


def line(*points: tuple[object, ...]) -> Bezier:
    """The Bezier curve with these control points, numbers or texts."""
    return bezier([tuple(Fraction(str(x)) for x in point) for point in points])


def saddle(warp_deg: float, half: Fraction = Fraction(1)) -> Strip:
    """The hyperbolic paraboloid over the square of side 2 half whose normal turns so far along the middle ruling."""
    z = half * Fraction(tan(radians(warp_deg) / 2.0))
    lower, upper = [(-half, -half, z), (half, -half, -z)], [(-half, half, -z), (half, half, z)]
    return (between(bezier(lower), bezier(upper)),)


def helicoid(half_width: float, turn: float, length: float) -> Strip:
    """The strip swept by a segment that rises `length` along z and turns by `turn` rad in all."""
    x, y, z = np.eye(3)

    def rail(side: float) -> Circular:
        return Circular(np.zeros(3), side * half_width * x, side * half_width * y, length / turn * z, 0.0, turn)

    return (between(rail(-1.0), rail(1.0)),)


def shaken(strip: Strip, amount: float, seed: int = 1) -> Strip:
    """The strip with the control points of each c1 moved by up to a share of the longest ruling."""
    source = random.Random(seed)
    made = []
    for patch in strip:
        assert isinstance(patch.c1, Bezier)
        size = float(np.abs(patch.p.jet(np.linspace(0.0, 1.0, 9), 0)[0]).max())
        moved = [tuple(x + Fraction(source.uniform(-1.0, 1.0) * amount * size) for x in q) for q in patch.c1.exact]
        made.append(between(patch.c0, bezier(moved)))
    return tuple(made)


def backwards(strip: Strip) -> Strip:
    """The same strip run from its other end."""
    return tuple(between(*(bezier(c.exact[::-1]) for c in (patch.c0, patch.c1))) for patch in strip[::-1])


def exchanged(strip: Strip) -> Strip:
    """The same strip with its directrices exchanged."""
    return tuple(between(patch.c1, patch.c0) for patch in strip)


POINTED: Strip = (
    between(line((0, 0, 0), (1, 0, "0.2"), (2, "0.3", "0.2"), (3, 1, 0)),
            line((0, 2, "0.3"), (1, 2, "0.1"), (2, "1.6", "0.1"), (3, 1, 0))),
)  # fmt: skip
"""Its last ruling is a point."""
LENS: Strip = (
    between(line((0, 0, 0), (1, -1, "0.4"), (2, -1, "0.4"), (3, 0, 0)),
            line((0, 0, 0), (1, 1, "0.4"), (2, 1, "0.3"), (3, 0, 0))),
)  # fmt: skip
"""Both end rulings are points."""
CONE_AND_WARPED: Strip = (
    between(line(*[(0, 0, 0)] * 4), line((3, -2, 0), ("3.2", -1, "0.3"), ("3.2", "-0.3", "0.5"), (3, "0.3", "0.4"))),
    between(line((0, 0, 0), ("0.1", "0.5", 0), (0, 1, "0.1"), ("-0.2", "1.5", "0.3")),
            line((3, "0.3", "0.4"), ("2.8", "0.9", "0.3"), ("2.5", "1.6", "0.3"), (2, "2.4", "0.9"))),
)  # fmt: skip
"""A cone about c0, exact by itself, joined to a patch with warp."""
PINCHED: Strip = (
    *POINTED,
    between(
        line((3, 1, 0), (4, "1.3", "0.1"), (5, "1.2", "0.5")), line((3, 1, 0), (4, "0.5", "0.2"), (5, "-0.3", "0.2"))
    ),
)
"""Two patches that share a point only."""
WAIST: Strip = (
    between(line((0, 0, 0), (1, 0, "0.1")), line((0, 1, 0), (1, 1, 0))),
    between(line((1, 0, "0.1"), (2, "-0.8", "0.3")), line((1, 1, 0), (2, "1.8", "0.05"))),
)
"""Two patches whose outline has corners that point into the pattern where they join."""


def lifted(curve: Bezier, height: str) -> Bezier:
    """The curve raised to degree 8, its middle control point moved along z: unchanged at the ends to third order."""
    points = elevated(curve.exact, 8)
    x, y, z = points[4]
    return bezier([*points[:4], (x, y, z + Fraction(height)), *points[5:]])


SINGULAR_ENDS: Strip = (
    between(
        line((0, 0, 0), (1, 0, 0), (2, 3, 0), (3, 3, 0)),
        lifted(line((2, 0, 0), (3, 0, 0), (4, 3, 0), (5, 3, 0)), "0.05"),
    ),
)
"""A planar patch whose first and last rulings run along both directrices, lifted a little in between."""

HARD: dict[str, Strip] = {
    "pointed end": POINTED, "pointed start": backwards(POINTED), "both ends pointed": LENS,
    "cone before a warped patch": CONE_AND_WARPED, "warped patch before a cone": backwards(CONE_AND_WARPED),
    "cone about c1": exchanged(CONE_AND_WARPED), "two patches that share a point": PINCHED,
    "corners into the pattern": WAIST, "rulings along the directrices at both ends": SINGULAR_ENDS,
    "a saddle of 40 deg": saddle(40.0), "Example 2 as printed": patches(EXAMPLE_2_PRINTED),
}  # fmt: skip


U, V = (axis.ravel() for axis in np.meshgrid([0.0, 0.3, 0.7, 1.0], np.linspace(0.0, 1.0, 9)))


def flat(made: Development, u: Array = U, v: Array = V) -> Array:
    """Positions on a grid of every piece."""
    return np.concatenate([piece.positions(u, v) for piece in made.pieces])


def size(points: Array) -> float:
    """The diagonal of the box about points."""
    return float(norm(np.ptp(points, axis=0)))
