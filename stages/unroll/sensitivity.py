"""How much each dimension of the flat pattern changes with thickness, K and bending radius.

The neutral surface at the offset d has the rates of the surface as given, with the widths c0'.w - d beta and
c1'.w - d beta; how rulings turn and how long they are does not change (but where d is 0 at an apex and not at the other
edge: there rulings turn by the difference of widths over their length).  So the pattern is laid out again from rates
sampled once, for each change, and the differences are central; the same at half the step says how far to trust them.

    thickness   by 0.1 mm, the face that the job gives and K held
    K           by 0.01
    radius      every bending radius of the middle surface larger by 1 % at the same turning of the normal: all its
                widths, and with them the turning of the rulings in the flat, larger by 1 % wherever it bends

Width and height are taken at 33 points per panel.  Lengths along rulings do not depend on any of the three (those to an
apex do, by d / L of the change of d, which is left out).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector2, Vector3, dot, norm, unit
from stages.geometry.flat.development import axes
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import ANTIDERIVATIVE, AT_NODES, ORDER, WEIGHTS
from stages.geometry.ruled.ruled import longest_ruling, sideways
from stages.geometry.ruled.turning import FLAT, PatchTurning, Stretch, is_fold
from stages.model.sheetface import Layers
from stages.unroll.bent import Bent, neutral_mm

DIMENSIONS = ("c0", "c1", "start", "end", "width", "height", "area")
"""What is laid out: lengths in mm, the area in mm2."""
SHOWN = legendre.legvander(np.linspace(-1.0, 1.0, 33), ORDER)
"""Values at 33 places of a panel, ends included, from 17 Legendre coefficients."""


@dataclass(frozen=True, slots=True, eq=False)
class Flow(ArrayValue):
    """One stretch as given: its panels, and at their nodes the rates that lay it flat, each of shape (m, 16).

    sign: the way it bends.  beta: rate of the normal, turn: of the ruling, rad; along, along_p: c0' and p' along the
    ruling; across, across_p: across it; length: |p|, mm.  ends: |p| at both ends.
    """

    sign: float
    breaks: Values
    beta: Array
    turn: Array
    along: Array
    across: Array
    along_p: Array
    across_p: Array
    length: Array
    ends: Vector2


@dataclass(frozen=True, slots=True)
class Change:
    """What the pattern is laid out with: sheet, K, the edge kept, and the share by which bending radii are larger."""

    sheet: Layers
    k: float
    kept: float | None
    wider: float = 0.0

    def neutral_mm(self, sign: float) -> Vector2:
        """Return how far c0 and c1 of the unrolled surface lie from those given, mm."""
        return neutral_mm(self.sheet, self.k, self.kept, sign)


def sensitivity(bent: Bent) -> dict[str, object]:
    """Return the changes of every dimension, mm and mm2, each with how far to trust it."""
    if bent.sheet.thickness_mm == 0.0:
        return {"note": "no thickness is known: the flat pattern is that of the surface itself"}
    if bent.bends.total_rad <= FLAT:
        return {"note": "the part is flat: none of its dimensions depends on thickness, K or bending radius"}
    flows = [_flow(bent.bends.pieces[s.piece], s) for s in bent.bends.stretches if not is_fold(s)]
    sheet, k, kept, t = bent.sheet, bent.k, bent.kept, bent.sheet.thickness_mm

    def thicker(by: float) -> Change:
        return Change(Layers(sheet.minus_mm * (1.0 + by / t), sheet.plus_mm * (1.0 + by / t)), k, kept)

    return {
        "per_0_1_mm_thickness": _row(flows, thicker, min(THICKNESS_STEP, t / 4.0), 0.1),
        "per_0_01_k": _row(flows, lambda by: Change(sheet, k + by, kept), K_STEP, 0.01),
        "per_1_percent_radius": _row(flows, lambda by: Change(sheet, k, kept, by), RADIUS_STEP, 0.01),
    }


THICKNESS_STEP = 0.05
K_STEP = 0.005
RADIUS_STEP = 0.005
"""Half of the changes reported: lengths bend so little over them that half the step tells the same to some 1e-6."""


def _row(flows: list[Flow], change: Callable[[float], Change], step: float, per: float) -> dict[str, object]:
    """Return the change of each dimension per so much of what changes, and the difference to that by half the step."""

    def slope(by: float) -> Values:
        difference: Values = dimensions(flows, change(by)) - dimensions(flows, change(-by))
        return difference * (per / (2.0 * by))

    coarse, fine = slope(step), slope(step / 2.0)
    row: dict[str, object] = dict(zip(DIMENSIONS, fine.tolist(), strict=True))
    return row | {"uncertainty": dict(zip(DIMENSIONS, np.abs(fine - coarse).tolist(), strict=True))}


# Laying out


def _flow(piece: PatchTurning, stretch: Stretch) -> Flow:
    patch, width = piece.patch, stretch.high - stretch.low
    scale = longest_ruling(patch)

    def sample(x: Values) -> Array:
        v = stretch.low + width * x
        N, N_v = piece.normal.jet(v, 1)
        p, p_v = patch.p.jet(v, 1)
        c_v = patch.c0.jet(v, 1)[1]
        length, e = norm(p), unit(p)
        w = np.cross(N, e)
        aside = sideways(p_v, e, w)
        turn = np.divide(scale * aside, length, out=np.zeros_like(length), where=length > 0.0)
        speeds = np.stack([-dot(N_v, w) * scale, turn, dot(c_v, e), dot(c_v, w), dot(p_v, e), aside], axis=1)
        return np.concatenate([width * speeds, length[:, None]], axis=1)

    breaks, values = quadrature.panels(sample, f"sensitivity of piece {stretch.piece}")
    beta, turn, along, across, along_p, across_p, length = np.moveaxis(values, -1, 0)
    ends = norm(patch.p.jet(np.array([stretch.low, stretch.high]), 0)[0])
    sign = 1.0 if stretch.angle_rad >= 0.0 else -1.0
    return Flow(sign, breaks, beta / scale, turn / scale, along, across, along_p, across_p, length, ends)


def dimensions(flows: list[Flow], change: Change) -> Values:
    """Return the dimensions of the pattern, in the order of `DIMENSIONS`."""
    lengths, points, phi, q = np.zeros(3), [], 0.0, np.zeros(2)
    for flow in flows:
        made, outline, phi, q = _laid(flow, change, phi, q)
        lengths += made
        points.append(outline)
    every: Points2 = np.concatenate(points)
    if flows[0].ends[0] == 0.0:  # the last ruling lies along +x instead
        c, s = np.cos(phi), np.sin(phi)
        every = every @ np.array([[c, -s], [s, c]])
    width, height = np.ptp(every, axis=0)
    return np.array([lengths[0], lengths[1], flows[0].ends[0], flows[-1].ends[1], width, height, lengths[2]])


def _laid(flow: Flow, change: Change, phi0: float, q0: Vector2) -> tuple[Vector3, Points2, float, Vector2]:
    """Return c0, c1 and area of a stretch, points of its outline, and where it ends: angle and position."""
    sheet, (at_c0, at_c1) = change.sheet, change.neutral_mm(flow.sign)
    wider = np.where(np.abs(flow.beta) > FLAT, change.wider, 0.0)
    tapered = (at_c1 - at_c0) * flow.beta
    across_p = flow.across_p * (1.0 + wider) - tapered
    across = flow.across - at_c0 * flow.beta + wider * (flow.across - sheet.middle_mm * flow.beta)
    turn = flow.turn * (1.0 + wider) - np.divide(
        tapered, flow.length, out=np.zeros_like(tapered), where=flow.length > 0.0
    )
    half = np.diff(flow.breaks)[:, None] / 2.0
    weights = half * WEIGHTS
    speeds = np.hypot(flow.along, across), np.hypot(flow.along + flow.along_p, across + across_p)
    area = flow.length * (across + across_p / 2.0)
    made = np.array([(weights * figure).sum() for figure in (*speeds, area)])
    phi = _chained((half * turn)[..., None], np.array([phi0]))[..., 0]
    e, e_perp = axes(phi @ AT_NODES.T)
    velocity = half[..., None] * (flow.along[..., None] * e + across[..., None] * e_perp)
    c0 = np.einsum("sk,pkc->psc", SHOWN, _chained(velocity, q0))
    length = _chained((half * flow.along_p)[..., None], flow.ends[:1])[..., 0] @ SHOWN.T
    c1 = c0 + length[..., None] * axes(phi @ SHOWN.T)[0]
    outline: Points2 = np.concatenate([c0, c1]).reshape(-1, 2)
    return made, outline, float((phi @ SHOWN.T)[-1, -1]), c0[-1, -1]


def _chained(rates: Array, start: Values) -> Array:
    """Return the series of the integrals of rates (m, 16, c) on all panels, each begun where the one before ends."""
    series = np.einsum("lk,pkc->plc", ANTIDERIVATIVE, quadrature.coefficients(rates))
    series[:, 0] += quadrature.beginnings(series, start)
    chained: Array = series
    return chained
