"""Two rails of one cone, a transition, an elbow, a tee, and a strip of two kinds."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from mpmath import findroot, mp, mpf

from tests import oracles
from tests.kinds.example import Pair, numbers, one, placed, point, points
from tests.kinds.plain import weighted
from tests.oracles import Space, Vec, add, cross, dot, exact
from tests.parts import Table

RAIL = [[0, 0, 0], [3, 1, "0.5"], [5, 5, 0], [4, 8, 1]]
TOP = [6, 1, 9]


def towards_top(share: object) -> list[list[str]]:
    f = Fraction(str(share))
    return [[str((1 - f) * Fraction(str(x)) + f * a) for x, a in zip(row, TOP, strict=True)] for row in RAIL]


def rails(size: Fraction) -> Table:
    """Return two curves of one cone, the second over another parameter: weights 3^i."""
    return {"kind": "rails", "rail_a": {"bezier": points(RAIL, size)},
            "rail_b": weighted(towards_top("0.6"), [1, 3, 9, 27], size)}  # fmt: skip


def rails_pairs() -> list[list[Pair]]:
    r = oracles.bezier(RAIL)
    return [[(r, oracles.toward(r, TOP, "0.6"))]]


# Ducts


def transition(size: Fraction) -> Table:
    return {"kind": "transition", "rectangle": point([4, 3], size), "round": one("2.5", size),
            "height": one("3.5", size), "offset": point(["0.5", "-0.2"], size), "tilt": 25}  # fmt: skip


def transition_pairs() -> list[list[Pair]]:
    """Tips where the side's plane touches the round: side . ((c - corner) x c') = 0, found by Newton."""
    tilt, radius = mp.radians(25), exact("1.25")
    centre, x, y = ["0.5", "-0.2", "3.5"], (radius * mp.cos(tilt), mpf(0), -radius * mp.sin(tilt)), (0, "1.25", 0)

    def arc(low: mpf, high: mpf) -> Space:
        """The round from one angle to another."""
        a, b = ([mp.cos(low) * p + mp.sin(low) * exact(q) for p, q in zip(x, y, strict=True)],
                [-mp.sin(low) * p + mp.cos(low) * exact(q) for p, q in zip(x, y, strict=True)])  # fmt: skip
        return oracles.turning(centre, a, b, (0, 0, 0), high - low)

    corners = [(2, "1.5", 0), (-2, "1.5", 0), (-2, "-1.5", 0), (2, "-1.5", 0)]

    def tip(corner: Sequence[object], near: float) -> mpf:
        def triple(t: mpf) -> mpf:
            position, slope, _ = arc(mpf(0), mpf(1))(t)
            return dot((mpf(1), mpf(0), mpf(0)), cross(add(position, numbers(corner), -1), slope))

        return findroot(triple, mpf(near))

    angles = [mpf(0), tip(corners[0], 1.6), mp.pi, tip(corners[2], 4.7), 2 * mp.pi]
    feet = [(2, 0, 0), *corners, (2, 0, 0)]
    pairs: list[Pair] = []
    for k, (p, q) in enumerate(pairwise(feet)):
        touching = arc(mpf(0), mpf(1))(angles[k])[0]
        pairs.append((oracles.bezier([p, q]), oracles.bezier_of([touching])))
        if k < len(corners):
            pairs.append((oracles.fixed(corners[k]), arc(angles[k], angles[k + 1])))
    return [pairs]


def elbow(size: Fraction) -> Table:
    return {"kind": "elbow", "diameter": one(2, size), "angle": 75, "gores": 4, "bend_radius": one("1.75", size)}


def elbow_pairs() -> list[list[Pair]]:
    """Each gore turned upright: rulings along z from mitre plane to mitre plane, from the seam on.

    At x from the axis towards the bend's own the half gore has the length (bend_radius - x) tan(mitre).
    """
    slant, bend = mp.tan(mp.radians(75) / 6), exact("1.75")

    def end(side: int, outset: int) -> Space:
        """The ellipse at one end, side = -1, 0 (square) or 1; the seam in the throat (1) or at the heel (-1)."""
        middle, lean = side * bend * slant, -side * outset * slant
        return oracles.turning((0, 0, middle), (outset, 0, lean), (0, outset, 0), (0, 0, 0), 2 * mp.pi)

    return [[(end(0 if k == 0 else -1, seam), end(0 if k == 3 else 1, seam))] for k, seam in enumerate((1, -1, 1, -1))]


def tee(size: Fraction) -> Table:
    return {"kind": "tee", "branch": one("1.2", size), "main": one(2, size), "length": one("2.6", size), "angle": 60,
            "offset": one("0.2", size)}  # fmt: skip


def tee_pairs() -> list[list[Pair]]:
    """Main along x; a point of the branch goes down its axis until y^2 + z^2 = 1."""
    angle, radius = mp.radians(60), exact("0.6")
    axis, x = (mp.cos(angle), mpf(0), mp.sin(angle)), (mp.sin(angle), mpf(0), -mp.cos(angle))
    centre = add((mpf(0), exact("0.2"), mpf(0)), axis, exact("2.6"))

    def rim(v: mpf) -> Vec:
        a = 2 * mp.pi * v
        return add(add(centre, x, radius * mp.cos(a)), (mpf(0), radius, mpf(0)), mp.sin(a))

    def saddle(v: mpf) -> Vec:
        start = rim(v)
        reach = (start[2] - mp.sqrt(1 - start[1] ** 2)) / axis[2]
        return add(start, axis, -reach)

    return [[(placed(rim), placed(saddle))]]


# Pieces of several kinds

LEFT = [[0, 1, "0.5"], ["0.1", 2, "0.5"], [2, 3, 0], [3, 0, 1]]
RIGHT = [[3, 0, 1], [4, "-4", "1.5"], [6, "-5", 2], ["6.1", "-5.2", 2]]
PEAK = [0, 0, 5]


def strip(size: Fraction) -> Table:
    """Return a cone and a cylinder along the cone's last ruling (-3, 0, 4), of 3/5 of the way to the apex."""
    first = {"kind": "cone", "apex": point(PEAK, size), "directrix": {"bezier": points(LEFT, size)},
             "fraction": [0, "0.6"]}  # fmt: skip
    second = {"kind": "cylinder", "directrix": {"bezier": points(RIGHT, size)}, "direction": [-3, 0, 4],
              "length": one(3, size)}  # fmt: skip
    return {"kind": "strip", "pieces": [first, second]}


def pieces_pairs() -> list[list[Pair]]:
    r, s = oracles.bezier(LEFT), oracles.bezier(RIGHT)
    step = numbers(["-1.8", 0, "2.4"])
    return [[(r, oracles.toward(r, PEAK, "0.6")), (s, oracles.combined(s, oracles.fixed(step)))]]
