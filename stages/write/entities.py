"""The entities of a drawing in the flavours of DXF: polylines with arcs or without, lines and arcs, old polylines.

A full circle is a CIRCLE, a mark that is one line a LINE.  In `lines-arcs` every piece of a path is an entity of its
own, in the order of the path.  The first LINE or ARC of a path names its line type, the others leave it to their layer:
where a path begins at the point at which the one before ended, that tells them apart.

An ARC is written by its centre and angles, from which readers compute its ends: they miss the ends of its neighbours
by the rounding of ten decimals, and by that of doubles as large as its radius.
"""

import numpy as np
from ezdxf.enums import TextEntityAlignment
from ezdxf.layouts.base import BaseLayout
from ezdxf.layouts.layout import Modelspace

from stages.geometry.arcpath import ArcPath, centres, chords, piece_count, radii, sweeps
from stages.geometry.arrays import Array
from stages.model.cutfile import Layer, Machine
from stages.write.drawing import Item, Label

DECIMALS = 10
"""Of coordinates in mm: a reader gets them back to 5e-11 mm, and rounding noise such as 6e-17 becomes 0."""

BULGE_DECIMALS = 14
"""Of bulges: on a chord of 2 m the last place moves the arc by 1e-11 mm; of angles in degrees: all of a double."""

FULL_CIRCLE = 1e-9
"""A closed path that turns by 2 pi about one centre to this share of its radius is a circle."""

FULL_TURN = 360.0
CONTINUOUS = "CONTINUOUS"

Attributes = dict[str, str | int]


def add_path(space: Modelspace, item: Item, machine: Machine) -> None:
    """Add the entities of a path; what is left of an outline that shares cuts is never a lone LINE."""
    attributes = _attributes(machine.layers[item.layer])
    path = item.path
    round_one = None if item.begun else circle(path)
    if round_one is not None:
        centre_x, centre_y, radius = rounded(np.array(round_one), DECIMALS)
        space.add_circle((centre_x, centre_y), radius, dxfattribs=attributes)
    elif machine.flavour == "lines-arcs":
        _add_pieces(space, path, attributes)
    elif piece_count(path) == 1 and path.bulges[0] == 0.0 and item.contour is None:
        _add_line(space, path.vertices.ravel(), {**attributes, "linetype": CONTINUOUS})
    else:
        _add_polyline(space, path, attributes, old=machine.version == "R12")


def add_label(space: BaseLayout, label: Label, layer: Layer) -> None:
    """Add one centred text."""
    x, y, height, angle = rounded(np.array([*label.at, label.height_mm, label.angle_deg]), DECIMALS)
    text = space.add_text(label.text, height=height, dxfattribs={**_attributes(layer), "rotation": angle})
    text.set_placement((x, y), align=TextEntityAlignment.MIDDLE_CENTER)


def circle(path: ArcPath) -> tuple[float, float, float] | None:
    """Return centre x, y and radius in mm if the path is one full circle, else None."""
    sweep, radius = sweeps(path), radii(path)
    if not path.closed or not (np.all(sweep > 0.0) or np.all(sweep < 0.0)):
        return None
    centre = centres(path)
    spread = max(float(np.ptp(centre, axis=0).max()), float(np.ptp(radius)), abs(abs(sweep.sum()) - 2.0 * np.pi))
    if spread > FULL_CIRCLE * max(float(radius.max()), 1.0):
        return None
    x, y = centre.mean(axis=0)
    return float(x), float(y), float(radius.mean())


def rounded(values: Array, decimals: int) -> list[float]:
    """Return the values as they will be written; ValueError where one is not finite: the last gate before a file."""
    if not np.isfinite(values).all():
        raise ValueError(f"a number in a cut file must be finite: {values}")
    # adding 0 turns -0.0 into 0.0
    return [float(value) for value in np.round(values, decimals) + 0.0]


def _attributes(layer: Layer) -> Attributes:
    """Return layer and colour: readers differ on which of the two they look at."""
    return {"layer": layer.name, "color": layer.colour}


def _add_line(space: Modelspace, ends: Array, attributes: Attributes) -> None:
    """Add a LINE; ends: x, y, x, y."""
    start_x, start_y, end_x, end_y = rounded(ends, DECIMALS)
    space.add_line((start_x, start_y), (end_x, end_y), dxfattribs=attributes)


def _add_polyline(space: Modelspace, path: ArcPath, attributes: Attributes, *, old: bool) -> None:
    """Add an LWPOLYLINE, or an `old` POLYLINE with its VERTEX entities."""
    x, y = rounded(path.vertices[:, 0], DECIMALS), rounded(path.vertices[:, 1], DECIMALS)
    points = list(zip(x, y, rounded(path.bulges, BULGE_DECIMALS), strict=True))
    if old:
        space.add_polyline2d(points, format="xyb", close=path.closed, dxfattribs=attributes)
    else:
        space.add_lwpolyline(points, format="xyb", close=path.closed, dxfattribs=attributes)


def _add_pieces(space: Modelspace, path: ArcPath, attributes: Attributes) -> None:
    """Add a LINE or an ARC for every piece."""
    start, end = chords(path)
    sweep, centre, radius = sweeps(path), centres(path), radii(path)
    for piece in range(piece_count(path)):
        own: Attributes = {**attributes, "linetype": CONTINUOUS} if piece == 0 else attributes
        if sweep[piece] == 0.0:
            _add_line(space, np.concatenate([start[piece], end[piece]]), own)
            continue
        ends = np.stack([start[piece], end[piece]])[:: 1 if sweep[piece] > 0.0 else -1] - centre[piece]
        x, y, long = rounded(np.array([*centre[piece], radius[piece]]), DECIMALS)
        first, last = rounded(np.degrees(np.arctan2(ends[:, 1], ends[:, 0])) % FULL_TURN, BULGE_DECIMALS)
        space.add_arc((x, y), long, first % FULL_TURN, last % FULL_TURN, dxfattribs=own)
