"""What is left of a sheet in one straight piece, in a drawing of its own.

Its lower left corner is the origin; it is not turned, so that the grain runs as it did.  On the drawing of the sheet it
is a closed rectangle on layer SHEET, which nobody cuts (`stages.write.drawing`): whoever wants the piece off cuts along
its free sides, which are a gap away from all parts.
"""

from collections.abc import Iterable

from stages.model.sheet import SheetLayout
from stages.write.drawing import Drawing, Item, rectangle

FOLDER = "remnants/"


def remnant_drawings(layouts: Iterable[SheetLayout]) -> list[Drawing]:
    """Return `remnants/<stock>-<n>.dxf` for every sheet that leaves an offcut."""
    left = [(f"{layout.sheet.id}-{layout.index}", layout.offcut) for layout in layouts]
    return [
        Drawing(f"{FOLDER}{name}.dxf", (Item("SHEET", "", rectangle(piece.width_mm, piece.height_mm)),), ())
        for name, piece in left
        if piece is not None
    ]
