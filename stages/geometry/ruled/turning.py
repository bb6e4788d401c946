"""How far a strip bends: the turning of its normal about the rulings, integrated, and places at equal turning.

With e = p / |p|, N the unit normal of p x S_v and w = N x e across the ruling, the normal turns at the rate
beta = -N'.w per unit of v, the same all along the ruling of a developable; positive where the surface bends towards N
(on the flat pattern, seen from the side of N: up).  The radius of curvature at u is  rho(u) = (S_v(u).w) / beta.

beta and the widths c0'.w, c1'.w are integrated together on panels of 16 Gauss nodes (`quadrature`), to some 1e-14 of
a radian and of the size.  Zeros of beta are those of its Legendre series; they divide a patch into stretches that bend
one way.  Adjacent patches may meet in a fold, which turns by its angle at one place.

Places are counted over the patches: patch i is [i, i + 1].  Not for surfaces whose edge of regression lies inside.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, degrees, radians

import numpy as np
from numpy.polynomial import legendre

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, ArrayValue, Indices, Values, dot, norm, unit
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import ANTIDERIVATIVE, ORDER
from stages.geometry.ruled.offset import normals
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import RuledPatch, end_normals, frames

FLAT = 1e-9
"""A normal that turns by less over a stretch, in rad, does not turn: 1 nm of lift per metre."""
FOLD = np.radians(0.01)
"""Normals of two patches that differ by less are smooth to the eye: 0.1 mm per 600 mm of flange; not a fold."""


@dataclass(frozen=True, slots=True, eq=False)
class PatchTurning(ArrayValue):
    """One patch: rates at the Gauss nodes, shape (m, 16, 3), and the Legendre series of their integrals, (m, 17, 3).

    Channels: angle in rad, distance across the rulings along c0 and along c1 in mm.
    """

    patch: RuledPatch
    normal: Curve
    breaks: Values
    rates: Array
    series: Array

    def upto(self, v: Values) -> Array:
        """Return angle, distance along c0 and along c1 from v = 0 on, shape (n, 3)."""
        index = np.clip(np.searchsorted(self.breaks, v, side="right") - 1, 0, self.breaks.size - 2)
        low, high = self.breaks[index], self.breaks[index + 1]
        x = (2.0 * v - low - high) / (high - low)
        total: Array = np.einsum("nk,nkc->nc", legendre.legvander(x, ORDER), self.series[index])
        return total


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a patch that bends one way, by `angle_rad` with its sign; a fold has low = high."""

    piece: int
    low: float
    high: float
    angle_rad: float


Run = tuple[Stretch, ...]
"""Stretches one after the other that bend the same way, no fold among them; or one fold alone."""


@dataclass(frozen=True, slots=True)
class Turning:
    """A strip: its pieces, and its stretches and folds in order; neither of a planar one."""

    pieces: tuple[PatchTurning, ...]
    stretches: tuple[Stretch, ...]

    @property
    def total_rad(self) -> float:
        """Return how far the strip bends in all, both ways added up, rad."""
        return sum((abs(stretch.angle_rad) for stretch in self.stretches), 0.0)


def turning(patches: Sequence[RuledPatch]) -> Turning:
    """Return how a strip bends; a planar one has no pieces and no stretches.

    Raises NoSolutionError where the rates do not resolve, or the normal vanishes at an end and has no known limit.
    """
    if is_planar(tuple(patches))[0]:
        return Turning((), ())
    pieces = tuple(_integrated(patch, i) for i, patch in enumerate(patches))
    stretches = [*_stretches(pieces[0], 0)]
    for i, (a, b) in enumerate(pairwise(pieces)):
        angle = fold_angle(a, b)
        if abs(angle) > FOLD:
            stretches.append(Stretch(i + 1, 0.0, 0.0, angle))
        stretches += _stretches(b, i + 1)
    return Turning(pieces, tuple(stretches))


def rates(patch: RuledPatch, normal: Curve, v: Values) -> Array:
    """Return beta in rad and the widths c0'.w and c1'.w in mm, all per unit of v, shape (n, 3)."""
    N, N_v = normal.jet(v, 1)
    w = np.cross(N, unit(patch.p.jet(v, 0)[0]))
    return np.stack([-dot(N_v, w), dot(patch.c0.jet(v, 1)[1], w), dot(patch.c1.jet(v, 1)[1], w)], axis=1)


