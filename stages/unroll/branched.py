"""The flat pattern of faces that go over into each other in any direction, as one blank.

Each face is laid flat along its rulings by itself and against its neighbour along their hinge (`branches`); the contour
is made of the faces' own exact edges (`spliced`).  Lengths, areas, metric and strain are those of each face, the worst
of them reported; how far the flat faces miss each other along the hinges is `flat_gap_mm`, rings that close among them.
Hinges at which the curvature jumps are bend lines, as on a strip (`tangencies`).

A face with warp keeps its rulings and is strained across them: it is not flattened by least strain, which would bend
its hinges.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees

import numpy as np

from stages.geometry.curves import contours
from stages.geometry.flat.mapped import MappedEdge, backwards
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.ruled.turning import FLAT
from stages.model.features import RulingMarks
from stages.model.gathered import Rule, gathered, told
from stages.model.pattern import Contour, FlatPattern, Mark
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import BranchedSurface, Certificate
from stages.model.tolerances import Class, Tolerances
from stages.unroll import outline
from stages.unroll.branches import Branch, branches, contours_of, hinge_bend, hinge_gap, hinge_line, turned_rad
from stages.unroll.branchfeatures import left_of, on_branches
from stages.unroll.features import Features
from stages.unroll.finished import box, finished, flat_figures
from stages.unroll.forming import Forming, formed, standing
from stages.unroll.limits import area_findings, class_of, cut_twice, overlap, overlap_findings, strain_findings
from stages.unroll.marks import ruling_marks
from stages.unroll.onpart import on_part
from stages.unroll.rolls import Rolling, scheduled
from stages.unroll.thickness import Neutral, neutral
from stages.unroll.trimmed import length_error, net_areas

RULES: dict[str, Rule] = {
    "max_extension": "most",
    "max_compression": "most",
    "bend_lines": "sum",
    "bend_angle_error_deg": "sum",
    "bend_pitch_min_mm": "least",
    "k_factor": "alike",
    "neutral_offset_mm": "alike",
}
OF_THE_WHOLE = ("length_error", "area_error", "flat_gap_mm", "strain_rms")
"""Measured on the faces together."""
REMEDY = "into several bodies in the CAD program, at the edge after which it overlaps"


def unroll_branched(certificate: Certificate, surface: BranchedSurface, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the flat pattern in the frame of the first face, or None with the reason.

    Raises NoSolutionError where a quadrature does not resolve, or the arcs do not keep the chord.
    """
    sheets = [neutral(face, tol) for face in surface.faces]
    findings = _sheet_findings(surface, sheets)
    if any(finding.fatal for finding in findings):
        metrics = gathered([sheet.metrics for sheet in sheets], surface.numbers, RULES)
        detail: dict[str, object] = {"class": "rejected", "thickness": _thickness(surface.numbers, sheets)}
        return Outcome(None, StageReport("unroll", surface.part.name, metrics, findings, detail))
    return _joined(surface, branches(surface, sheets, tol), certificate.reached, tol)


def _sheet_findings(surface: BranchedSurface, sheets: Sequence[Neutral]) -> tuple[Finding, ...]:
    return told([sheet.findings for sheet in sheets], surface.numbers)


def _joined(
    surface: BranchedSurface, made: Sequence[Branch], by_warp: Class, tol: Tolerances
) -> Outcome[FlatPattern | None]:
    """Return the pattern of faces that lie in the plane."""
    name = surface.part.name
    gap = Metric("flat_gap_mm", max(hinge_gap(surface, made, h) for h in surface.hinges), "mm", "sampled", tol.join_mm)
    sheet_findings = _sheet_findings(surface, [one.sheet for one in made])
    if not gap.passed:
        return Outcome(None, StageReport("unroll", name, (gap,), (*sheet_findings, _unjoined(gap, made)), REJECTED))
    outer, *holes = _contours(contours_of(surface, made), name, tol)
    covered, rolls = overlap(outer), [scheduled(one.sheet.bent, one.sheet.surface, one.development) for one in made]
    features, bends = on_branches(surface, made, outer, tuple(holes), tol), [_bends(one) for one in made]
    metrics = (*_metrics(made, outer, holes, tol), gap, covered, *_gathered(made, bends, rolls), *features.metrics)
    strain = next(metric for metric in metrics if metric.name == "max_strain")
    findings = (
        *sheet_findings,
        *strain_findings(strain, by_warp, tol),
        *area_findings(outer),
        *overlap_findings(covered, REMEDY),
        *cut_twice([outer, *holes]),
        *features.findings,
        *told([(*bend.findings, *roll.findings) for bend, roll in zip(bends, rolls, strict=True)], surface.numbers),
    )
    lines = left_of([_lines(one, bend, tol.chord_mm) for one, bend in zip(made, bends, strict=True)], features)
    detail = {"class": class_of(strain, by_warp)} | _figures(made, features) | _tables(made, bends, rolls, lines)
    report = StageReport("unroll", name, metrics, findings, detail)
    if not report.passed:
        return Outcome(None, report)
    hinges = on_part(hinge_marks(surface, made), features.outer, features.inner)
    marks = (*features.marks, *(mark for row in lines for mark in row), *hinges)
    whole = replace(features, marks=marks)
    return Outcome(finished(surface.part, whole, box(outer), tol), report)


