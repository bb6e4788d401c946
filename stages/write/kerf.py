"""Contours half a beam beside the nominal ones, for files that nobody offsets any more; whether they are.

What is nested stays nominal.  A contour that the beam does not fit into is refused with its place.  The files are
judged by distances, in closed form, between what they hold and the nominal contours: no offset is made for that.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from stages.geometry.paths import manyfits
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.beside import Corners
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.geometry.paths.compensation import Fit, TooNarrow, compensated
from stages.model.cutfile import Machine
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Metric
from stages.write.chains import Entity
from stages.write.drawing import Item

OFF_MM = 1e-6
"""How exactly a contour as read must lie half a beam beside the nominal one: ends of arcs are read to 1e-6 mm."""

CUT_LAYERS = ("CUT_INNER", "CUT_OUTER")

NARROW_REMEDY = 'widen it, take a finer cut, or write nominal contours (kerf_compensation = "none")'


def corners_of(machine: Machine) -> Corners:
    """Return how corners are closed: without arcs for a flavour that has none."""
    return Corners(machine.helps.mitred or machine.flavour == "polylines", LEAST_PIECE_MM)


def beam_patterns(patterns: Sequence[FlatPattern], machine: Machine) -> tuple[list[FlatPattern], tuple[Finding, ...]]:
    """Return the patterns with the contours that the beam's middle runs along, and those that it does not fit into."""
    if machine.helps.offset_mm == 0.0:
        return list(patterns), ()
    findings: list[Finding] = []
    made = []
    for pattern in patterns:
        ways = [_way(contour, machine) for contour in (pattern.outer, *pattern.inner)]
        findings += _narrow(pattern, ways)
        outer, *inner = (
            contour if isinstance(way, TooNarrow) else replace(contour, path=way, nominal=contour.path)
            for contour, way in zip((pattern.outer, *pattern.inner), ways, strict=True)
        )
        made.append(pattern.replace(outer=outer, inner=tuple(inner)))
    return made, tuple(findings)


def _way(contour: Contour, machine: Machine) -> ArcPath | TooNarrow:
    return compensated(contour.path, machine.helps.offset_mm, corners_of(machine))


def _narrow(pattern: FlatPattern, ways: Sequence[ArcPath | TooNarrow]) -> Iterator[Finding]:
    """Yield the contours that are narrower than the beam somewhere."""
    names = ["the outline", *(contour.name or "a hole" for contour in pattern.inner)]
    for name, way in zip(names, ways, strict=True):
        if isinstance(way, TooNarrow):
            yield too_narrow(f"'{pattern.part}': {name}", way)


def too_narrow(name: str, way: TooNarrow) -> Finding:
    """Return the finding that a contour is narrower than the beam."""
    x, y = way.at.tolist()
    message = f"{name} is narrower than the kerf at ({x:.6g}, {y:.6g}): {NARROW_REMEDY}"
    return Finding("narrower-than-kerf", message, fatal=True, where={"x": x, "y": y})


def fits(entities: Sequence[Entity], items: Sequence[Item], offset_mm: float) -> list[Fit]:
    """Return how the contours of a file lie beside the nominal ones; none where their number is not that drawn.

    entities: as read, contours with tabs put together.  items: as drawn, in the same order.
    """
    nominal = [item.nominal for item in items if item.nominal is not None]
    read = [one.path for one in entities if one.layer in CUT_LAYERS and one.closed and one.path is not None]
    if len(read) != len(nominal):
        return []
    return manyfits.fits(nominal, read, offset_mm)


def offset_metrics(found: Sequence[Fit]) -> tuple[Metric, ...]:
    """Return how far the written contours are from half a beam beside the nominal ones, and what is left standing."""
    if not found:
        return ()
    off, left = max(one.off_mm for one in found), max(one.left_mm for one in found)
    return Metric("kerf_offset_error_mm", off, "mm", limit=OFF_MM), Metric("kerf_left_mm", left, "mm")
