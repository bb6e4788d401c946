"""A pattern file as read back against the pieces that were written: the same blocks, and in them the same in order."""

from collections.abc import Iterator, Sequence

import numpy as np

from stages.geometry.arrays import Array
from stages.geometry.paths.arcpath import area, length
from stages.model.cutfile import Machine
from stages.model.patternlayers import CURVE, TURN, VALIDATION
from stages.model.report import Finding
from stages.write.compare import ROUND_TRIP, ROUND_TRIP_MM
from stages.write.drawing import Label
from stages.write.pieces import Line, PatternFile, Piece
from stages.write.readpieces import Content, ReadLine, ReadPieces, ReadPoint, ReadText


def unlike(back: ReadPieces, file: PatternFile, machine: Machine) -> Iterator[Finding]:
    """Yield where a file does not hold what was to be written."""
    written = [_written(piece, machine) for piece in file.pieces]
    stock = tuple(ReadLine(machine.layers[line.layer].name, line.path) for line in file.stock)
    style = tuple(_text(label, machine) for label in file.style)
    told: list[str] = []
    if [block.name for block in back.blocks] != [block.name for block in written]:
        told.append("holds other pieces than were written")
    else:
        for found, wanted in zip(back.blocks, written, strict=True):
            told += [f"{wanted.name}: {text}" for text in _differences(found, wanted)]
    told += _differences(back.space, Content("", stock, (), style, ()))
    for text in told:
        yield Finding("readback-content", f"{file.path}: {text}", fatal=True, where={"file": file.path})


def _written(piece: Piece, machine: Machine) -> Content:
    """Return what a reader must find of a piece."""
    lines: list[ReadLine] = []
    points: list[ReadPoint] = []
    for line in piece.lines:
        layer = machine.layers[line.layer].name
        lines.append(ReadLine(layer, line.path))
        if line.traced is not None:
            lines.append(ReadLine(VALIDATION[layer], line.traced.finer))
            points += _flags(line)
    points += [
        ReadPoint(spot.layer, float(spot.at[0]), float(spot.at[1]), spot.depth_mm, spot.width_mm, spot.angle_deg)
        for spot in piece.spots
    ]
    texts = tuple(_text(label, machine) for label in piece.texts)
    return Content(piece.name, tuple(lines), tuple(points), texts, ())


def _flags(line: Line) -> Iterator[ReadPoint]:
    for (x, y), turn in zip(line.path.vertices.tolist(), line.traced.turns if line.traced else (), strict=True):
        yield ReadPoint(TURN if turn else CURVE, x, y, 0.0, 0.0, 0.0)


def _text(label: Label, machine: Machine) -> ReadText:
    layer, x, y = machine.layers[label.layer].name, float(label.at[0]), float(label.at[1])
    return ReadText(layer, label.text, x, y, label.height_mm, label.angle_deg)


def _differences(found: Content, wanted: Content) -> Iterator[str]:
    """Yield what two contents do not have in common: lines, points and texts one by one, in order."""
    for kind, some, others in (("lines", found.lines, wanted.lines), ("points", found.points, wanted.points)):
        if [one.layer for one in some] != [one.layer for one in others]:
            yield f"has other {kind} than were written"
            return
    if [(one.layer, one.text) for one in found.texts] != [(one.layer, one.text) for one in wanted.texts]:
        yield "has other texts than were written"
        return
    for line, other in zip(found.lines, wanted.lines, strict=True):
        yield from _unlike_paths(line, other)
    for kind, numbers, right in (
        ("point", _numbers(found.points), _numbers(wanted.points)),
        ("text", _numbers(found.texts), _numbers(wanted.texts)),
    ):
        off = np.abs(numbers - right)
        if off.size and off.max() > ROUND_TRIP_MM:
            yield f"a {kind} is {off.max():.3g} from where, or from what, it was written"


def _numbers(some: Sequence[ReadPoint] | Sequence[ReadText]) -> Array:
    """Return the numbers of points or texts, a row for each."""
    rows = [
        (one.x, one.y, one.depth_mm, one.width_mm, one.angle_deg)
        if isinstance(one, ReadPoint)
        else (one.x, one.y, one.height_mm, one.angle_deg, 0.0)
        for one in some
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 5)


def _unlike_paths(found: ReadLine, wanted: ReadLine) -> Iterator[str]:
    """Yield a line whose vertices, length or area did not survive."""
    path, drawn = found.path, wanted.path
    if path is None or drawn is None or path.closed != drawn.closed or path.bulges.size != drawn.bulges.size:
        yield f"a line on {found.layer} is not the one that was written"
        return
    if np.abs(path.vertices - drawn.vertices).max() > ROUND_TRIP_MM:
        yield f"a line on {found.layer} lies elsewhere"
    if abs(length(path) - length(drawn)) > ROUND_TRIP * length(drawn) + ROUND_TRIP_MM:
        yield f"a line on {found.layer} is {length(path):.9g} mm long, written were {length(drawn):.9g} mm"
    if drawn.closed and abs(area(path) - area(drawn)) > ROUND_TRIP * abs(area(drawn)) + ROUND_TRIP_MM * length(drawn):
        yield f"a line on {found.layer} encloses {area(path):.9g} mm2, written were {area(drawn):.9g} mm2"
