"""LibreCAD prints a drawing at 1 : 2 as PDF, and the lines of that page are read: layers by their colours.

A page is A3 and has 19850 by 14033 steps; LibreCAD takes the mean of what both sides make of a millimetre.  Arcs come
as many short lines between such steps, full circles as four cubic curves.  To measure, lines are thinned to what
strays from the steps by no more than `STRAY_STEPS`.

The drawing is put into the middle of the page: LibreCAD 2.2 prints a full circle for an arc that touches the page's
edge.
"""

import os
import re
import shutil
import subprocess
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from shapely import LineString

from stages.geometry.arrays import Points2
from tests.readers.reading import Fineness, Piece, Reader, Reading

SCALE = 0.5
PAGE_STEPS = np.array([19850.0, 14033.0])
STEP_MM = 1.0 / float((PAGE_STEPS / [420.0, 297.0]).mean()) / SCALE
STRAY_STEPS = 1.5
CURVE_POINTS = 33
CIRCLE_STRAY = 2.8e-4
"""Cubic curves leave a circle by this share of its radius (4/3 (sqrt 2 - 1): 2.73e-4)."""

LAYERS: dict[tuple[float, ...], str] = {
    (1, 0, 0): "CUT_OUTER",
    (0, 0, 1): "CUT_INNER",
    (0, 1, 0): "MARK",
    (1, 0, 1): "BEND_UP",
    (0, 1, 1): "BEND_DOWN",
    (1, 1, 0): "LABEL",
}
"""By the colours of the entities, AutoCAD's 1 to 6; grey is SHEET."""


STYLE_TEXT = "Style Name: "
"""By this a pattern file is told."""


def available() -> bool:
    return shutil.which("librecad") is not None


def printed_width_mm(path: Path) -> float:
    """Return how wide the drawing is on the page where nobody says a scale."""
    _print([path], ())
    reach = np.concatenate([points for _, points in _lines(_page(path.with_suffix(".pdf")))])
    return float(np.ptp(reach[:, 0])) * STEP_MM * SCALE


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    """Return what one run of LibreCAD prints of all files; the letters of texts are not read."""
    _print(paths, ("-s", str(SCALE), "-c"))
    return {path.stem: Reading(tuple(_placed(path))) for path in paths}


def _print(paths: Sequence[Path], wishes: Sequence[str]) -> None:
    """Have LibreCAD print files to PDF beside them."""
    folder = paths[0].parent
    command = ["librecad", "dxf2pdf", *wishes, "-t", str(folder), *map(str, paths)]
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
    subprocess.run(command, capture_output=True, check=True, timeout=120, env=environment)


def _placed(path: Path) -> Iterator[Piece]:
    """Yield the lines of a page where they are in the drawing: the middle of its extent is that of the page.

    Below the pieces of a pattern file there are texts, which count too: of those only the size is taken from the page.
    """
    low, high = _corner(path, "$EXTMIN"), _corner(path, "$EXTMAX")
    pieces = list(_pieces(path.with_suffix(".pdf")))
    place = (low + high) / 2.0
    if STYLE_TEXT in path.read_text("ascii"):
        place = low - np.min([piece.points.min(axis=0) for piece in pieces], axis=0)
    for piece in pieces:
        yield Piece(piece.layer, piece.points + place)


def _corner(path: Path, variable: str) -> Points2:
    """Return the point that a header variable holds."""
    words = path.read_text("ascii").partition(variable)[2].split()
    return np.array([float(words[1]), float(words[3])])


def _pieces(path: Path) -> Iterator[Piece]:
    """Yield the lines of a page in mm, joined where one begins at the end of the one before."""
    layer = ""
    joined: list[Points2] = []
    for colour, points in _lines(_page(path)):
        name = LAYERS.get(colour, "SHEET")
        if joined and name == layer and (joined[-1][-1] == points[0]).all():
            joined.append(points[1:])
            continue
        yield from _piece(layer, joined)
        layer, joined = name, [points]
    yield from _piece(layer, joined)


def _piece(layer: str, joined: list[Points2]) -> Iterator[Piece]:
    if joined and layer != "LABEL":
        points = np.concatenate(joined)
        if len(points) > 1 and np.ptp(points, axis=0).max() > 0.0:
            yield Piece(layer, np.array(LineString(points).simplify(STRAY_STEPS).coords) * STEP_MM)


def _page(path: Path) -> str:
    """Return what the longest stream of a PDF says, which is its page."""
    streams = re.findall(rb"stream\r?\n(.*?)endstream", path.read_bytes(), re.DOTALL)
    texts = []
    for stream in streams:
        try:
            texts.append(zlib.decompress(stream))
        except zlib.error:
            continue
    return max(texts, key=len).decode("latin-1")


def _lines(page: str) -> Iterator[tuple[tuple[float, ...], Points2]]:
    """Yield colour and points of all that is stroked, y upwards."""
    colour: tuple[float, ...] = ()
    points: list[Points2] = []
    for line in page.splitlines():
        *words, operator = line.split() or [""]
        if operator == "SCN":
            colour = tuple(round(float(word), 1) for word in words)
        elif operator == "m":
            points = [_at(words)]
        elif operator == "l":
            points.append(_at(words))
        elif operator == "c":
            points.append(_cubic(points[-1][-1], _at(words)))
        elif operator == "S" and points:
            yield colour, np.concatenate(points)
            points = []


def _at(words: list[str]) -> Points2:
    return np.array(words, dtype=np.float64).reshape(-1, 2) * [1.0, -1.0] + PAGE_STEPS / [-2.0, 2.0]


def _cubic(start: Points2, others: Points2) -> Points2:
    t = np.linspace(0.0, 1.0, CURVE_POINTS)[1:, None]
    a, b, c = others
    points: Points2 = (1 - t) ** 3 * start + 3 * t * (1 - t) ** 2 * a + 3 * t**2 * (1 - t) * b + t**3 * c
    return points


STRAY_MM = STRAY_STEPS * STEP_MM + CIRCLE_STRAY * 20.0
FINENESS = Fineness(grid_mm=STEP_MM, stray_mm=STRAY_MM)
READER = Reader("LibreCAD", available, read, FINENESS, keeps_pieces=False, block_layers=False)
