"""The roll schedule of a part that bends smoothly: what the roll is set to, place by place along the pattern.

At stations of equal turning: how far the sheet has been fed (across the rulings, at their middles), the inside radius
at both ends of the ruling, and the tilt of the roll.  Along a ruling the radius is linear; the cone that touches there
has the half-angle atan((rho1 - rho0) / |p|), which is the angle between ruling and roll axis.  At an apex the inside
radius is 0: no tool leaves that, so the row has no tool radius at that end, and says so.

Springback of an elastic, perfectly plastic sheet [1]_: bent to the radius R of its middle, it springs back to R_f,

    R / R_f = 4 X^3 - 3 X + 1,    X = sigma_y R / (E t),    for X <= 1/2;

above, nothing stays bent.  With x = X and c = sigma_y R_f / (E t) the tool's radius is the root of
4 x^3 - (3 + 1/c) x + 1 = 0 in (0, 1/2).  An estimate: it knows neither hardening nor the friction of a roll, and yield
strengths of delivered sheet lie well above their least values.

.. [1] F. J. Gardiner, "The springback of metals", Transactions of the ASME 79 (1957), 1-9.
"""

from dataclasses import dataclass, replace
from math import ceil, radians

import numpy as np

from stages.geometry.arrays import Values, norm
from stages.geometry.flat.flatmap import Development
from stages.geometry.ruled.tightest import Tight, tightest
from stages.geometry.ruled.turning import FLAT, Run, is_fold, places, run_angle, runs
from stages.model.material import Material
from stages.model.report import Finding, Metric, Where
from stages.model.surface import RuledSurface
from stages.unroll.bent import Bent, across, radii_at
from stages.unroll.forming import flat_rulings

STEP = radians(30.0)
"""Turning between two stations: 12 for a full turn, between which the radius of what is rolled changes little."""
MOST_STATIONS = 24
"""Stations of one run: a schedule that is read by a person."""
ESTIMATE = "estimate: elastic, perfectly plastic sheet"


@dataclass(frozen=True, slots=True)
class Rolling:
    """The schedule, one row a station, and what was found."""

    rows: tuple[dict[str, object], ...] = ()
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()


def rolled(bent: Bent) -> Rolling:
    """Return the roll schedule; empty for a part that bends nowhere but at folds."""
    tight = [(sign, found) for sign in (1.0, -1.0) if (found := tightest(bent.bends, sign)) is not None]
    if not tight:
        return Rolling()
    stations = [station for run in runs(bent.bends) for station in _stations(bent, run, tight)]
    return Rolling(tuple(_rows(bent, stations)), *_springback(bent, tight))


def scheduled(bent: Bent, neutral: RuledSurface, development: Development) -> Rolling:
    """Return the roll schedule with the ends of each ruling in the flat frame, from c0 to c1."""
    made = rolled(bent)
    if not made.rows:
        return made
    at = [v for row in made.rows if isinstance(v := row["v"], float)]
    lines = flat_rulings(neutral, development, at)
    rows = (
        row | {"from": ends[0].tolist(), "to": ends[1].tolist()} for row, ends in zip(made.rows, lines, strict=True)
    )
    return replace(made, rows=tuple(rows))


def _stations(bent: Bent, run: Run, tight: list[tuple[float, Tight]]) -> list[tuple[float, str]]:
    """Return the places of a run, its ends and the tightest place among them, and the way it bends."""
    angle = run_angle(run)
    if is_fold(run[0]) or abs(angle) <= FLAT:
        return []
    steps = min(max(ceil(abs(angle) / STEP), 2), MOST_STATIONS)
    found = places(bent.bends, run, np.arange(steps + 1) / steps).tolist()
    sharpest = _curvatures(bent, np.array(found)).max()
    found += [
        t.piece + t.v
        for _, t in tight
        if found[0] < t.piece + t.v < found[-1] and t.curvature > sharpest * (1.0 + ALIKE)
    ]
    return [(place, "up" if angle > 0.0 else "down") for place in sorted(found)]


ALIKE = 1e-6
"""A place that is tighter than all stations by less, as a share, is one of many alike: a pipe has no tightest place."""


def _curvatures(bent: Bent, at: Values) -> Values:
    """Return the curvature at the narrower end of rulings, on the surface as given, 1/mm; at an apex infinite or 0."""
    rate, width0, width1 = bent.rates_at(at).T
    narrower = np.minimum(width0, width1)
    at_apex = np.where(rate == 0.0, 0.0, np.inf)
    curvatures: Values = np.divide(np.abs(rate), narrower, out=at_apex, where=narrower > 0.0)
    return curvatures


