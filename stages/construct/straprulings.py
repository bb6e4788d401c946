"""Which way the rulings of a strap run over each piece of its centre line.

Where a piece bends, by the Frenet apparatus (`envelope`).  Where its curvature vanishes at places, the rulings go on
through them if the torsion vanishes as well, to the same order or higher (`inflection`): of a plane piece always.  Over
straight pieces the strap is plane; its rulings turn evenly from those of the piece before to those of the piece after,
or stay parallel at an end of the strap.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from stages.construct.bands import PLACES, least, place, positions
from stages.geometry.arrays import EPS, Vector3, cross3, diagonal, dot, norm, unit
from stages.geometry.curves.curves import Bezier, Curve, RationalBezier, affine, bezier, exactly
from stages.geometry.curves.tangents import turn_between
from stages.geometry.ruled.envelope import Rectifying, bend
from stages.geometry.ruled.inflection import bending, through
from stages.model.report import Finding
from stages.model.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class RunsOff:
    """Where on a piece the rulings of a strap run off along its centre line."""

    poles: tuple[float, ...]


def plane_normal(curves: Sequence[Curve]) -> Vector3 | None:
    """Return the unit normal of the plane that the curves lie in, towards B where they bend most; None without one.

    Straight curves lie in no one plane.
    """
    points = positions(curves)
    middle = points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points - middle)
    if spread[1] <= FLAT * spread[0] or spread[2] > FLAT * spread[0]:
        return None
    normal = np.where(np.abs(axes[2]) <= EPS, 0.0, axes[2])
    towards = max((_binormal(curve) for curve in curves), key=lambda b: float(norm(b)))
    facing: Vector3 = unit(normal) * (1.0 if dot(normal, towards) >= 0.0 else -1.0)
    return facing


FLAT = 1e-13
"""Points nearer to a plane than this share of their extent lie in it: some hundred roundings."""


def _binormal(curve: Curve) -> Vector3:
    """Return r' x r'' where that is longest, among samples."""
    _, r1, r2 = curve.jet(np.linspace(0.0, 1.0, PLACES), 2)
    b = cross3(r1, r2)
    longest: Vector3 = b[np.argmax(norm(b))]
    return longest


def is_straight(curve: Curve) -> bool:
    """Return whether a curve is a straight line to rounding."""
    points = positions([curve])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[1] <= FLAT * spread[0])


def piece_ruling(curve: Curve) -> Curve | RunsOff:
    """Return the rulings over a piece that is not straight, or where they run off."""
    size = diagonal(positions([curve]))
    flattest = least([partial(bend, curve)])
    if flattest.value * size > GENTLE:
        return Rectifying(curve)
    normal = plane_normal([curve])
    if normal is not None:
        return bezier([exactly(normal)])
    if isinstance(curve, Bezier | RationalBezier):
        made = bending(curve)
        if made.inflections:
            return RunsOff(tuple(made.poles)) if made.poles else through(made)
    return Rectifying(curve) if flattest.value * size > UNCURVED else RunsOff((flattest.v,))


GENTLE = 1e-3
"""Curvature times size below which a place is looked at exactly."""
UNCURVED = 1e-6
"""Curvature times size below which a place is straight: sampled, so not at rounding."""


def senses(rulings: Sequence[Curve]) -> list[float]:
    """Return 1 or -1 for each piece, such that neighbours have their sides in common: B turns over where curves do."""
    made = [1.0]
    for a, b in pairwise(rulings):
        turned = float(dot(value(a, 1.0), value(b, 0.0)))
        made.append(-made[-1] if turned < 0.0 else made[-1])
    return made


def value(curve: Curve, v: float, order: int = 0) -> Vector3:
    """Return the value or a derivative of a curve at one place."""
    at: Vector3 = curve.jet(np.array([v]), order)[order, 0]
    return at


# Straight pieces


