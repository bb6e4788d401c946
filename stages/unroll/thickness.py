"""The neutral surface: what keeps its lengths when the sheet is bent, and so what is unrolled.

It lies K t from the inside face of a bend (`stages.model.kfactor`), parallel to the surface as given, which is a face
of the sheet or its middle (`stages.model.sheetface`).  Parallel surfaces of a developable are developable along the
same rulings (`geometry.ruled.offset`).

One K holds for the whole part, that of its smallest inside radius where K goes by r/t.  A K that varied along a ruling
would leave nothing to unroll: no surface then keeps its lengths.  What the one K neglects is computed, edge by edge
(`stages.unroll.variation`), and reported where it exceeds the chord.

Where K is not 1/2 and the surface bends both ways, the neutral surface changes sides at each inflection.  There the
offsets differ by (1 - 2K) t across one ruling, which moves a piece along its normal and not in the flat: the patches
are divided at the inflections, and their flat images join.  Folds between patches get no allowance of their own.

An apex is no bend: it counts neither for K nor for what one K neglects.  A neutral surface that would pass it is
replaced by one that runs into it (`stages.unroll.apexes`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.ruled.offset import offset, restricted, tapered
from stages.geometry.ruled.ruled import RuledPatch
from stages.geometry.ruled.tightest import Tight, apexes, tightest
from stages.geometry.ruled.turning import FLAT, PatchTurning, Stretch, Turning, is_fold, turning
from stages.model.kfactor import MIDDLE, k_at
from stages.model.report import Evidence, Finding, Metric, Where
from stages.model.sheetface import Layers, layers
from stages.model.surface import RuledSurface, Span
from stages.model.tolerances import Tolerances
from stages.unroll.apexes import apex_report, kept_edge
from stages.unroll.bent import Bent
from stages.unroll.variation import Variation, variation

DIN_LARGE = 10.0**0.7
"""From this r/t on, 5.01, DIN 6935 gives K = 1/2 as well."""


@dataclass(frozen=True, slots=True)
class Neutral:
    """The neutral surface (`surface`, its patches divided where it changes sides), and the part as given and bent."""

    surface: RuledSurface
    bent: Bent
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    detail: dict[str, object] = field(default_factory=dict)


def neutral(surface: RuledSurface, tol: Tolerances) -> Neutral:
    """Return the neutral surface of a part; the surface itself where no thickness is known.

    A fatal finding says that the face does not exist on this surface, or that the neutral surface would pass the edge
    of regression.  Raises NoSolutionError where the turning of the normal does not resolve and is needed.
    """
    thickness, law = surface.part.material.thickness_mm, surface.part.material.k_factor
    try:
        bends = turning(surface.patches)
    except NoSolutionError as error:
        if thickness is not None and (surface.part.spec.face != "middle" or law.rule != MIDDLE):
            raise
        return Neutral(surface, Bent(surface, NOT_BENT, Layers(0.0, 0.0), MIDDLE), findings=(_unresolved(error),))
    thin = Bent(surface, bends, Layers(0.0, 0.0), MIDDLE)
    if thickness is None:
        note = "no thickness is known: the surface itself is unrolled"
        return Neutral(surface, thin, detail={"thickness": {"note": note}})
    sheet = layers(surface.part.spec.face, bends, thickness)
    if isinstance(sheet, Finding):
        where: Where = {"v": thin.v_of(float((sheet.where or {}).get("v", 0.0)))}
        return Neutral(surface, thin, findings=(Finding(sheet.code, sheet.message, sheet.fatal, where),))
    tight = [(sign, found) for sign in (1.0, -1.0) if (found := tightest(bends, sign, apexes(bends))) is not None]
    least = min((Bent(surface, bends, sheet, MIDDLE).inside_mm(*found) for found in tight), default=np.inf)
    k = float(k_at(law.rule, np.array([max(least, 0.0) / thickness]))[0])
    return _neutral(Bent(surface, bends, sheet, k), tight, least, tol)


NOT_BENT = Turning((), ())
"""What is known of a part whose turning does not resolve."""


def _unresolved(error: NoSolutionError) -> Finding:
    message = f"the bending of the part is not known, so it has no roll schedule and no bend lines: {error}"
    return Finding("bending-unresolved", message)


def _neutral(bent: Bent, tight: list[tuple[float, Tight]], least_mm: float, tol: Tolerances) -> Neutral:
    at_apex = _at_apexes(bent)
    bent = replace(bent, kept=at_apex.kept)
    passed = (*at_apex.refused, *(finding for found in tight if (finding := _past_edge(bent, *found)) is not None))
    varied = variation(bent)
    findings = (*passed, *at_apex.findings, *_k_findings(bent, varied, tol), *_fold_findings(bent))
    made = bent.surface if passed else neutral_surface(bent)
    metrics = (*_metrics(bent), *at_apex.metrics)
    return Neutral(made, bent, metrics, findings, {"thickness": _detail(bent, least_mm, varied)})


@dataclass(frozen=True, slots=True)
class AtApexes:
    """What becomes of the apexes: the edge that stays, what that neglects, and what is refused."""

    kept: float | None = None
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    refused: tuple[Finding, ...] = ()


def _at_apexes(bent: Bent) -> AtApexes:
    """Return what is done where the neutral surface would pass an apex; nothing where it passes none."""
    points = apexes(bent.bends)
    tight = [(sign, found) for sign in (1.0, -1.0) if (found := tightest(bent.bends, sign)) is not None]
    sharp = [(sign, found) for sign, found in tight if (found.piece, found.u) in points]
    refused = tuple(finding for found in sharp if (finding := _past_edge(bent, *found)) is not None)
    if not refused:
        return AtApexes()
    kept = kept_edge(bent, points)
    if kept is None:
        return AtApexes(refused=tuple(_with_remedy(finding) for finding in refused))
    metric, finding = apex_report(bent, kept, points)
    return AtApexes(kept, (metric,), (finding,))


def _with_remedy(finding: Finding) -> Finding:
    return replace(finding, message=f"{finding.message}; give the middle surface and K = 0.5, or cut the tips off")


def _past_edge(bent: Bent, sign: float, tight: Tight) -> Finding | None:
    """Refuse a neutral surface beyond the edge of regression: the sheet is too thick for the bend."""
    radius, away = 1.0 / tight.curvature, sign * bent.sheet.neutral_mm(sign, bent.k)
    if away <= 0.0 or radius > away:
        return None
    message = (
        f"the surface bends to a radius of {radius:.4g} mm, and the neutral surface lies {away:.4g} mm towards its "
        f"centre (thickness {bent.sheet.thickness_mm:g} mm, K = {bent.k:.4g}): the inside radius would be "
        f"{bent.inside_mm(sign, tight):.4g} mm"
    )
    return Finding("offset-past-edge", message, True, {"v": bent.surface.v_of(tight.piece, tight.v), "u": tight.u})


# The surface


def neutral_surface(bent: Bent) -> RuledSurface:
    """Return the neutral surface, its patches divided where its offset changes; the surface itself if it is flat."""
    if bent.bends.total_rad <= FLAT:
        return bent.surface
    patches: list[RuledPatch] = []
    spans: list[Span] = []
    for stretches, distance in _offsets(bent):
        first, last = stretches[0], stretches[-1]
        piece, (low, high) = bent.bends.pieces[first.piece], bent.surface.spans[first.piece]
        moved = _moved(piece, distance, bent.kept)
        patches.append(restricted(moved, first.low, last.high))
        spans.append((low + Fraction(first.low) * (high - low), low + Fraction(last.high) * (high - low)))
    return replace(bent.surface, patches=tuple(patches), spans=tuple(spans))


def _moved(piece: PatchTurning, distance: float, kept: float | None) -> RuledPatch:
    if kept is None or distance == 0.0:
        return offset(piece.patch, distance, piece.normal)
    return tapered(piece.patch, distance, piece.normal, kept)


def _offsets(bent: Bent) -> list[tuple[list[Stretch], float]]:
    """Return stretches of one patch and one offset together, with that offset in mm."""
    smooth = [stretch for stretch in bent.bends.stretches if not is_fold(stretch)]
    made: list[tuple[list[Stretch], float]] = []
    for stretch, way in zip(smooth, _ways(smooth), strict=True):
        distance = bent.sheet.neutral_mm(way, bent.k)
        if made and made[-1][0][0].piece == stretch.piece and made[-1][1] == distance:
            made[-1][0].append(stretch)
        else:
            made.append(([stretch], distance))
    return made


def _ways(stretches: Sequence[Stretch]) -> list[float]:
    """Return which way each stretch bends, +1 or -1; a flat one follows the one before, or the first that bends."""
    way = next((float(np.sign(s.angle_rad)) for s in stretches if abs(s.angle_rad) > FLAT), 1.0)
    ways = []
    for stretch in stretches:
        way = float(np.sign(stretch.angle_rad)) if abs(stretch.angle_rad) > FLAT else way
        ways.append(way)
    return ways


# What is found


def _k_findings(bent: Bent, varied: Variation | None, tol: Tolerances) -> tuple[Finding, ...]:
    """Say what the one K neglects, where it counts."""
    if varied is None:
        return ()
    spread = f"K = {varied.k[0]:.4g} to {varied.k[1]:.4g}"
    if not bent.material.k_factor.given and varied.ratio[0] < DIN_LARGE:
        message = (
            f"K = {bent.k:g} is that of rolled work, and r/t goes down to {varied.ratio[0]:.4g}: DIN 6935 (for steel) "
            f"would give {spread}, and change a flat edge by {max(varied.change_mm, key=abs):.4g} mm"
        )
        return (Finding("k-default", message),)
    if bent.material.k_factor.given and varied.bound_mm > tol.chord_mm:
        message = (
            f"{spread} over the part; the one K used, {bent.k:.4g}, leaves flat edges {varied.bound_mm:.4g} mm off"
        )
        return (Finding("k-varies", message),)
    return ()


def _fold_findings(bent: Bent) -> tuple[Finding, ...]:
    """Say what sharp folds leave out: the flat pattern has the lengths of the surface up to the fold."""
    folds = [stretch for stretch in bent.bends.stretches if is_fold(stretch)]
    if not folds:
        return ()
    sharpest = max(folds, key=lambda fold: abs(fold.angle_rad))
    radius = bent.material.bend_radius_min_mm or 0.0
    message = (
        f"{len(folds)} folds have no bend allowance in the flat pattern: bent to an inside radius of {radius:g} mm, "
        f"the sharpest one, {np.degrees(abs(sharpest.angle_rad)):.4g} deg, would change the flat by "
        f"{fold_change(bent, sharpest.angle_rad, radius):.4g} mm"
    )
    return (Finding("fold-allowance", message, where={"v": bent.v_of(float(sharpest.piece))}),)


def fold_change(bent: Bent, angle_rad: float, radius_mm: float) -> float:
    """Return by how much a flat pattern with a sharp fold grows if the fold is a bend with an inside radius, mm.

    Bend allowance less both setbacks of the surface as given: theta (r + K t) - 2 rho tan(theta / 2), rho = r plus the
    distance of the given surface from the inside face; K is that of this radius.
    """
    theta, sign, t = abs(angle_rad), float(np.sign(angle_rad)), bent.sheet.thickness_mm
    k = float(k_at(bent.material.k_factor.rule, np.array([radius_mm / t]))[0])
    given = radius_mm + sign * bent.sheet.inside_mm(sign)
    return float(theta * (radius_mm + k * t) - 2.0 * given * np.tan(theta / 2.0))


# The report


def _metrics(bent: Bent) -> tuple[Metric, ...]:
    """Return K and the offset of the neutral surface; no one offset where it changes sides."""
    distances = {distance for _, distance in _offsets(bent)}
    evidence: Evidence = "proved" if isinstance(bent.material.k_factor.rule, float) else "sampled"
    if not distances:  # a plane: any face unrolls alike
        return (Metric("k_factor", bent.k, "", evidence), Metric("neutral_offset_mm", 0.0, "mm", "proved"))
    distance = distances.pop() if len(distances) == 1 else None
    return (Metric("k_factor", bent.k, "", evidence), Metric("neutral_offset_mm", distance, "mm", evidence))


def _detail(bent: Bent, least_mm: float, varied: Variation | None) -> dict[str, object]:
    offsets: list[dict[str, object]] = [
        {"v": [bent.v_of(run[0].piece + run[0].low), _end(bent, run[-1])], "offset_mm": distance}
        for run, distance in _offsets(bent)
    ]
    law = bent.material.k_factor
    detail: dict[str, object] = {
        "face": bent.surface.part.spec.face,
        "thickness_mm": bent.sheet.thickness_mm,
        "convention": law.convention,
        "k_factor": bent.k,
        "offsets": offsets,
        "smallest_inside_radius_mm": least_mm if np.isfinite(least_mm) else None,
    }
    if varied is not None:
        detail["k_over_the_part"] = {
            "by": "the job's rule" if law.given else "DIN 6935, for comparison",
            "r_over_t": list(varied.ratio),
            "k": list(varied.k),
            "edge_change_mm": list(varied.change_mm),
        }
    return detail


def _end(bent: Bent, stretch: Stretch) -> float:
    """Return the part's v at the end of a stretch."""
    return bent.surface.v_of(stretch.piece, stretch.high)
