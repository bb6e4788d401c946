"""A drawing as PDF at 1:1: on one page as large as it is, or on pages of a usual size that are laid together.

In a corner of every page, outside of what is shown of the drawing, lies a line of 100 mm: a print on which it is not
100 mm long was scaled.  Pages that belong together say which row and column they are, show the crosses by which they
are laid on each other (`stages.write.tiles`), and a dashed frame around what they show.  A drawing that would take too
many of them is drawn on one page, and it is said so.
"""

from collections.abc import Iterator

import numpy as np

from stages.model.cutfile import Machine
from stages.model.report import Finding
from stages.write.drawing import Drawing, Label, extent
from stages.write.pdf import LETTER_WIDTH, LINE_MM, drawn, layers_of, lines, numbers, on_layer, text
from stages.write.pdfobjects import Box, Page, pdf_text
from stages.write.tiles import BORDER_MM, MOST_PAGES, Grid, Tile, crosses, grid_of, tiling

MARGIN_MM = 15.0
CHECK_MM = 100.0
CHECK_LAYER, REGISTER_LAYER = "CHECK_100_MM", "REGISTER"
CHECK_BELOW_MM = 7.0
"""How far the check line lies below what a page shows; its ticks and its text reach half of that towards it."""

TICK_MM, ARM_MM = 1.5, 3.0
ARMS = ARM_MM * np.array([[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
"""The two lines of a cross, about its place."""

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
    tiled = None if machine.paper == "fit" else tiling(box, paths, machine.paper)
    if tiled is None:
        pages = [_whole(box, title, len(layers))]
    else:
        pages = [_page(tile, tiled.grid, title, len(layers)) for tile in tiled.tiles]
        named.append(REGISTER_LAYER)
    around = low_x - MARGIN_MM, low_y - MARGIN_MM, high_x + MARGIN_MM, high_y + MARGIN_MM
    return pdf_text(title, named, around, drawn(drawing, machine), pages)


def too_many_pages(drawing: Drawing, machine: Machine) -> Iterator[Finding]:
    """Say that a drawing would take more pages than anyone lays together, and what to do."""
    if machine.paper == "fit":
        return
    paths = [item.path for item in drawing.items]
    box = extent(paths)
    grid = grid_of(box, machine.paper)
    if grid.rows * grid.columns <= MOST_PAGES or tiling(box, paths, machine.paper) is not None:
        return
    name = drawing.path.rpartition(".")[0]
    width, height = ((box[axis + 2] - box[axis]) / MM_PER_M for axis in (0, 1))
    message = (
        f"{name}.pdf spans {grid.rows} rows and {grid.columns} columns of {machine.paper}; at most {MOST_PAGES} pages "
        f"are laid together: it is one page at 1:1 of {width:.4g} x {height:.4g} m and a margin; print it from a roll, "
        "or divide the part"
    )
    where: dict[str, float | int | str] = {"file": f"{name}.pdf", "rows": grid.rows, "columns": grid.columns}
    yield Finding("pdf-pages", message, where=where)


MM_PER_M = 1000.0


def _whole(box: Box, title: str, check: int) -> Page:
    """Return the page that shows a drawing as a whole; wide enough for the check line.  check: its layer."""
    low_x, low_y, high_x, high_y = box
    width = max(high_x - low_x, CHECK_MM) + 2.0 * MARGIN_MM
    shown = f"q 1 0 0 1 {numbers((MARGIN_MM - low_x, MARGIN_MM - low_y))} cm /D Do Q\n"
    content = shown + check_line(MARGIN_MM, title[:TITLE_LETTERS], check)
    return Page(width, high_y - low_y + 2.0 * MARGIN_MM, content)


def _page(tile: Tile, grid: Grid, title: str, check: int) -> Page:
    """Return one of the pages that are laid together.  check: the layer of the check line; crosses are on the next."""
    width, height = grid.window_mm
    frame = f"{numbers((BORDER_MM, BORDER_MM, width, height))} re"
    moved = f"1 0 0 1 {numbers((BORDER_MM - tile.x, BORDER_MM - tile.y))} cm"
    middles = np.array([*crosses(tile, grid)]).reshape(-1, 1, 2)
    register = on_layer(check + 1, f"0 G {LINE_MM:g} w\n{lines(np.tile(middles, 2) + ARMS)}")
    edge = on_layer(check + 1, f"0.6 G {LINE_MM:g} w {DASHES} {frame} S\n")
    content = f"q {frame} W n {moved} /D Do\n{register}Q\nq {edge}Q\n"
    place = f"row {tile.row} of {grid.rows}, column {tile.column} of {grid.columns}"
    return Page(*grid.paper_mm, content + check_line(BORDER_MM, f"{title[:TITLE_LETTERS]}  {place}", check))


def check_line(margin_mm: float, title: str, layer: int) -> str:
    """Return the line of 100 mm with its ends marked, and what it is for, below what a page shows."""
    x, y = margin_mm, margin_mm - CHECK_BELOW_MM
    ticks = ((end, y - TICK_MM, end, y + TICK_MM) for end in (x, x + CHECK_MM))
    check = lines(np.array([(x, y, x + CHECK_MM, y), *ticks]))
    words = f"100 mm at 1:1   {title}"
    middle = np.array([x + TEXT_MM * LETTER_WIDTH * len(words) / 2.0, y + TEXT_ABOVE_MM])
    said = text(Label("LABEL", words, middle, TEXT_MM, 0.0))
    return on_layer(layer, f"0 G 0 g {LINE_MM:g} w\n{check}{said}")
