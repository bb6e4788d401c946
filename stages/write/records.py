"""The entities of a drawing as records of a DXF file, in its flavours: polylines, lines and arcs, old polylines.

A full circle is a CIRCLE, a mark that is one line a LINE.  In `lines-arcs` every piece of a path is an entity of its
own, in the order of the path.  The first LINE or ARC of a path names its line type, the others leave it to their layer:
where a path begins at the point at which the one before ended, that tells them apart.

An ARC is written by its centre and angles, from which readers compute its ends: they miss the ends of its neighbours
by the rounding of ten decimals, and by that of doubles as large as its radius.

Records are put together as text: a sheet with leads and tabs has tens of entities for each part, for which the objects
of a library take most of the time of writing.  They are those that ezdxf would write, handle by handle.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Indices
from stages.geometry.paths.arcpath import ArcPath, centres, chords, piece_count, radii, sweeps
from stages.model.cutfile import Layer, Machine
from stages.write.drawing import Drawing, Item, Label
from stages.write.entities import BULGE_DECIMALS, DECIMALS, circle, rounded

FULL_TURN = 360.0
CONTINUOUS = "  6\nCONTINUOUS\n"


@dataclass(frozen=True, slots=True)
class Form:
    """How records are written: for which machine, who owns the entities, and their handles as they are handed out."""

    machine: Machine
    owner: str
    handles: Iterator[int]

    @property
    def old(self) -> bool:
        """Whether it is that of R12, which has neither owners nor classes."""
        return self.machine.version == "R12"

    def head(self, kind: str, layer: Layer, sort: str, *, begins: bool = False) -> str:
        """Return what every record begins with; sort: the class of what follows, begins: a path does so here.

        Colour stands beside the layer: readers differ on which of the two they look at.
        """
        own = f"  8\n{layer.name}\n{CONTINUOUS if begins else ''} 62\n{layer.colour}\n"
        first = f"  0\n{kind}\n  5\n{next(self.handles):X}\n"
        return f"{first}{own}" if self.old else f"{first}330\n{self.owner}\n100\nAcDbEntity\n{own}{self.sort(sort)}"

    def sort(self, name: str) -> str:
        """Return the tag that names the class of what follows."""
        return "" if self.old else f"100\n{name}\n"


def records(drawing: Drawing, form: Form) -> str:
    """Return the records of all paths of a drawing and of its labels, in their order."""
    layers = form.machine.layers
    return "".join(
        [
            *(record for item in drawing.items for record in _path(item, layers[item.layer], form)),
            *(_text(label, layers[label.layer], form) for label in drawing.labels),
        ]
    )


def _path(item: Item, layer: Layer, form: Form) -> Iterable[str]:
    """Return the records of a path; what is left of an outline that shares cuts is never a lone LINE."""
    path = item.path
    round_one = None if item.begun else circle(path)
    if round_one is not None:
        return (form.head("CIRCLE", layer, "AcDbCircle"), _circle(*rounded(np.array(round_one), DECIMALS)))
    if form.machine.flavour == "lines-arcs":
        return _pieces(path, layer, form)
    if piece_count(path) == 1 and path.bulges[0] == 0.0 and item.contour is None:
        ends = rounded(path.vertices.ravel(), DECIMALS)
        return (form.head("LINE", layer, "AcDbLine", begins=True), _line(*ends))
    return _old_polyline(path, layer, form) if form.old else _polyline(path, layer, form)


def _line(x0: float, y0: float, x1: float, y1: float) -> str:
    return f" 10\n{x0}\n 20\n{y0}\n 30\n0.0\n 11\n{x1}\n 21\n{y1}\n 31\n0.0\n"


def _circle(x: float, y: float, radius: float) -> str:
    return f" 10\n{x}\n 20\n{y}\n 30\n0.0\n 40\n{radius}\n"


def _corners(path: ArcPath) -> Iterator[tuple[float, float, str]]:
    """Yield x, y and the tag of the bulge of each vertex, which is left out where it is 0."""
    places, bulges = rounded(path.vertices.ravel(), DECIMALS), rounded(path.bulges, BULGE_DECIMALS)
    for x, y, bulge in zip(places[::2], places[1::2], bulges, strict=True):
        yield x, y, f" 42\n{bulge}\n" if bulge else ""


def _polyline(path: ArcPath, layer: Layer, form: Form) -> Iterator[str]:
    """Yield the record of an LWPOLYLINE."""
    head = form.head("LWPOLYLINE", layer, "AcDbPolyline")
    yield f"{head} 90\n{path.bulges.size}\n 70\n{int(path.closed)}\n"
    for x, y, bulge in _corners(path):
        yield f" 10\n{x}\n 20\n{y}\n{bulge}"


def _old_polyline(path: ArcPath, layer: Layer, form: Form) -> Iterator[str]:
    """Yield the records of a POLYLINE of R12, of its VERTEX entities, and of the SEQEND, whose handle is the second."""
    head = form.head("POLYLINE", layer, "")
    yield f"{head} 66\n1\n 10\n0.0\n 20\n0.0\n 30\n0.0\n 70\n{int(path.closed)}\n"
    last = next(form.handles)
    for x, y, bulge in _corners(path):
        handle = next(form.handles)
        yield f"  0\nVERTEX\n  5\n{handle:X}\n  8\n{layer.name}\n 10\n{x}\n 20\n{y}\n 30\n0.0\n{bulge} 70\n0\n"
    yield f"  0\nSEQEND\n  5\n{last:X}\n  8\n{layer.name}\n"


def _pieces(path: ArcPath, layer: Layer, form: Form) -> Iterator[str]:
    """Yield the record of a LINE or an ARC for every piece."""
    start, end = chords(path)
    straight = sweeps(path) == 0.0
    lines = rounded(np.concatenate([start, end], axis=1).ravel(), DECIMALS)
    arcs = iter(_arcs(path, np.flatnonzero(~straight)))
    for piece, is_line in enumerate(straight.tolist()):
        if is_line:
            yield form.head("LINE", layer, "AcDbLine", begins=piece == 0)
            yield _line(*lines[4 * piece : 4 * piece + 4])
        else:
            (*round_one, first, last) = next(arcs)
            head = form.head("ARC", layer, "AcDbCircle", begins=piece == 0)
            yield f"{head}{_circle(*round_one)}{form.sort('AcDbArc')} 50\n{first}\n 51\n{last}\n"


def _arcs(path: ArcPath, chosen: Indices) -> list[list[float]]:
    """Return centre x, y, radius and both angles in degrees of the pieces of those numbers, counter-clockwise."""
    if not chosen.size:
        return []
    start, end = (ends[chosen] for ends in chords(path))
    sweep, centre, radius = sweeps(path)[chosen], centres(path)[chosen], radii(path)[chosen]
    forward = (sweep > 0.0)[:, None]
    angles = [
        np.degrees(np.arctan2(away[:, 1], away[:, 0])) % FULL_TURN
        for away in (np.where(forward, start, end) - centre, np.where(forward, end, start) - centre)
    ]
    sizes = rounded(np.column_stack([centre, radius]).ravel(), DECIMALS)
    turns = rounded(np.column_stack(angles).ravel(), BULGE_DECIMALS)
    return [
        [*sizes[3 * k : 3 * k + 3], turns[2 * k] % FULL_TURN, turns[2 * k + 1] % FULL_TURN] for k in range(chosen.size)
    ]


def _text(label: Label, layer: Layer, form: Form) -> str:
    """Return the record of one centred text."""
    x, y, height, angle = rounded(np.array([*label.at, label.height_mm, label.angle_deg]), DECIMALS)
    said = f" 40\n{height}\n  1\n{label.text}\n" + (f" 50\n{angle}\n" if angle else "")
    placed = f" 10\n{x}\n 20\n{y}\n 30\n0.0\n{said} 72\n1\n 11\n{x}\n 21\n{y}\n 31\n0.0\n"
    return f"{form.head('TEXT', layer, 'AcDbText')}{placed}{form.sort('AcDbText')} 73\n2\n"
