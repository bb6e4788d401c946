"""How a machine wants its files, and a file as text, before anyone decides where it lies."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from stages.model.helps import Helps

Flavour = Literal["polyline-arcs", "lines-arcs", "polylines", "r12", "aama"]
Version = Literal["R12", "R2000", "R2010", "R2018"]
Profile = Literal["planish", "inventor"]
Lettering = Literal["TEXT", "strokes"]
FilePer = Literal["sheet", "part", "material"]
Side = Literal["either", "outside"]
Picture = Literal["svg", "pdf"]
Paper = Literal["fit", "A4", "A3"]


@dataclass(frozen=True, slots=True)
class Layer:
    """A layer as a file calls it, and its AutoCAD colour index."""

    name: str
    colour: int


def _layers(colours: Mapping[str, int], names: Mapping[str, str]) -> dict[str, Layer]:
    """Return the layers by what they mean; those without another name go by their meaning."""
    return {meaning: Layer(names.get(meaning, meaning), colour) for meaning, colour in colours.items()}


LAYER_COLOURS: dict[str, int] = {
    "CUT_OUTER": 1,
    "CUT_INNER": 5,
    "MARK": 3,
    "BEND_UP": 6,
    "BEND_DOWN": 4,
    "LABEL": 2,
    "SHEET": 8,
    "SHEET_KEEPOUT": 9,
    "ROLL": 30,
    "ENGRAVE": 40,
    "SEW": 200,
    "CUT_SLIT": 20,
    "LEAD": 140,
}
"""Layer names and AutoCAD colour indices of the default profile for metal.

ENGRAVE: text as strokes.  SEW: where a part is sewn, inside its seam allowance.  CUT_SLIT: cuts that enclose nothing.
LEAD: ways of the cutter onto contours and off them.
"""

OFFSET = "_OFFSET"
"""What the names of layers end in where contours lie half a kerf beside the nominal ones."""

INVENTOR_NAMES = {
    "CUT_OUTER": "IV_OUTER_PROFILE",
    "CUT_INNER": "IV_INTERIOR_PROFILES",
    "MARK": "IV_FEATURE_PROFILES",
    "BEND_UP": "IV_BEND",
    "BEND_DOWN": "IV_BEND_DOWN",
    "ROLL": "IV_ROLL",
}
"""What Autodesk Inventor calls them when it exports a flat pattern (its help, "Layer Mapping"); the rest it lacks."""

PROFILES: dict[Profile, dict[str, Layer]] = {
    "planish": _layers(LAYER_COLOURS, {}),
    "inventor": _layers(LAYER_COLOURS, INVENTOR_NAMES),
}

FILE_NAMES: dict[FilePer, str] = {"sheet": "{stock}-{index}", "part": "{part}", "material": "{job}"}
"""How the files in `cut/` are called where nobody says otherwise."""

FIELD = re.compile(r"\{(\w*)\}")


def filled(template: str, values: Mapping[str, object]) -> str:
    """Return a template of a file name with those of its fields filled that have a value."""
    return FIELD.sub(lambda found: str(values.get(found[1], found[0])), template)


def offset_layers(layers: Mapping[str, Layer]) -> dict[str, Layer]:
    """Return layers whose names say that contours are offset."""
    return {
        meaning: replace(layer, name=layer.name + OFFSET) if meaning in ("CUT_INNER", "CUT_OUTER") else layer
        for meaning, layer in layers.items()
    }


@dataclass(frozen=True, slots=True)
class Style:
    """What a pattern file says of all its pieces: whose style they are, in which size, of which material; ASCII."""

    name: str = "planish"
    size: str = "ONE"
    material: str = ""


@dataclass(frozen=True, slots=True)
class Machine:
    """What the reader of the file expects.

    layers: the name and colour of each layer, by what it means; no two have both the same.
    text: as an entity on LABEL, or as strokes of a single-line font on ENGRAVE.
    side: on which side of the exact outline of a part the written one may lie; outside: what it encloses only grows.
    file_per, file_name: what goes into one file in `cut/`, and what that is called; `filled` fills its fields.
    also: what each drawing is written as beside DXF; paper: of a PDF, one page as large as the drawing, or several.
    helps: what helps the process, in the files in `cut/`.
    """

    flavour: Flavour = "polyline-arcs"
    version: Version = "R2000"
    layers: dict[str, Layer] = field(default_factory=lambda: dict(PROFILES["planish"]))
    max_bulge: float = 0.41421356237309503
    """Arcs are split so that no bulge is larger: tan(90 deg / 4), a quarter circle; readers fail above 1."""
    common_kerf_mm: float | None = None
    """Where two parts are this far apart along straight edges, one line is cut for both; None: every outline closes."""
    text: Lettering = "TEXT"
    side: Side = "either"
    file_per: FilePer = "sheet"
    file_name: str = FILE_NAMES["sheet"]
    style: Style = Style()
    also: tuple[Picture, ...] = ()
    paper: Paper = "fit"
    helps: Helps = field(default_factory=Helps)

    def of_file(self, path: str) -> "Machine":
        """Return what the file at a path is like: in `cut/` contours may be offset, and their layers say so.

        Where parts share cuts, offset contours lie on each other, and on the common line.
        """
        if not (self.helps.compensated and path.startswith("cut/")):
            return self
        kerf = None if self.common_kerf_mm is None else 0.0
        return replace(self, layers=offset_layers(self.layers), common_kerf_mm=kerf)

    def path(self, stock: str, index: int) -> str:
        """Return the path of the file of a sheet, by what drawings call its stock and its number."""
        return f"cut/{filled(self.file_name, {'stock': stock, 'index': index})}.dxf"

    def part_path(self, part: str) -> str:
        """Return the path of the file of a part where each has one of its own."""
        return f"cut/{filled(self.file_name, {'part': part})}.dxf"


@dataclass(frozen=True, slots=True)
class CutFile:
    """One drawing: its place below the output folder (such as `cut/plate-1.dxf`) and its text."""

    path: str
    text: str