REJECTED: dict[str, object] = {"class": "rejected"}


def _unjoined(gap: Metric, made: Sequence[Branch]) -> Finding:
    """Refuse faces that do not meet in the flat: their edges differ, or a neutral surface that runs into an apex."""
    message = f"laid flat, faces that share an edge lie {gap.value:.4g} mm apart there, allowed {gap.limit:g} mm"
    if any(one.sheet.bent.kept is not None for one in made):
        remedy = "the neutral surface of a cone runs into its apex; give the middle surface and K = 0.5"
        return Finding("flat-gap", f"{message}: {remedy}, or cut the tips off", True)
    return Finding("flat-gap", f"{message}: their edges in the file do not fit each other", True)


# Contours and lines


def _contours(rings: Sequence[tuple[MappedEdge, ...]], name: str, tol: Tolerances) -> tuple[Contour, ...]:
    """Return the outer contour, which is the one of the largest area, and the holes in order, traced."""
    areas = [contours.area(ring) for ring in rings]
    first = int(np.argmax(areas))
    holes = [ring if area < 0.0 else backwards(ring) for i, (ring, area) in enumerate(zip(rings, areas, strict=True))
             if i != first]  # fmt: skip
    traced = (outline.contour(hole, tol.chord_mm, f"hole-{i}") for i, hole in enumerate(holes, 1))
    return (outline.contour(rings[first], tol.chord_mm, name), *traced)


def _bends(branch: Branch) -> Forming:
    """Return the bend lines of a face, named after it; tight bends and folds where none are asked for."""
    sheet, part = branch.sheet, branch.sheet.surface.part
    found = [formed(sheet.bent, sheet.surface, branch.development, spec) for spec in part.spec.bend]
    found = found or [standing(sheet.bent, sheet.surface, branch.development)]
    marks = tuple(_called(mark, branch.number) for one in found for mark in one.marks)
    rows = tuple(row | {"name": _name(str(row["name"]), branch.number)} for one in found for row in one.rows)
    metrics = tuple(metric for one in found for metric in one.metrics)
    return Forming(marks, metrics, tuple(finding for one in found for finding in one.findings), rows)


def _called(mark: Mark, number: int) -> Mark:
    return Mark(_name(mark.name, number), mark.path, mark.layer)


def _name(name: str, number: int) -> str:
    return f"face-{number}-{name}"


def _lines(branch: Branch, bends: Forming, chord_mm: float) -> tuple[Mark, ...]:
    """Return bend lines and marked rulings of a face as far as they lie on it."""
    specs = [spec for spec in branch.sheet.surface.part.spec.mark if isinstance(spec, RulingMarks)]
    rulings = [_called(mark, branch.number) for spec in specs
               for mark in ruling_marks(branch.development, spec, chord_mm=chord_mm)]  # fmt: skip
    if not bends.marks and not rulings:
        return ()
    outer = outline.contour(branch.outer.edges, chord_mm)
    inner = [outline.contour(backwards(hole.edges), chord_mm) for hole in branch.inner]
    return on_part([*bends.marks, *rulings], outer, inner)


def hinge_marks(surface: BranchedSurface, made: Sequence[Branch]) -> tuple[Mark, ...]:
    """Return the hinges at which the curvature jumps as bend lines."""
    found = [(hinge, hinge_bend(surface, hinge)) for hinge in surface.hinges]
    bent = [(hinge_line(surface, made, hinge), bend) for hinge, bend in found if bend != 0.0]
    return tuple(
        Mark(f"tangency-{i}", ArcPath(line, np.zeros(2), closed=False), "BEND_UP" if bend > 0.0 else "BEND_DOWN")
        for i, (line, bend) in enumerate(bent, 1)
    )


