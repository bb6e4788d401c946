"""What refuses a pattern: strain beyond the class that the job accepts, area that is covered twice, or none at all."""

from collections.abc import Sequence

from stages.geometry.paths import arcpath
from stages.geometry.paths.cover import doubled
from stages.geometry.paths.overlap import overlaps
from stages.model.pattern import Contour
from stages.model.report import Finding, Metric
from stages.model.tolerances import CLASSES, STRAIN_LIMIT, Class, Tolerances, class_by_strain
from stages.unroll import outline

TOUCHING_MM = 1e-3
"""Contours that run nearer to each other than this leave nothing between them."""


def class_of(strain: Metric, by_warp: Class) -> str:
    """Return the worse of the classes by warp and by strain; a part without warp has no strain but rounding."""
    by_strain = class_by_strain(float(strain.value or 0.0))
    return "no class" if by_strain is None else max(by_warp, by_strain, key=CLASSES.index)


def strain_findings(strain: Metric, by_warp: Class, tol: Tolerances) -> tuple[Finding, ...]:
    """Refuse a part whose strain is of a worse class than the job accepts."""
    if strain.passed:
        return ()
    value = float(strain.value or 0.0)
    message = (
        f"flattening strains the sheet by {value:.3g}, allowed {STRAIN_LIMIT[tol.accept]:g} "
        f"(accept = {tol.accept!r}); by warp it is {by_warp!r}, by strain {class_by_strain(value) or 'no class'!r}"
    )
    return (Finding("strain", message, True, strain.where),)


def overlap(outer: Contour) -> Metric:
    """Return the area that the pattern covers twice: proved where the lines and arcs that are cut cover none.

    Where edges meet at almost no angle, arcs fitted to them cross by less than the chord: what goes away on finer arcs
    (as chord^1.5, where two edges part like a parabola) is not the pattern's own.  More than the chord all along the
    contour is.
    """
    allowed = outer.chord_mm**2
    cut = covered = doubled(outer.path)
    most = outer.chord_mm * float(arcpath.lengths(outer.path).sum())
    for times in FINER:
        if allowed < covered <= most:
            covered = min(covered, doubled(outline.contour(outer.edges, outer.chord_mm / times).path))
    return covered_metric(covered, outer.chord_mm, proved=cut == 0.0)


def covered_metric(covered: float, chord_mm: float, *, proved: bool) -> Metric:
    """Return the metric of an area covered twice."""
    return Metric("overlap_mm2", covered, "mm2", "proved" if proved else "sampled", chord_mm**2)


FINER = 4.0, 16.0
"""How many times as fine the arcs are on which an overlap is looked at again."""


def area_findings(outer: Contour) -> tuple[Finding, ...]:
    """Refuse a pattern of which the lines and arcs that would be cut enclose nothing."""
    path, chord = outer.path, outer.chord_mm
    corners = len(arcpath.polygon(path, accuracy=chord))
    if corners > len("ab") and arcpath.area(path) > NO_AREA * chord**2:
        return ()
    message = f"within the chord of {chord:g} mm the outline encloses nothing: the part is too thin or too small to cut"
    return (Finding("no-area", message, fatal=True),)


NO_AREA = 1e-6
"""An area below this share of the square of the chord is none."""


def overlap_findings(covered: Metric, remedy: str) -> tuple[Finding, ...]:
    """Refuse a pattern that cannot be cut from one sheet; remedy: where to divide the part."""
    if covered.passed:
        return ()
    message = f"the flat pattern covers {covered.value:.4g} mm2 twice: divide the part {remedy}"
    return (Finding("flat-overlap", message, fatal=True),)


def cut_twice(found: Sequence[Contour]) -> tuple[Finding, ...]:
    """Refuse contours that run along each other: faces that touch in the flat and are not joined."""
    paths = [one.path for one in found]
    shared = sum(one.length_mm for one in overlaps(paths, apart=TOUCHING_MM, least=TOUCHING_MM))
    if not shared:
        return ()
    message = (
        f"in the flat {shared:.4g} mm of the contour run along each other, and would be cut twice: leave a gap between "
        "the faces there, in the CAD program"
    )
    return (Finding("cut-twice", message, True),)