def _integrated(patch: RuledPatch, piece: int) -> PatchTurning:
    normal = normals(patch)
    ends = frames(patch, np.array([0.0, 0.5, 1.0]))
    scale = float(max(norm(ends.p).max(), norm(np.diff(ends.c0, axis=0)).max()))
    to_length = np.array([scale, 1.0, 1.0])
    breaks, values = quadrature.panels(lambda v: rates(patch, normal, v) * to_length, f"bending of piece {piece}")
    half = np.diff(breaks)[:, None, None] / 2.0
    series = half * np.einsum("lk,pkc->plc", ANTIDERIVATIVE, quadrature.coefficients(values / to_length))
    series[:, 0] += quadrature.beginnings(series, np.zeros(3))
    return PatchTurning(patch, normal, breaks, values / to_length, series)


def fold_angle(a: PatchTurning, b: PatchTurning) -> float:
    """Return the signed angle between the normals where two patches meet, rad, positive towards N."""
    before, after = a.normal.jet(np.ones(1), 0)[0, 0], b.normal.jet(np.zeros(1), 0)[0, 0]
    axis = unit(a.patch.p.jet(np.array([1.0 - BESIDE]), 0)[0, 0])
    return float(np.arctan2(dot(axis, np.cross(before, after)), dot(before, after)))


BESIDE = 2.0**-20
"""Where a ruling's direction is taken from: it may have no length at the end itself."""


def _stretches(piece: PatchTurning, index: int) -> list[Stretch]:
    """Return the stretches of a patch between the zeros of its rate; those that do not turn join the one before."""
    places = np.unique(np.concatenate([[0.0], _zeros(piece), [1.0]]))
    steps = np.diff(piece.upto(places)[:, 0])
    made: list[Stretch] = []
    for low, high, step in zip(places[:-1], places[1:], steps, strict=True):
        last = made[-1] if made else None
        if last is not None and (abs(step) <= FLAT or abs(last.angle_rad) <= FLAT or step * last.angle_rad > 0.0):
            made[-1] = Stretch(index, last.low, float(high), last.angle_rad + float(step))
        else:
            made.append(Stretch(index, float(low), float(high), float(step)))
    return made


def _zeros(piece: PatchTurning) -> Values:
    """Return the zeros of the rate of turning."""
    widths = np.diff(piece.breaks)
    series = quadrature.coefficients(piece.rates[..., :1])[..., 0]
    sizes = np.abs(series).sum(axis=1)
    doubtful = (np.abs(series[:, 0]) <= sizes - np.abs(series[:, 0])) & (sizes * widths > FLAT / ORDER)
    found = []
    for panel in np.flatnonzero(doubtful):
        roots = legendre.legroots(series[panel])
        real = roots[(np.abs(roots.imag) <= TOUCHING) & (np.abs(roots.real) <= 1.0)].real
        found.append(piece.breaks[panel] + widths[panel] * (real + 1.0) / 2.0)
    return np.concatenate(found) if found else np.zeros(0)


TOUCHING = 1e-7
"""Two zeros closer than the square root of rounding come out as a complex pair so far off the real axis."""


def runs(bends: Turning) -> tuple[Run, ...]:
    """Return the runs of a strip in order; stretches that do not turn belong to the run before, or to the first."""
    made: list[list[Stretch]] = []
    for stretch in bends.stretches:
        last = made[-1] if made else None
        angle = _angle(last) if last else 0.0
        alike = stretch.angle_rad * angle > 0.0 or abs(stretch.angle_rad) <= FLAT or abs(angle) <= FLAT
        if last and alike and not is_fold(stretch) and not is_fold(last[-1]):
            last.append(stretch)
        else:
            made.append([stretch])
    return tuple(tuple(run) for run in made)


def is_fold(stretch: Stretch) -> bool:
    """Return whether a stretch is a fold between two patches."""
    return stretch.low == stretch.high


def _angle(run: Sequence[Stretch]) -> float:
    return sum((stretch.angle_rad for stretch in run), 0.0)


def run_angle(run: Run) -> float:
    """Return the angle by which a run bends, with its sign, rad."""
    return _angle(run)


def places(bends: Turning, stretches: Sequence[Stretch], shares: Values) -> Values:
    """Return where the turning reaches these shares (0 to 1, rising) of the whole over the stretches.

    Of stretches that do not turn at all: shares of the parameter.
    """
    turned = np.array([abs(stretch.angle_rad) for stretch in stretches])
    bent = float(turned.sum()) > FLAT
    amounts = turned if bent else np.array([stretch.high - stretch.low for stretch in stretches])
    ends = np.cumsum(amounts)
    targets = np.clip(shares, 0.0, 1.0) * ends[-1]
    index = np.minimum(np.searchsorted(ends, targets), len(stretches) - 1)
    left = targets - (ends - amounts)[index]
    low = np.array([stretch.piece + stretch.low for stretch in stretches])[index]
    high = np.array([stretch.piece + stretch.high for stretch in stretches])[index]
    if not bent:
        straight: Values = np.minimum(low + left, high)
        return straight
    pieces = np.array([stretch.piece for stretch in stretches])[index]
    signs = np.array([np.sign(stretch.angle_rad) for stretch in stretches])[index]
    found = _solved(_angles(bends, pieces), low, high, signs, left)
    return np.where(left <= 0.0, low, np.where(left >= amounts[index], high, found))


