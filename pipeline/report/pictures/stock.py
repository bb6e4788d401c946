"""The stock under a nest: its outline, defects, zones, grain, edge gap and dimensions.

Defects are hatched; zones are tinted, the worse the darker, with their quality written into them; where they overlap
the lower quality lies on top, since it counts.  Their edges are drawn once more above the parts.  A roll ends where it
is cut off.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from shapely import Polygon, make_valid

from pipeline.report.pictures.canvas import GREY, INK, LEFT, Box, Canvas, Fit, arrow, length_text
from pipeline.report.pictures.flat import closed_polygon, compound, dimension
from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, bounds, polygon
from stages.model.pattern import FlatPattern
from stages.model.sheet import Sheet, SheetLayout
from stages.model.used import used_length_mm

ZONE_TINTS = ("#FFF3D1", "#FFE29A", "#FFCB5C", "#F2A93B", "#D98A2B", "#B86E20", "#8F5216")
"""From the best zone to the worst; what lies beyond the last has its colour."""

DEFECT_FILL, DEFECT_HATCH = "#EFEFEF", "xxxx"
STOCK_FILL = "#FFFFFF"
ROW, SWATCH = 0.24, np.array([[0.0, -0.07], [0.22, -0.07], [0.22, 0.07], [0.0, 0.07]])
"""Inches: height of a line of the legend, and the patch of colour in it."""

GRAIN_REACH = 0.25
"""Inches from the middle of the arrow to its tips."""


def frame_of(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> Points2:
    """Return the lower left and the upper right corner of the stock in its frame, mm."""
    sheet = layout.sheet
    if sheet.outline is None:
        return np.array([[0.0, 0.0], [used_length_mm(layout, patterns), sheet.height_mm]])
    return np.array(bounds(sheet.outline)).reshape(2, 2)


def edge_path(sheet: Sheet, frame: Points2) -> ArcPath:
    """Return the edge of the stock; of a roll as far as it is used."""
    if sheet.outline is not None:
        return sheet.outline
    (x0, y0), (x1, y1) = frame
    return ArcPath(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), np.zeros(4), closed=True)


def draw_ground(canvas: Canvas, sheet: Sheet, frame: Points2, fit: Fit) -> None:
    """Draw what lies under the parts: zones, as far as they lie on the stock, and defects."""
    tints = zone_tints(sheet)
    for quality, part in _zone_parts(sheet, frame, fit):
        rings = [fit.place(np.array(ring.coords)) for ring in (part.exterior, *part.interiors)]
        canvas.areas([compound(rings)], tints[quality])
        inside = part.representative_point()
        canvas.text(fit.place(np.array([[inside.x, inside.y]]))[0], f"{quality}", 7.0, GREY)
    for defect in sheet.defects:
        canvas.areas([compound([_placed(defect, fit)])], DEFECT_FILL, GREY, 0.7, DEFECT_HATCH)


def draw_edges(canvas: Canvas, sheet: Sheet, frame: Points2, fit: Fit) -> None:
    """Draw what lies over the parts: edges of zones, the edge of the stock with its gap, and the dimensions."""
    zones = [fit.place(np.array(part.exterior.coords)) for _, part in _zone_parts(sheet, frame, fit)]
    canvas.lines(zones, GREY, 0.6, (3.0, 2.0))
    edge = edge_path(sheet, frame)
    canvas.lines([_placed(edge, fit)], INK, 1.6)
    canvas.lines(list(_gap_lines(sheet, edge, fit)), GREY, 0.7, (4.0, 3.0))
    low, high = fit.place(frame)
    below, left = np.array([0.0, 0.32]), np.array([0.32, 0.0])
    ends = np.array([high[0], low[1]]), np.array([low[0], high[1]])
    wide, tall = (frame[1] - frame[0]).tolist()
    used = "used " if sheet.is_roll else ""
    dimension(canvas, low - below, ends[0] - below, below, f"{used}{length_text(wide)} mm")
    dimension(canvas, low - left, ends[1] - left, left, f"{length_text(tall)} mm")


def _zone_parts(sheet: Sheet, frame: Points2, fit: Fit) -> Iterator[tuple[int, Polygon]]:
    """Yield the qualities of the zones and what of them lies on the stock, the best first."""
    room = make_valid(_polygon(edge_path(sheet, frame), fit))
    for zone in sorted(sheet.zones, key=lambda zone: -zone.quality):
        shown = make_valid(_polygon(zone.outline, fit)).intersection(room)
        parts = getattr(shown, "geoms", [shown])
        yield from ((zone.quality, part) for part in parts if isinstance(part, Polygon) and not part.is_empty)


def _gap_lines(sheet: Sheet, edge: ArcPath, fit: Fit) -> Iterator[Points2]:
    """Yield the lines that parts keep behind, on the page."""
    if sheet.edge_gap_mm <= 0.0:
        return
    room = _polygon(edge, fit).buffer(-sheet.edge_gap_mm, join_style="mitre")
    for part in getattr(room, "geoms", [room]):
        if not part.is_empty:
            yield fit.place(np.array(part.exterior.coords))


def zone_tints(sheet: Sheet) -> dict[int, str]:
    """Return the colour of each quality on a sheet."""
    falling = sorted({zone.quality for zone in sheet.zones}, reverse=True)
    return {quality: ZONE_TINTS[min(i, len(ZONE_TINTS) - 1)] for i, quality in enumerate(falling)}


def draw_legend(canvas: Canvas, sheet: Sheet, box: Box) -> Box:
    """Say at the bottom of a box what tints and hatching mean; return the box that is left."""
    rows = [(tint, "", f"zone of quality {quality}") for quality, tint in zone_tints(sheet).items()]
    if sheet.defects:
        rows.append((DEFECT_FILL, DEFECT_HATCH, f"defect{'s' * (len(sheet.defects) > 1)}: {len(sheet.defects)}"))
    for i, (fill, hatch, words) in enumerate(reversed(rows)):
        y = box.bottom + (i + 0.5) * ROW
        corners = SWATCH + np.array([box.left, y])
        canvas.areas([compound([np.vstack([corners, corners[:1]])])], fill, GREY, 0.6, hatch)
        canvas.text((box.left + 0.32, y), words, 8.0, INK, LEFT)
    return box.inset(0.0, len(rows) * ROW, 0.0, 0.0)


def draw_grain(canvas: Canvas, sheet: Sheet, left: float, bottom: float) -> None:
    """Draw the direction of the grain as an arrow with two heads, and say what it is."""
    if sheet.grain_deg is None:
        return
    angle = np.radians(sheet.grain_deg)
    along = GRAIN_REACH * np.array([np.cos(angle), np.sin(angle)])
    middle = np.array([left + GRAIN_REACH, bottom + GRAIN_REACH])
    arrow(canvas, middle, middle + along, 1.0)
    arrow(canvas, middle, middle - along, 1.0)
    words = "line of tightness" if sheet.kind == "hide" else "grain"
    at = (left + 2.0 * GRAIN_REACH + 0.12, bottom + GRAIN_REACH)
    canvas.text(at, f"{words} {sheet.grain_deg % HALF_TURN:g}\u00b0", 8.0, INK, LEFT)


HALF_TURN = 180.0


def _polygon(path: ArcPath, fit: Fit) -> Polygon:
    return Polygon(polygon(path, accuracy=fit.fine_mm))


def _placed(path: ArcPath, fit: Fit) -> Points2:
    return fit.place(closed_polygon(path, fit))
