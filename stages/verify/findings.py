"""What verify finds wrong with a surface, in words, with the ruling it is about."""

import numpy as np

from stages.geometry.arrays import dot, norm
from stages.geometry.ruled.ruled import end_normals, frames, regression
from stages.model.report import Finding, Metric, Where
from stages.model.surface import RuledSurface
from stages.model.tolerances import WARP_LIMIT_DEG, Tolerances, class_by_warp
from stages.verify.examined import Examined
from stages.verify.sampled import Extreme
from stages.verify.singular import Sort

MESSAGES: dict[Sort, tuple[str, bool, str]] = {
    "zero-ruling": ("zero-ruling", True, "the ruling at {at} has no length: both directrices meet inside the patch"),
    "cusp": ("cusp", True, "both directrices stop and turn back at {at}: the surface has an edge along that ruling"),
    "singular-ruling": (
        "singular-ruling", True,
        "the ruling at {at} runs along the directrices, and the surface turns back there: it has an edge inside",
    ),
    "touch": (
        "edge-of-regression-touches", False,
        "the edge of regression touches an edge of the patch at {at}, and does not come in",
    ),
    "stop": (
        "directrices-stop", False,
        "both directrices stop at {at} and go on: only the parametrisation is singular there, the surface is not",
    ),
    "tangent-ruling": (
        "tangent-ruling", False, "the ruling at {at} runs along the directrices; the surface goes on without an edge",
    ),
}  # fmt: skip
"""Code, whether fatal, and message of each sort of singular ruling.

Not of an edge of regression that crosses an edge: that folds the patch, which the warp says.
"""


def singular_findings(surface: RuledSurface, examined: list[Examined]) -> list[Finding]:
    """Return a finding for each ruling inside at which a normal vanishes: all of them by proof, else the weakest."""
    found: list[Finding] = []
    for one in examined:
        if one.proof is not None:
            found += [_finding(surface, one.piece, ruling.v, ruling.sort) for ruling in one.proof.singular
                      if ruling.sort in MESSAGES]  # fmt: skip
        else:
            found += _sampled_finding(surface, one)
    return found


def _finding(surface: RuledSurface, piece: int, v: float, sort: Sort) -> Finding:
    code, fatal, message = MESSAGES[sort]
    where: Where = {"piece": piece, "v": surface.v_of(piece, v)}
    at = f"v = {where['v']:.6g}" + (f" (piece {piece})" if len(surface.patches) > 1 else "")
    return Finding(code, message.format(at=at), fatal, where)


def _sampled_finding(surface: RuledSurface, one: Examined) -> list[Finding]:
    """Return the worse of a ruling of no length and a normal that vanishes, as far as samples show."""
    if one.samples is None:
        return []
    ruling, normal = one.samples.ruling, one.samples.normal
    if ruling.value <= SINGULAR * surface.size_mm:
        return [_finding(surface, one.piece, ruling.v, "zero-ruling")]
    if normal.value <= SINGULAR:
        return [_finding(surface, one.piece, normal.v, _sampled_sort(one, normal))]
    return []


SINGULAR = 1e-6
"""Relative size below which a ruling, a speed or a normal inside the patch is taken for zero: sampled, so not at
rounding."""


def _sampled_sort(one: Examined, normal: Extreme) -> Sort:
    """Return what happens where the middle normal vanishes: whether it turns back, and whether the directrices stop."""
    f = frames(one.patch, np.clip(normal.v + ASIDE * np.array([-1.0, 0.0, 1.0]), 0.0, 1.0))
    n0, n1 = end_normals(f)
    before, _, after = n0 + n1
    speeds = np.stack([norm(f.c0_d1), norm(f.c1_d1)])
    stops = bool((speeds[:, 1] <= SINGULAR / ASIDE * speeds[:, ::2].max(axis=1)).all())
    if dot(before, after) < 0.0:
        return "cusp" if stops else "singular-ruling"
    return "stop" if stops else "tangent-ruling"


ASIDE = 1e-3
"""So far from the ruling, in v, its neighbours are looked at: further than sampling misses it by, and near it."""


def rejection(surface: RuledSurface, warp: Metric, tol: Tolerances) -> Finding:
    """Return why a surface is refused for its warp: it folds, or is not developable enough."""
    value = float(warp.value or 0.0)
    if value >= FOLDED_DEG:
        message = (
            f"the edge of regression lies inside{_crossing(surface, warp)}: the patch folds back; shorten the rulings"
        )
        return Finding("edge-of-regression", message, True, warp.where)
    reached = class_by_warp(value) or "no class"
    place = f"at v = {float((warp.where or {}).get('v', 0)):.6g}" if warp.where else ""
    message = (
        f"not developable enough: warp {value:.6g} deg {place}, allowed {WARP_LIMIT_DEG[tol.accept]:g} deg "
        f"(accept = {tol.accept!r}); it reaches {reached!r}"
    )
    return Finding("not-developable", message, True, warp.where)


FOLDED_DEG = 90.0
"""From here on the end normals of a ruling look away from each other."""


def _crossing(surface: RuledSurface, warp: Metric) -> str:
    """Return where the edge of regression crosses the worst ruling, if it is known and crosses it inside."""
    v = float((warp.where or {}).get("v", 0.0))
    piece, local = surface.place_of(v)
    u = float(regression(frames(surface.patches[piece], np.array([local])))[0])
    return f" (at u = {u:.4g}, v = {v:.4g})" if 0.0 <= u <= 1.0 else ""