def _rows(bent: Bent, stations: list[tuple[float, str]]) -> list[dict[str, object]]:
    """Return the schedule."""
    at = np.array([place for place, _ in stations])
    fed = across(bent, at).mean(axis=1)
    inside, tilts = radii_at(bent, at), _tilts(bent, at)
    rows: list[dict[str, object]] = []
    for (place, side), distance, radii, tilt in zip(stations, fed, inside, tilts, strict=True):
        tilted = None if None in radii else float(tilt)
        row: dict[str, object] = {
            "v": bent.v_of(place),
            "distance_mm": float(distance),
            "side": side,
            "radius_mm": radii,
            "cone_tilt_deg": tilted,
        }
        tools = [tool_radius(bent.material, radius) for radius in radii]
        row |= {"tool_radius_mm": tools, "tool_radius_by": ESTIMATE} if any(tools) else {}
        rows.append(row | ({"note": TOO_SHARP} if _too_sharp(radii, tools) else {}))
    return rows


TOO_SHARP = "too sharp for a tool at the end without a tool radius, as at an apex: it is creased or hammered there"


def _too_sharp(radii: list[float | None], tools: list[float | None]) -> bool:
    """Return whether an end has a radius and no tool: it is 0, or so small that springing back leaves more."""
    missing = (tool is None for tool in tools) if any(tools) else (radius == 0.0 for radius in radii)
    return any(none and radius is not None for none, radius in zip(missing, radii, strict=True))


def _tilts(bent: Bent, at: Values) -> Values:
    """Return the angles between rulings and roll axis, deg, positive where the radius grows towards c1."""
    rate, width0, width1 = bent.rates_at(at).T
    index = np.minimum(at.astype(np.int64), len(bent.bends.pieces) - 1)
    pieces = [
        bent.bends.pieces[k].patch.p.jet(np.array([place - k]), 0)[0, 0] for k, place in zip(index, at, strict=True)
    ]
    tilts: Values = np.degrees(np.arctan2(width1 - width0, norm(np.array(pieces)) * np.abs(rate)))
    return tilts


# Springback


def tool_radius(material: Material, inside_mm: float | None) -> float | None:
    """Return the inside radius to bend to, so that the given one is left, mm.

    None where nothing is known of it, and where even a tool of no radius leaves more.
    """
    share = elastic_share(material, inside_mm)
    if share is None or inside_mm is None:
        return None
    half = (material.thickness_mm or 0.0) / 2.0
    radius = (inside_mm + half) * ratio_of(share) - half
    return radius if radius > 0.0 else None


def elastic_share(material: Material, inside_mm: float | None) -> float | None:
    """Return c = sigma_y R_f / (E t) at an inside radius; None where a value is missing."""
    strength, modulus, thickness = material.yield_strength_mpa, material.youngs_modulus_gpa, material.thickness_mm
    if strength is None or modulus is None or thickness is None or inside_mm is None:
        return None
    return strength * (inside_mm + thickness / 2.0) / (modulus * MPA_PER_GPA * thickness)


MPA_PER_GPA = 1e3


def ratio_of(c: float) -> float:
    """Return the radius bent to over the radius left, R / R_f = x / c: x by halving (0, 1/2), where the cubic falls."""
    low, high = 0.0, 0.5
    for _ in range(HALVINGS):
        x = (low + high) / 2.0
        low, high = (x, high) if 4.0 * x**3 - (3.0 + 1.0 / c) * x + 1.0 > 0.0 else (low, x)
    return (low + high) / (2.0 * c)


HALVINGS = 100
"""Beyond the rounding of a root that is small itself, where the sheet springs back nearly all the way."""


def _springback(bent: Bent, tight: list[tuple[float, Tight]]) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return the ratio at the smallest inside radius, and say where bending to the part's own radius leaves nothing."""
    sign, found = min(tight, key=lambda pair: bent.inside_mm(*pair))
    share = elastic_share(bent.material, max(bent.inside_mm(sign, found), 0.0))
    if share is None:
        return (), ()
    where: Where = {"v": bent.surface.v_of(found.piece, found.v), "u": found.u}
    ratio = 1.0 if share == 0.0 else ratio_of(share)
    metric = Metric("springback_ratio", ratio, "", "sampled", None, where)
    return (metric,), _springs_back(bent, share, where)


def _springs_back(bent: Bent, share: float, where: Where) -> tuple[Finding, ...]:
    """Say if even the smallest radius of the part is elastic: X = c > 1/2."""
    if share <= ELASTIC:
        return ()
    material = bent.material
    limit = ELASTIC * (material.youngs_modulus_gpa or 0.0) * MPA_PER_GPA / (material.yield_strength_mpa or 1.0)
    message = (
        f"bent to its own radius the sheet springs back flat: every radius is above {limit:.4g} x thickness "
        f"({limit * (material.thickness_mm or 0.0):.4g} mm), so the tool must bend it further ({ESTIMATE})"
    )
    return (Finding("springs-back", message, where=where),)


ELASTIC = 0.5
"""X at which the outer fibre just reaches the yield strength."""