# Figures


def _gathered(made: Sequence[Branch], bends: Sequence[Forming], rolls: Sequence[Rolling]) -> tuple[Metric, ...]:
    """Return what was measured of every face as figures of the blank."""
    rows = [
        (
            *(metric for metric in one.found.metrics if metric.name not in OF_THE_WHOLE),
            *(one.sheet.metrics if _turns(one) or not any(_turns(other) for other in made) else ()),
            *bend.metrics,
            *roll.metrics,
        )
        for one, bend, roll in zip(made, bends, rolls, strict=True)
    ]
    return gathered(rows, [one.number for one in made], RULES)


def _turns(branch: Branch) -> bool:
    """Return whether a face bends: a plane has no K and no offset."""
    return branch.sheet.bent.bends.total_rad > FLAT


def _areas(made: Sequence[Branch]) -> tuple[float, float, float]:
    """Return the areas of all faces together: on the neutral surfaces, in the plane, and as given, mm2."""
    neutral_, flat, given = np.sum([net_areas(one.outer, one.inner) for one in made], axis=0)
    return float(neutral_), float(flat), float(given)


def _metrics(made: Sequence[Branch], outer: Contour, holes: Sequence[Contour], tol: Tolerances) -> tuple[Metric, ...]:
    """Return the figures of the faces together."""
    before, after, _ = _areas(made)
    errors = gathered([(length_error([one.outer, *one.inner]),) for one in made], [one.number for one in made], {})
    squares = [(one.found.surface_area, float(_rms(one) or 0.0) ** 2) for one in made]
    rms = float(np.sqrt(sum(area * square for area, square in squares) / sum(area for area, _ in squares)))
    enclosed = sum(contours.area(one.edges) for one in (outer, *holes))
    allowed = tol.join_mm * sum(contours.length(one.edges) for one in (outer, *holes)) / after
    return (
        *errors,
        Metric("area_error", abs(after - before) / before),
        Metric("joined_area_error", abs(enclosed - after) / after, "", "sampled", allowed),
        Metric("strain_rms", rms),
    )


def _rms(branch: Branch) -> float | bool | None:
    return next(metric.value for metric in branch.found.metrics if metric.name == "strain_rms")


def _figures(made: Sequence[Branch], features: Features) -> dict[str, object]:
    """Return the figures of both sides; the edges of a blank of several faces have no names."""
    before, after, given = _areas(made)
    length = contours.length(features.outer.edges)
    changed = any(one.sheet.bent.surface is not one.sheet.surface for one in made)
    return {
        "surface": {"area": before, "edges": None},
        "flat": flat_figures(features, box(features.outer), area=after, length=length),
        "given": {"area": given, "edges": None} if changed else None,
        "flat_faces": [_face_row(one) for one in made],
    }


def _face_row(branch: Branch) -> dict[str, object]:
    """Return what a face is in the flat: its area, and the angle that it bends by."""
    area, flat, _ = net_areas(branch.outer, branch.inner)
    return {
        "face": branch.number,
        "surface_area": float(area),
        "flat_area": float(flat),
        "angle_deg": degrees(turned_rad(branch)),
    }


def _tables(
    made: Sequence[Branch], bends: Sequence[Forming], rolls: Sequence[Rolling], lines: Sequence[tuple[Mark, ...]]
) -> dict[str, object]:
    """Return bend table, roll schedule and thickness of every face, each row with the number of its face."""
    numbers = [one.number for one in made]
    pieces: list[dict[str, list[object]]] = [{mark.name: [] for mark in row} for row in lines]
    for found, row in zip(pieces, lines, strict=True):
        for mark in row:
            found[mark.name].append(mark.path.vertices.tolist())
    return {
        "bends": [
            row | {"face": number, "pieces": found.get(str(row["name"]), [])}
            for number, bend, found in zip(numbers, bends, pieces, strict=True)
            for row in bend.rows
        ],
        "rolls": [row | {"face": number} for number, roll in zip(numbers, rolls, strict=True) for row in roll.rows],
        "thickness": _thickness(numbers, [one.sheet for one in made]),
        "sensitivity": {"note": "of a blank that bends in several directions it is not computed"},
    }


def _thickness(numbers: Sequence[int], sheets: Sequence[Neutral]) -> dict[str, object]:
    """Return where the sheet lies about each face."""
    rows = [{"face": number} | sheet.detail for number, sheet in zip(numbers, sheets, strict=True)]
    return {"faces": rows}
