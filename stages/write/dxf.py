"""A drawing as DXF text, flavour `polyline-arcs`: the only place that writes the format.

R2000 (AC1015), millimetres in every header variable that bears on units.  Each path is one entity: a full circle a
CIRCLE, a single open line a LINE, all else an LWPOLYLINE with bulges.  Colour is written on each entity as well as on
its layer, since readers differ on which they look at.  No blocks, no splines.

The text is a function of the drawing: clocks, GUIDs, user and program names are set to constants.  Coordinates are
rounded to `DECIMALS` places of a mm.  Numbers that are not finite raise ValueError; ezdxf would write `nan`.
"""

from io import StringIO

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace
from ezdxf.lldxf.tagwriter import TagWriter

from stages.geometry.arcpath import ArcPath, centres, piece_count, radii, sweeps
from stages.geometry.arrays import Values
from stages.model.cutfile import Machine
from stages.write.drawing import Drawing, Item, Label, extent

DECIMALS = 10
"""Of coordinates in mm: a reader gets them back to 5e-11 mm, and rounding noise such as 6e-17 becomes 0."""

BULGE_DECIMALS = 14
"""Of bulges: on a chord of 2 m the last place moves the arc by 1e-11 mm."""

FULL_CIRCLE = 1e-9
"""A closed path that turns by 2 pi about one centre to this share of its radius is a circle."""

MILLIMETRES, METRIC, DECIMAL_UNITS = 4, 1, 2
UNIT_VARIABLES: dict[str, float] = {
    "$INSUNITS": MILLIMETRES,
    "$MEASUREMENT": METRIC,
    "$LUNITS": DECIMAL_UNITS,
    "$DIMLUNIT": DECIMAL_UNITS,
    "$AUNITS": 0,
    "$LUPREC": 8,
    "$DIMSCALE": 1.0,
    "$DIMLFAC": 1.0,
    "$LTSCALE": 1.0,
    "$CELTSCALE": 1.0,
    "$PSLTSCALE": 1,
    "$UNITMODE": 0,
}
"""Readers disagree on which of these counts, so all of them say millimetres, 1 : 1."""

JULIAN_2000 = 2451545.0
NO_GUID = "{00000000-0000-0000-0000-000000000000}"
CONSTANTS: dict[str, float | str] = {
    "$TDCREATE": JULIAN_2000,
    "$TDUCREATE": JULIAN_2000,
    "$TDUPDATE": JULIAN_2000,
    "$TDUUPDATE": JULIAN_2000,
    "$TDINDWG": 0.0,
    "$TDUSRTIMER": 0.0,
    "$FINGERPRINTGUID": NO_GUID,
    "$VERSIONGUID": NO_GUID,
}
"""What would otherwise differ from run to run: the first noon of 2000, and no identity."""


def dxf_text(drawing: Drawing, machine: Machine) -> str:
    """Return the drawing as the text of a DXF file; the same drawing gives the same text."""
    document = new(machine.version, units=MILLIMETRES)
    for name, colour in machine.layers.items():
        document.layers.add(name, color=colour)
    space = document.modelspace()
    for item in drawing.items:
        _add_path(space, item, machine.layers[item.layer])
    for label in drawing.labels:
        _add_label(space, label, machine.layers[label.layer])
    _set_extents(document, extent(item.path for item in drawing.items))
    return _exported(document)


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


def _add_path(space: Modelspace, item: Item, colour: int) -> None:
    """Add one entity: CIRCLE, LINE or LWPOLYLINE."""
    attributes = {"layer": item.layer, "color": colour}
    path = item.path
    round_one = circle(path)
    if round_one is not None:
        centre_x, centre_y, radius = _rounded(np.array(round_one), DECIMALS)
        space.add_circle((centre_x, centre_y), radius, dxfattribs=attributes)
    elif piece_count(path) == 1 and path.bulges[0] == 0.0:
        start, end = _rounded(path.vertices.ravel(), DECIMALS)[:2], _rounded(path.vertices.ravel(), DECIMALS)[2:]
        space.add_line(start, end, dxfattribs=attributes)
    else:
        x, y = _rounded(path.vertices[:, 0], DECIMALS), _rounded(path.vertices[:, 1], DECIMALS)
        points = zip(x, y, _rounded(path.bulges, BULGE_DECIMALS), strict=True)
        space.add_lwpolyline(points, format="xyb", close=path.closed, dxfattribs=attributes)


def _add_label(space: Modelspace, label: Label, colour: int) -> None:
    """Add one centred text."""
    x, y, height, angle = _rounded(np.array([*label.at, label.height_mm, label.angle_deg]), DECIMALS)
    attributes = {"layer": label.layer, "color": colour, "rotation": angle}
    text = space.add_text(label.text, height=height, dxfattribs=attributes)
    text.set_placement((x, y), align=TextEntityAlignment.MIDDLE_CENTER)


def _rounded(values: Values, decimals: int) -> list[float]:
    """Return the values as they will be written; ValueError where one is not finite: the last gate before a file."""
    if not np.isfinite(values).all():
        raise ValueError(f"a number in a cut file must be finite: {values}")
    # adding 0 turns -0.0 into 0.0
    return [float(value) for value in np.round(values, decimals) + 0.0]


def _set_extents(document: Document, box: tuple[float, float, float, float]) -> None:
    """Write the bounding box and the units, in the header and in the layout it is copied from."""
    low_x, low_y, high_x, high_y = _rounded(np.array(box), DECIMALS)
    layout = document.modelspace()
    layout.reset_extents((low_x, low_y, 0.0), (high_x, high_y, 0.0))
    layout.reset_limits((low_x, low_y), (high_x, high_y))
    for name, value in UNIT_VARIABLES.items():
        document.header[name] = value
    document.header["$EXTMIN"], document.header["$EXTMAX"] = (low_x, low_y, 0.0), (high_x, high_y, 0.0)
    document.header["$LIMMIN"], document.header["$LIMMAX"] = (low_x, low_y), (high_x, high_y)


def _exported(document: Document) -> str:
    """Return the text, with what ezdxf sets on writing set back to constants.

    The steps are those of ezdxf's `write`, which would read the clock after anything could be done about it.
    """
    document.update_all()
    for name, value in CONSTANTS.items():
        document.header[name] = value
    marks = document.ezdxf_metadata()
    for name in ("CREATED_BY_EZDXF", "WRITTEN_BY_EZDXF"):
        marks.discard(name)
    document.header["$LASTSAVEDBY"] = "planish"
    stream = StringIO()
    document.export_sections(TagWriter(stream, write_handles=True, dxfversion=document.dxfversion))
    return stream.getvalue()
