"""Where the centre line of a strap has inflections that split it, and the longest part that has a strap all the same.

Towards such an inflection the rulings lean over without bound, faster and faster: a part that ends short of it has a
strap of half width w as long as w |d lambda / ds| < 1, lambda = tau / kappa.  Between two curved pieces a straight one
is counted with the first alone: whether a strap twists along it is not asked here.

Sampled: parts that hold at samples, their ends by bisection, divided where w |d lambda / ds| has a peak in between that
`extremum` finds; one narrower than 1/200 of a part may be missed.  Nothing is cut by it: the part that is told
is a proposal, and the job that takes it up is measured like any other.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from stages.construct.bands import place
from stages.construct.straprulings import RunsOff, value
from stages.geometry.arrays import Mask, Values, norm
from stages.geometry.curves.arclength import length_between
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric.extremum import maximum
from stages.geometry.ruled.envelope import Rectifying, closing, speed
from stages.model.report import Finding
from stages.model.tolerances import Tolerances

Found = Curve | RunsOff | None
"""The rulings over a piece, where they run off, or None over a straight one."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a chain: from and to, v counted on over the pieces, and its length, mm."""

    start: float
    end: float
    length_mm: float


def inflection_findings(
    curves: Sequence[Curve], found: Sequence[Found], half: float, tol: Tolerances
) -> tuple[Finding, ...]:
    """Refuse a centre curve along which rulings run off, with its longest part that has a strap of this half width."""
    for piece, one in enumerate(found):
        if isinstance(one, RunsOff):
            return (_finding(piece, one, longest(curves, found, half, tol), half),)
    return ()


def _finding(piece: int, runs_off: RunsOff, best: Stretch | None, half: float) -> Finding:
    where = place(piece, runs_off.poles[0])
    message = (
        f"the centre curve has no curvature at v = {where['v']:.6g}, but torsion: the rulings of a strap run off along "
        "it; split there, and let both parts end short of it"
    )
    if best is not None:
        low, high = float(np.ceil(best.start * MILLION) / MILLION), float(np.floor(best.end * MILLION) / MILLION)
        where |= {"from": low, "to": high}
        message += (
            f". The longest part with a strap of half width {half:g} mm runs from v = {low:.6f} to v = {high:.6f}, "
            f"{best.length_mm:.6g} mm"
        )
    return Finding("strap-inflection", message, True, where)


MILLION = 1e6
"""Ends of parts are told in whole millionths, on the side that does."""


def longest(curves: Sequence[Curve], found: Sequence[Found], half: float, tol: Tolerances) -> Stretch | None:
    """Return the longest part of the chain that has a strap of this half width."""
    parts: list[Stretch] = []
    for piece, (curve, one) in enumerate(zip(curves, found, strict=True)):
        follows = piece > 0 and _goes_on(found[:piece], one, curves[piece - 1 : piece + 1], half, tol)
        here = _stretches(piece, curve, one, half)
        if follows and parts and here and parts[-1].end == here[0].start:
            before = parts.pop()
            here[0] = Stretch(before.start, here[0].end, before.length_mm + here[0].length_mm)
        parts += here
    return max(parts, key=lambda part: part.length_mm, default=None)


def _goes_on(before: Sequence[Found], after: Found, curves: Sequence[Curve], half: float, tol: Tolerances) -> bool:
    """Return whether a strap goes on to a piece from the last of those before: onto a straight one it always does.

    So it does from straight ones with which the chain begins: they take the ruling that follows.
    """
    if after is None:
        return True
    if before[-1] is None:
        return all(one is None for one in before)
    g, h = value(_rulings(before[-1], curves[0]), 1.0), value(_rulings(after, curves[1]), 0.0)
    return half * min(float(norm(g - h)), float(norm(g + h))) <= tol.join_mm


def _rulings(one: Curve | RunsOff, curve: Curve) -> Curve:
    return Rectifying(curve) if isinstance(one, RunsOff) else one


def _stretches(piece: int, curve: Curve, one: Found, half: float) -> list[Stretch]:
    """Return the parts of one piece that have a strap."""
    poles = one.poles if isinstance(one, RunsOff) else ()
    found = []
    rate = partial(_closing, curve, None if one is None else _rulings(one, curve), half, poles)
    for low, high in pairwise(sorted({0.0, *poles, 1.0})):
        for start, end in _parts(rate, low, high):
            length = length_between(partial(speed, curve), start, end)
            found.append(Stretch(piece + start, piece + end, length))
    return found


def _closing(curve: Curve, ruling: Curve | None, half: float, poles: Sequence[float], v: Values) -> Values:
    """Return w |d lambda / ds|: below 1 where the edge of regression stays outside the strap, infinite at a pole."""
    if ruling is None:
        return np.zeros(v.size)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate: Values = np.abs(closing(curve, ruling, v)) * half
    return np.where(np.isnan(rate) | np.isin(v, poles), np.inf, rate)


def _parts(rate: Callable[[Values], Values], low: float, high: float, divided: int = 0) -> list[tuple[float, float]]:
    """Return the parts of [low, high] in which a rate is below 1: at samples, and at its peaks between them.

    What is shorter than `SHORTEST`, or still has peaks after `MOST_DIVIDED` divisions, is left out: less is told.
    """
    found = []
    for start, end in _intervals(lambda v: rate(v) < 1.0, low, high):
        if end - start < SHORTEST:
            continue
        peak = _peak(rate, start, end)
        if peak is None:
            found.append((start, end))
        elif divided < MOST_DIVIDED:
            found += [*_parts(rate, start, peak, divided + 1), *_parts(rate, peak, end, divided + 1)]
    return found


SHORTEST, MOST_DIVIDED = 1.0 / 128.0, 4
"""Of a piece: shorter parts are no straps.  A rate that has peaks beside its peaks again and again is noise."""


def _peak(rate: Callable[[Values], Values], start: float, end: float) -> float | None:
    """Return the place inside an interval at which a rate is largest, if that is above 1."""
    most, share = maximum(lambda s: rate(start + (end - start) * s))
    place = start + (end - start) * share
    return place if most > ROUNDED and start < place < end else None


ROUNDED = 1.0 + 1e-9
"""At the ends of a part, found by bisection, the rate is 1 but for rounding: that is no peak."""


def _intervals(inside: Callable[[Values], Mask], low: float, high: float) -> list[tuple[float, float]]:
    """Return the intervals of [low, high] in which a condition holds."""
    v = low + (high - low) * (1.0 - np.cos(np.linspace(0.0, np.pi, SAMPLES))) / 2.0
    v[0], v[-1] = low, high
    held = np.concatenate([[False], inside(v), [False]])
    starts, ends = (np.flatnonzero(held[1:] & ~held[:-1]), np.flatnonzero(held[:-1] & ~held[1:]) - 1)
    return [
        (_edge(inside, v[a], v[a - 1] if a > 0 else v[a]), _edge(inside, v[b], v[b + 1] if b + 1 < v.size else v[b]))
        for a, b in zip(starts, ends, strict=True)
    ]


SAMPLES = 257
"""To an interval, closer at its ends, where rulings run off: a stretch shorter than 1/128 of it is no strap."""


def _edge(inside: Callable[[Values], Mask], held: float, not_held: float) -> float:
    """Return the last place at which a condition holds, between one where it does and one where it does not."""
    for _ in range(BISECTIONS):
        middle = (held + not_held) / 2.0
        held, not_held = (middle, not_held) if bool(inside(np.array([middle]))[0]) else (held, middle)
    return held


BISECTIONS = 40
"""An interval of 1/128 is then below rounding."""
