"""Pictures for the wall of the workshop: every part, formed and flat, and every nested sheet, as PNG.

A part is shown as it will be formed (`surface`) beside its flat pattern (`flat`), edges in the same
colours; the arrangement (side by side, one above the other, pattern turned or not) is the one that shows both largest.
A rejected part is shown formed only, with the reasons.  Sheets are in `sheet`.

The same input gives the same bytes.  For looking at, not for measuring: a pixel is about 1/800 of the part.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.formedsize import formed_size
from pipeline.report.pictures.branched import as_mesh
from pipeline.report.pictures.canvas import (
    GREY,
    INK,
    TINY_MM,
    VERMILLION,
    Box,
    Canvas,
    area_text,
    fitted,
    own_settings,
    scale_bar,
    shortened,
)
from pipeline.report.pictures.edges import side_area
from pipeline.report.pictures.features import drawn_on
from pipeline.report.pictures.flat import Room, compound, draw_pattern, pattern_room
from pipeline.report.pictures.mesh import draw_mesh, mesh_sight, mesh_view
from pipeline.report.pictures.net import net, view_direction
from pipeline.report.pictures.notes import in_columns, wrapped
from pipeline.report.pictures.sheet import sheet_picture
from pipeline.report.pictures.strain import draw_scale, strain_colours
from pipeline.report.pictures.surface import MARGINS, draw_surface, sight
from stages.geometry.arrays import Vector3
from stages.geometry.mesh.meshmap import MeshMap
from stages.model.pattern import FlatPattern
from stages.model.surface import BranchedSurface, MeshSurface, Plate, RuledSurface, Surface
from stages.model.tolerances import STRAIN_LIMIT, Class

__all__ = ["part_picture", "sheet_picture"]

WIDTH, HEIGHT = 12.0, 6.6
MARGIN = 0.25
HEAD = 0.85
LINE = 0.155
"""Height of the title, and of a line of notes, inches."""

NOTE_SIGNS, NOTE_LINES = 92, 10
COLUMN_SIGNS, COLUMN_LINES = 58, 26
COLUMN = 4.3
"""Signs in a line, and lines: of the notes below in two columns, and of those in one column of so many inches."""

SPLITS = (0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
TURNED_WORTH, STACKED_WORTH = 0.85, 0.95
"""What a turned pattern and a stack are worth beside an unturned one in a row: they must show more to be chosen."""

Shown = RuledSurface | Plate | MeshSurface
"""What is drawn: a part of several faces as triangles."""


def part_picture(
    surface: Surface,
    pattern: FlatPattern | None,
    notes: Sequence[str],
    worst_v: float | None = None,
    reached: str | None = None,
    *,
    flat: MeshMap | None = None,
) -> bytes:
    """Return the picture of a part as PNG.

    pattern: None for a rejected part.
    notes: lines for the engineer, written below (or beside, with a rejected part).
    worst_v: the ruling to be pointed out, v counted over the patches.
    reached: the class that verify found, for the title.
    flat: the map of a mesh, which shows the strain where the class is one of materials that stretch.
    """
    with own_settings():
        canvas = Canvas(WIDTH, HEIGHT)
        shown = as_mesh(surface) if isinstance(surface, BranchedSurface) else surface
        found = formed_size(surface)
        size_mm = None if found is None else found[0]
        _title(canvas, shown, pattern, reached)
        if pattern is None:
            _rejected(canvas, shown, notes, worst_v, size_mm)
        else:
            strained = None if flat is None or reached not in STRAINED else (flat, STRAIN_LIMIT[STRAINED[reached]])
            _accepted(canvas, shown, pattern, notes, worst_v, strained=strained, size_mm=size_mm)
        return canvas.png()


def _title(canvas: Canvas, surface: Shown, pattern: FlatPattern | None, reached: str | None) -> None:
    spec = surface.part.spec
    canvas.text((MARGIN, HEIGHT - 0.33), shortened(spec.name, TITLE_SIGNS), 15.0, align=("left", "center"), bold=True)
    material = surface.part.material
    facts = [f"quantity {spec.quantity}", *([f"class {reached}"] if reached else [])]
    if pattern is not None:
        facts.append(f"area {area_text(area_mm2(pattern))}")
    if material.thickness_mm:
        facts.append(f"{material.name} {material.thickness_mm:g} mm thick".strip())
    canvas.text((MARGIN, HEIGHT - 0.64), "   |   ".join(facts), 10.0, align=("left", "center"))
    canvas.lines([np.array([[MARGIN, HEIGHT - HEAD], [WIDTH - MARGIN, HEIGHT - HEAD]])], GREY, 0.6)


TITLE_SIGNS = 80
STRAIN_LEGEND = ": orange is stretched flat, blue pressed together"


def area_mm2(pattern: FlatPattern) -> float:
    """Return the area inside the exact contours, holes taken off, mm2."""
    holes = sum(abs(side_area(hole.edges)) for hole in pattern.inner)
    return abs(side_area(pattern.outer.edges)) - holes


STRAINED: dict[str, Class] = {"metal": "metal", "leather": "leather"}
"""Classes of parts that are strained when they are laid flat, by their names."""


def _accepted(
    canvas: Canvas,
    surface: Shown,
    pattern: FlatPattern,
    notes: Sequence[str],
    worst_v: float | None,
    *,
    strained: tuple[MeshMap, float] | None,
    size_mm: Vector3 | None,
) -> None:
    columns = in_columns(wrapped(notes, NOTE_SIGNS, NOTE_LINES) if notes else [])
    bottom = MARGIN + LINE * len(max(columns, key=len))
    for lines, left in zip(columns, (MARGIN, WIDTH / 2.0), strict=True):
        _notes(canvas, lines, left, bottom - 0.05, 7.5)
    page = Box(MARGIN, bottom, WIDTH - MARGIN, HEIGHT - HEAD - 0.05)
    if isinstance(surface, Plate):
        rooms = {turned: pattern_room(pattern, turned=turned) for turned in (False, True)}
        turned = rooms[True].shown_in(page) * TURNED_WORTH > rooms[False].shown_in(page)
        draw_pattern(canvas, page, pattern, rooms[turned])
        return
    if isinstance(surface, MeshSurface):
        seen_from = mesh_view(surface)
        plan = arrangement(page, mesh_sight(surface, seen_from), pattern)
        if strained is None:
            draw_mesh(canvas, plan.formed, surface, seen_from, size_mm=size_mm)
        else:
            paint = strain_colours(surface, *strained)
            draw_mesh(canvas, plan.formed, surface, seen_from, size_mm=size_mm, paint=paint, legend=STRAIN_LEGEND)
            draw_scale(canvas, plan.formed, strained[1])
        draw_pattern(canvas, plan.flat, pattern, plan.room)
        return
    shape = net(surface, worst_v)
    frame = view_direction(shape)
    plan = arrangement(page, sight(shape, frame), pattern)
    draw_surface(canvas, plan.formed, shape, frame, size_mm=size_mm, features=drawn_on(shape, pattern))
    draw_pattern(canvas, plan.flat, pattern, plan.room, worst_v)


def _notes(canvas: Canvas, lines: Sequence[str], left: float, top: float, size: float) -> None:
    for i, line in enumerate(lines):
        canvas.text((left, top - (i + 0.5) * LINE), line, size, align=("left", "center"))


@dataclass(frozen=True, slots=True)
class Plan:
    """Where the formed surface and the flat pattern stand, and how much room the pattern needs, turned or not."""

    formed: Box
    flat: Box
    room: Room


def arrangement(page: Box, seen: tuple[float, float], pattern: FlatPattern) -> Plan:
    """Return the arrangement that shows both largest: the product of their longer sides counts."""
    plans = []
    for room in (pattern_room(pattern, turned=turned) for turned in (False, True)):
        for split in SPLITS:
            x, y = page.left + split * page.width, page.top - split * page.height
            row = Plan(Box(page.left, page.bottom, x, page.top), Box(x, page.bottom, page.right, page.top), room)
            stack = Plan(Box(page.left, y, page.right, page.top), Box(page.left, page.bottom, page.right, y), room)
            plans += [(row, 1.0), (stack, STACKED_WORTH)]
    return max(plans, key=lambda plan: _worth(plan[0], seen) * plan[1])[0]


def _worth(plan: Plan, seen: tuple[float, float]) -> float:
    formed = _shown_length(plan.formed.inset(*MARGINS), seen)
    return round(formed * plan.room.shown_in(plan.flat) * (TURNED_WORTH if plan.room.turned else 1.0), DECIMALS)


DECIMALS = 9
"""Of a worth: arrangements that differ by less are alike, and the first is taken."""


def _shown_length(room: Box, extent: tuple[float, float]) -> float:
    """Return how long the longer side is shown, inches."""
    scale = min(max(room.width, 0.0) / max(extent[0], TINY_MM), max(room.height, 0.0) / max(extent[1], TINY_MM))
    return scale * max(extent)


def _rejected(
    canvas: Canvas, surface: Shown, notes: Sequence[str], worst_v: float | None, size_mm: Vector3 | None
) -> None:
    """Draw the formed surface, and the reasons in a column on the right."""
    left = WIDTH - MARGIN - COLUMN
    box = Box(MARGIN, MARGIN, left - 0.15, HEIGHT - HEAD - 0.05)
    if isinstance(surface, RuledSurface):
        shape = net(surface, worst_v)
        draw_surface(canvas, box, shape, view_direction(shape), size_mm=size_mm)
    elif isinstance(surface, MeshSurface):
        draw_mesh(canvas, box, surface, mesh_view(surface), size_mm=size_mm)
    else:
        _plain_plate(canvas, box, surface)
    canvas.text((left, HEIGHT - HEAD - 0.35), "REJECTED", 22.0, VERMILLION, ("left", "center"), bold=True)
    canvas.text((left, HEIGHT - HEAD - 0.68), "no flat pattern, nothing is cut", 9.0, INK, ("left", "center"))
    _notes(canvas, wrapped(notes, COLUMN_SIGNS, COLUMN_LINES), left, HEIGHT - HEAD - 0.95, 8.0)


def _plain_plate(canvas: Canvas, box: Box, plate: Plate) -> None:
    """Draw the contours of a plate that was refused."""
    t = np.linspace(0.0, 1.0, 65)
    rings = [np.concatenate([edge.at(t) for edge in contour]) for contour in (plate.outline, *plate.holes)]
    fit = fitted(rings[0], box.inset(*MARGINS))
    canvas.areas([compound([fit.place(np.vstack([ring, ring[:1]])) for ring in rings])], "#EEEEEE", INK, 0.9)
    scale_bar(canvas, box.right - 0.3, box.bottom + 0.28, fit.scale, 1.4)