def over_straight(
    curves: Sequence[Curve], rulings: Sequence[Curve | None], half: float, tol: Tolerances
) -> tuple[list[Curve], tuple[Finding, ...]]:
    """Return the rulings with those over straight pieces (None), and what stands in their way.

    At least one piece must not be straight.
    """
    made, findings = list(rulings), list[Finding]()
    for first, last in _runs(rulings):
        line = curves[first : last + 1]
        ends = _ends(curves, rulings, first, last)
        findings += _kinks(line, first, half, tol) or _twist(line, ends, first, half, tol)
        made[first : last + 1] = _fan(line, ends)
    return [ruling for ruling in made if ruling is not None], tuple(findings)


def _runs(rulings: Sequence[Curve | None]) -> list[tuple[int, int]]:
    """Return first and last of each run of straight pieces."""
    straight = [False, *(ruling is None for ruling in rulings), False]
    changes = [i for i, (a, b) in enumerate(pairwise(straight)) if a != b]
    return [(first, after - 1) for first, after in zip(changes[::2], changes[1::2], strict=True)]


def _ends(curves: Sequence[Curve], rulings: Sequence[Curve | None], first: int, last: int) -> tuple[Vector3, Vector3]:
    """Return the rulings before and after a run, on the same side of it; one twice at an end of the strap."""
    before = rulings[first - 1] if first > 0 else None
    after = rulings[last + 1] if last + 1 < len(rulings) else None
    g = None if before is None else value(before, 1.0)
    h = None if after is None else value(after, 0.0)
    start, end = (h if g is None else g), (g if h is None else h)
    if start is None or end is None:
        raise ValueError("a strap on a straight line")
    sides = (_across(start, value(curves[first], 0.0, 1)), _across(end, value(curves[last], 1.0, 1)))
    return start, end if float(dot(*sides)) >= 0.0 else -end


def _across(g: Vector3, tangent: Vector3) -> Vector3:
    """Return the part of a ruling across the curve."""
    T = unit(tangent)
    side: Vector3 = g - float(dot(g, T)) * T
    return side


def _fan(line: Sequence[Curve], ends: tuple[Vector3, Vector3]) -> list[Curve]:
    """Return rulings that turn evenly from one to the other, by the length along the line."""
    points = [value(line[0], 0.0), *(value(curve, 1.0) for curve in line)]
    whole = points[-1] - points[0]
    rows = np.outer(ends[1] - ends[0], whole) / float(dot(whole, whole))
    shift = exactly(ends[0] - rows @ points[0])
    return [affine(curve, [exactly(row) for row in rows], shift) for curve in line]


def _kinks(line: Sequence[Curve], first: int, half: float, tol: Tolerances) -> list[Finding]:
    """Refuse a kink between straight pieces of a centre line that is not plane."""
    for i, (a, b) in enumerate(pairwise(line), start=first + 1):
        turn = turn_between(a, b)
        if turn * half > tol.join_mm:
            message = (
                f"the centre curve has a kink of {np.degrees(turn):.4g} deg between straight pieces at v = {i}: they "
                "say no ruling to fold along; round the corner"
            )
            return [Finding("strap-kink", message, True, place(i, 0.0))]
    return []


def _twist(
    line: Sequence[Curve], ends: tuple[Vector3, Vector3], first: int, half: float, tol: Tolerances
) -> list[Finding]:
    """Refuse a straight piece that would have to be twisted."""
    before, after = (_across(g, value(line[0], 0.0, 1)) for g in ends)
    turn = float(np.arctan2(norm(np.cross(before, after)), dot(before, after)))
    if turn * half <= tol.join_mm:
        return []
    message = (
        f"the planes in which the strap leaves the curves before and after the straight piece at v = {first} differ by "
        f"{np.degrees(turn):.4g} deg: it would have to be twisted; turn one of the curves about the straight piece"
    )
    return [Finding("strap-twisted", message, True, place(first, 0.0))]
