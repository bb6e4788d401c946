"""A pattern file as DXF text, R12, with the conventions of ASTM D6673-10: the only place that writes that format.

A block for each piece, inserted once, where its coordinates are, on layer 1.  Curves are chords, never bulges; every
vertex of an outline, a cut-out, a drawn line or a sew line has a POINT on it, on layer 2 or 3.  A notch is a POINT on
the outline: z is its depth, the thickness its width, the angle its direction into the piece; a drill hole is a POINT
whose thickness is its diameter.  There are no blocks but the pieces, not even those of the layouts, and no handles:
programs that take in patterns look for a piece in every block.

Not from the standard's own text, which is withdrawn: codes and texts are those that Gerber AccuMark, CLO and Valentina
write.  The depth is positive, as Valentina has it; AccuMark writes it negative.
"""

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.enums import TextEntityAlignment
from ezdxf.layouts.base import BaseLayout

from stages.geometry.arrays import Array
from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import Machine
from stages.model.pattern import Traced
from stages.model.patternlayers import BOUNDARY, CURVE, POINT_COLOUR, STANDARD, TURN, VALIDATION
from stages.write.drawing import Label, extent
from stages.write.dxf import exported, in_r12, set_extents
from stages.write.entities import DECIMALS, rounded
from stages.write.pieces import Line, PatternFile, Piece, Spot

Attributes = dict[str, str | int]

REFERENCED = 64
"""What programs write as the flags of a block that is inserted."""


def pieces_text(file: PatternFile, machine: Machine) -> str:
    """Return a pattern file as text; the same pieces give the same text."""
    document = Document.new("R12")
    document.layers.remove("Defpoints")
    colours = {layer.name: layer.colour for layer in reversed(machine.layers.values())}
    for number in sorted(STANDARD, key=int):
        document.layers.add(number, color=colours.get(number, POINT_COLOUR))
    space = document.modelspace()
    for piece in file.pieces:
        _add_piece(document, piece, machine)
        space.add_blockref(piece.name, (0.0, 0.0), dxfattribs={"layer": BOUNDARY})
    for line in file.stock:
        _add_line(space, line, machine)
    for label in file.style:
        _add_text(space, label, machine)
    lines = (*file.stock, *(line for piece in file.pieces for line in piece.lines))
    set_extents(document, extent(line.path for line in lines))
    return in_r12(exported(document, handles=False))


def _add_piece(document: Document, piece: Piece, machine: Machine) -> None:
    """Add the block of a piece."""
    block = document.blocks.new(piece.name, dxfattribs={"layer": BOUNDARY, "flags": REFERENCED})
    if block.endblk is not None:
        block.endblk.dxf.layer = BOUNDARY
    for label in piece.texts:
        _add_text(block, label, machine)
    for line in piece.lines:
        _add_line(block, line, machine)
        if line.traced is not None:
            _add_points(block, line.path, line.traced)
            _add_polyline(block, line.traced.finer, _said(VALIDATION[machine.layers[line.layer].name]))
    for spot in piece.spots:
        _add_spot(block, spot)


def _said(number: str) -> Attributes:
    """Return layer and colour of what is said of a line besides itself."""
    return {"layer": number, "color": POINT_COLOUR}


def _add_line(space: BaseLayout, line: Line, machine: Machine) -> None:
    """Add a LINE, or a POLYLINE where a path has more than two ends."""
    layer = machine.layers[line.layer]
    attributes: Attributes = {"layer": layer.name, "color": layer.colour}
    if line.path.bulges.any():
        raise ValueError("a pattern file holds chords only")
    if line.traced is None and not line.path.closed and line.path.bulges.size == 2:  # noqa: PLR2004  its two ends
        start_x, start_y, end_x, end_y = rounded(line.path.vertices.ravel(), DECIMALS)
        space.add_line((start_x, start_y), (end_x, end_y), dxfattribs=attributes)
    else:
        _add_polyline(space, line.path, attributes)


def _add_polyline(space: BaseLayout, path: ArcPath, attributes: Attributes) -> None:
    space.add_polyline2d(_points(path.vertices), close=path.closed, dxfattribs=attributes)


def _points(vertices: Array) -> list[tuple[float, float]]:
    """Return points as they will be written: those of a vertex and of its turn or curve point are the same."""
    return list(zip(rounded(vertices[:, 0], DECIMALS), rounded(vertices[:, 1], DECIMALS), strict=True))


def _add_points(space: BaseLayout, path: ArcPath, said: Traced) -> None:
    """Add the turn point or curve point of every vertex."""
    for point, turn in zip(_points(path.vertices), said.turns, strict=True):
        space.add_point(point, dxfattribs=_said(TURN if turn else CURVE))


def _add_spot(space: BaseLayout, spot: Spot) -> None:
    """Add a notch or a drill hole."""
    x, y, depth, width, angle = rounded(np.array([*spot.at, spot.depth_mm, spot.width_mm, spot.angle_deg]), DECIMALS)
    space.add_point((x, y, depth), dxfattribs={**_said(spot.layer), "thickness": width, "angle": angle})


def _add_text(space: BaseLayout, label: Label, machine: Machine) -> None:
    """Add a text: one that has a key begins where it is put, an annotation has its middle there."""
    x, y, height, angle = rounded(np.array([*label.at, label.height_mm, label.angle_deg]), DECIMALS)
    layer = machine.layers[label.layer]
    attributes: Attributes = {"layer": layer.name, "color": layer.colour}
    text = space.add_text(label.text, height=height, dxfattribs={**attributes, "rotation": angle, "insert": (x, y)})
    if label.layer == "LABEL":
        text.set_placement((x, y), align=TextEntityAlignment.MIDDLE_CENTER)
