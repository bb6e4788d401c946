"""A drawing as PDF at 1:1: on one page as large as it is, or on pages of a usual size that are laid together.

In a corner of every page, outside of what is shown of the drawing, lies a line of 100 mm: a print on which it is not
100 mm long was scaled.  Pages that belong together say which row and column they are, show the crosses by which they
are laid on each other (`stages.write.tiles`), and a dashed frame around what they show.
"""

import numpy as np

from stages.model.cutfile import Machine
from stages.write.drawing import Drawing, Label, extent
from stages.write.pdf import LETTER_WIDTH, LINE_MM, drawn, layers_of, line, numbers, on_layer, text
from stages.write.pdfobjects import Box, Page, pdf_text
from stages.write.tiles import BORDER_MM, Tile, Tiling, tiling

MARGIN_MM = 15.0
CHECK_MM = 100.0
CHECK_LAYER, REGISTER_LAYER = "CHECK_100_MM", "REGISTER"
CHECK_BELOW_MM = 7.0
"""How far the check line lies below what a page shows; its ticks and its text reach half of that towards it."""

TICK_MM, ARM_MM = 1.5, 3.0
TEXT_MM, TEXT_ABOVE_MM = 2.0, 2.5
DASHES = "[2 2] 0 d"
TITLE_LETTERS = 40
"""Of a title on a page: what else is said on the narrowest page beside it stays within what it shows."""


def drawing_pdf(drawing: Drawing, machine: Machine) -> str:
    """Return the drawing as a PDF file on the paper that the machine's drawings have; the same one, the same text."""
    paths = [item.path for item in drawing.items]
    low_x, low_y, high_x, high_y = box = extent(paths)
    layers = layers_of(drawing)
    named = [*(machine.layers[layer].name for layer in layers), CHECK_LAYER]
    title = drawing.path.rpartition(".")[0]
    if machine.paper == "fit":
        pages = [_whole(box, title, len(layers))]
    else:
        tiled = tiling(box, paths, machine.paper)
        pages = [_page(tile, tiled, title, len(layers)) for tile in tiled.tiles]
        named.append(REGISTER_LAYER)
    around = low_x - MARGIN_MM, low_y - MARGIN_MM, high_x + MARGIN_MM, high_y + MARGIN_MM
    return pdf_text(title, named, around, drawn(drawing, machine), pages)


def _whole(box: Box, title: str, check: int) -> Page:
    """Return the page that shows a drawing as a whole; wide enough for the check line.  check: its layer."""
    low_x, low_y, high_x, high_y = box
    width = max(high_x - low_x, CHECK_MM) + 2.0 * MARGIN_MM
    shown = f"q 1 0 0 1 {numbers((MARGIN_MM - low_x, MARGIN_MM - low_y))} cm /D Do Q\n"
    content = shown + check_line(MARGIN_MM, title[:TITLE_LETTERS], check)
    return Page(width, high_y - low_y + 2.0 * MARGIN_MM, content)


def _page(tile: Tile, tiled: Tiling, title: str, check: int) -> Page:
    """Return one of the pages that are laid together.  check: the layer of the check line; crosses are on the next."""
    width, height = tiled.window_mm
    frame = f"{numbers((BORDER_MM, BORDER_MM, width, height))} re"
    moved = f"1 0 0 1 {numbers((BORDER_MM - tile.x, BORDER_MM - tile.y))} cm"
    crosses = "".join(_cross(x, y) for x, y in tiled.crosses)
    register = on_layer(check + 1, f"0 G {LINE_MM:g} w\n{crosses}")
    edge = on_layer(check + 1, f"0.6 G {LINE_MM:g} w {DASHES} {frame} S\n")
    content = f"q {frame} W n {moved} /D Do\n{register}Q\nq {edge}Q\n"
    place = f"row {tile.row} of {tiled.rows}, column {tile.column} of {tiled.columns}"
    return Page(*tiled.paper_mm, content + check_line(BORDER_MM, f"{title[:TITLE_LETTERS]}  {place}", check))


def _cross(x: float, y: float) -> str:
    return line(x - ARM_MM, y, x + ARM_MM, y) + line(x, y - ARM_MM, x, y + ARM_MM)


def check_line(margin_mm: float, title: str, layer: int) -> str:
    """Return the line of 100 mm with its ends marked, and what it is for, below what a page shows."""
    x, y = margin_mm, margin_mm - CHECK_BELOW_MM
    ticks = "".join(line(end, y - TICK_MM, end, y + TICK_MM) for end in (x, x + CHECK_MM))
    words = f"100 mm at 1:1   {title}"
    middle = np.array([x + TEXT_MM * LETTER_WIDTH * len(words) / 2.0, y + TEXT_ABOVE_MM])
    said = text(Label("LABEL", words, middle, TEXT_MM, 0.0))
    return on_layer(layer, f"0 G 0 g {LINE_MM:g} w\n{line(x, y, x + CHECK_MM, y)}{ticks}{said}")