Angle = Callable[[Values], tuple[Values, Values]]


def _solved(angle: Angle, low: Values, high: Values, signs: Values, left: Values) -> Values:
    """Return where the angle has grown by signs * left since low: Newton's method, every third step a halving."""
    goals = angle(low)[0] + signs * left
    place = (low + high) / 2.0
    for k in range(BISECTED * HALVINGS):
        value, slope = angle(place)
        short = signs * (value - goals) < 0.0
        low, high = np.where(short, place, low), np.where(short, high, place)
        newton = place - np.divide(value - goals, slope, out=np.full_like(slope, np.inf), where=slope != 0.0)
        inside = (newton >= low) & (newton <= high) & (k % BISECTED < BISECTED - 1)
        reached = np.abs(value - goals) <= 2.0 * EPS * (1.0 + np.abs(goals))
        following = np.where(reached, place, np.where(inside, newton, (low + high) / 2.0))
        close = np.abs(following - place) <= 2.0 * EPS * (1.0 + np.abs(place))
        place = following
        if close.all():
            break
    found: Values = place
    return found


HALVINGS = 54
"""The interval [0, 1] halved so often is as wide as the rounding of v: enough whatever Newton's steps did."""
BISECTED = 3
"""Every so many steps the interval is halved whatever Newton's method says: so it ends, however flat the angle."""


def _angles(bends: Turning, pieces: Indices) -> Angle:
    """Return the function from places on these pieces to the angles turned from their starts on, and their rates."""
    starts = np.concatenate([i + piece.breaks[:-1] for i, piece in enumerate(bends.pieces)])
    widths = np.concatenate([np.diff(piece.breaks) for piece in bends.pieces])
    series = np.concatenate([piece.series[..., 0] for piece in bends.pieces])
    slopes = np.concatenate([quadrature.coefficients(piece.rates[..., :1])[..., 0] for piece in bends.pieces])
    last = (np.cumsum([piece.breaks.size - 1 for piece in bends.pieces]) - 1)[pieces]

    def angle(places: Values) -> tuple[Values, Values]:
        index = np.minimum(np.searchsorted(starts, places, side="right") - 1, last)
        x = 2.0 * (places - starts[index]) / widths[index] - 1.0
        basis = legendre.legvander(x, ORDER)
        return np.einsum("nk,nk->n", basis, series[index]), np.einsum("nk,nk->n", basis[:, :-1], slopes[index])

    return angle


def equal_turns(total_rad: float, most_deg: float) -> int:
    """Return into how many equal turns a total is divided, none above the most; NoSolutionError above `MOST_TURNS`."""
    wanted = total_rad / radians(most_deg) * (1.0 - SUMMED)
    if wanted > MOST_TURNS:
        reached = degrees(total_rad) / MOST_TURNS
        raise NoSolutionError(f"{MOST_TURNS} lines at equal turning", reached=reached, wanted=most_deg, unit="deg")
    return max(ceil(wanted), 1)


MOST_TURNS = 5000
"""Lines at equal turning of one run: with more they lie within a millimetre of each other on a part of 5 m."""

SUMMED = 1e-9
"""What a sum of turns may be over a whole number of them by rounding alone, as a share."""


def turning_places(bends: Turning, count: int, steps: int) -> Values:
    """Return the steps - 1 inner places that divide the turning of a strip of `count` patches into equal parts.

    Folds are included; a plane is divided evenly by the parameter.
    """
    shares = np.arange(1, steps) / steps
    return places(bends, bends.stretches, shares) if bends.stretches else shares * count


def chord_turning(patches: Sequence[RuledPatch], chords: int = 512) -> float:
    """Return how far a strip bends in all, rad, by the angles between normals at equal steps of v, folds included.

    A second way, from the normals at both ends of the rulings alone: low by some 1 / chords^2.
    """
    v = np.linspace(0.0, 1.0, chords + 1)
    every = [np.stack(end_normals(frames(patch, v))).sum(axis=0) for patch in patches]
    shown = np.concatenate([unit(normal[norm(normal) > SHOWN * norm(normal).max()]) for normal in every])
    return float(np.arctan2(norm(np.cross(shown[:-1], shown[1:])), dot(shown[:-1], shown[1:])).sum())


SHOWN = 1e-9
"""A normal below this share of the patch's longest has the direction of rounding."""
