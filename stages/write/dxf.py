"""A drawing as DXF text: the only place that writes the format; `records` has its entities, in all flavours.

Millimetres in every header variable that bears on units, in every version: R12 has not all of them, and the two that
readers look for are put into it.  Colour is written on each entity as well as on its layer.  No blocks, no splines.

The text is a function of the drawing: clocks, GUIDs, user and program names are set to constants.  Coordinates are
rounded to `DECIMALS` places of a mm.  Numbers that are not finite raise ValueError, whoever put them into the document:
all tags of the text are looked through, since ezdxf would write `nan`.
"""

import re
from io import StringIO
from itertools import count
from math import isfinite

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.lldxf.tagwriter import TagWriter
from ezdxf.sections.classes import REQ_R2004, REQUIRED_CLASSES
from ezdxf.tools.handle import HandleGenerator

from stages.model.cutfile import Machine
from stages.write.drawing import Drawing, extent
from stages.write.entities import DECIMALS, rounded
from stages.write.records import Form, records

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
    "$PSVPSCALE": 1.0,
    "$UNITMODE": 0,
}
"""Readers disagree on which of these counts, so all of them say millimetres, 1 : 1.  LibreCAD prints at $PSVPSCALE."""

UNKNOWN_TO_R12 = frozenset({"$INSUNITS", "$MEASUREMENT", "$DIMLUNIT", "$CELTSCALE", "$PSVPSCALE"})
PUT_INTO_R12 = ("$INSUNITS", "$MEASUREMENT")
"""R12 does not know them, yet readers of today look for them in it; old ones pass over what they do not know."""

RECORD = r"(?:(?!  0\n).*\n)*"
"""The tags of a record after its first."""

LAYOUT_BLOCK = re.compile(
    rf"  0\nBLOCK\n{RECORD}?  2\n\$(?:Model|Paper)_Space\n{RECORD}  0\nENDBLK\n{RECORD}", re.IGNORECASE
)
"""The empty block of a layout, which R12 does not need, and for which a reader of today gives up."""

BEFORE = "  9\n$LUNITS\n"
ENTITIES = "  0\nSECTION\n  2\nENTITIES\n"
HEXADECIMAL = 16

LETTERED_NUMBER = re.compile(
    r"^ *(?:[1-5][0-9]|1[1-4][0-9]|2[1-3][0-9]|46[0-9]|10[1-5][0-9])\n([^\n]*[A-Za-z][^\n]*)$", re.MULTILINE
)
"""A tag that holds a floating-point number, with a letter in its value: that of `nan` or `inf`, or an exponent.

Their group codes are 10 to 59, 110 to 149, 210 to 239, 460 to 469 and 1010 to 1059 (AutoCAD's DXF reference, "Group
codes").  No code has a letter, so this cannot begin at a value.
"""

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
    document = Document.new(machine.version)
    if machine.version != "R12":
        document.units = MILLIMETRES
    for layer in machine.layers.values():
        if layer.name not in document.layers:
            document.layers.add(layer.name, color=layer.colour)
    handles = count(int(str(document.entitydb.handles), HEXADECIMAL))
    entities = records(drawing, Form(machine, document.modelspace().layout_key, handles))
    document.entitydb.handles = HandleGenerator(f"{next(handles):X}")
    set_extents(document, extent(item.path for item in drawing.items))
    text = exported(document)
    before, place, after = (in_r12(text) if machine.version == "R12" else text).partition(ENTITIES)
    return finite("".join([before, place, entities, after]))


def unit_variables(version: str) -> dict[str, float]:
    """Return the header variables that bear on units in files of a version, and what they must be."""
    missing = UNKNOWN_TO_R12 - {*PUT_INTO_R12} if version == "R12" else ()
    return {name: float(value) for name, value in UNIT_VARIABLES.items() if name not in missing}


def in_r12(text: str) -> str:
    """Return the text of an R12 file with the variables for units that R12 itself lacks, and no blocks of layouts."""
    text = LAYOUT_BLOCK.sub("", text)
    added = "".join(f"  9\n{name}\n 70\n{UNIT_VARIABLES[name]}\n" for name in PUT_INTO_R12)
    before, place, after = text.partition(BEFORE)
    return f"{before}{added}{place}{after}"


def set_extents(document: Document, box: tuple[float, float, float, float]) -> None:
    """Write the bounding box and the units, in the header and in the layout it is copied from."""
    low_x, low_y, high_x, high_y = rounded(np.array(box), DECIMALS)
    layout = document.modelspace()
    layout.reset_extents((low_x, low_y, 0.0), (high_x, high_y, 0.0))
    layout.reset_limits((low_x, low_y), (high_x, high_y))
    for name, value in UNIT_VARIABLES.items():
        document.header[name] = value
    document.header["$EXTMIN"], document.header["$EXTMAX"] = (low_x, low_y, 0.0), (high_x, high_y, 0.0)
    document.header["$LIMMIN"], document.header["$LIMMAX"] = (low_x, low_y), (high_x, high_y)


def exported(document: Document, *, handles: bool = True) -> str:
    """Return the text, with what ezdxf sets on writing set back to constants.

    handles: whether entities are numbered, as they must be after R12.

    The steps are those of ezdxf's `write`, which would read the clock after anything could be done about it.
    """
    document.update_all()
    _order_classes(document)
    for name, value in CONSTANTS.items():
        document.header[name] = value
    marks = document.ezdxf_metadata()
    for name in ("CREATED_BY_EZDXF", "WRITTEN_BY_EZDXF"):
        marks.discard(name)
    document.header["$LASTSAVEDBY"] = "planish"
    stream = StringIO()
    document.export_sections(TagWriter(stream, write_handles=handles, dxfversion=document.dxfversion))
    return finite(stream.getvalue())


def _order_classes(document: Document) -> None:
    """Put the classes that are there for what the document holds into alphabetical order: ezdxf has them from a set."""
    classes, always = document.classes.classes, REQUIRED_CLASSES.get(document.dxfversion, REQ_R2004)
    for key in sorted(key for key in classes if key[0] not in always):
        classes[key] = classes.pop(key)


def finite(text: str) -> str:
    """Return a DXF text as it is; ValueError where a tag that holds a number holds none, or one that is not finite."""
    for tag in LETTERED_NUMBER.finditer(text):
        if not isfinite(float(tag[1])):
            line = text.count("\n", 0, tag.start(1)) + 1
            raise ValueError(f"line {line} of a cut file must be a finite number: {tag[1].strip()}")
    return text
