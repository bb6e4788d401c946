"""A pattern as pages draw it: its contours are one form of the file, however often they are shown."""

from collections.abc import Mapping
from dataclasses import dataclass

from pipeline.readpatterns import read_pattern
from pipeline.readpieces import NoPatternError
from pipeline.report.traveller_entries import ReportEntry
from pipeline.store import safe_names
from stages.model.cutfile import PROFILES, Layer
from stages.model.pattern import FlatPattern
from stages.write.drawing import extent, room
from stages.write.pdf import outline
from stages.write.pdfbook import Form

BESIDE = 0.1
"""Around contours, for the width of their lines, which is never so large a share of what is shown."""


@dataclass(frozen=True, slots=True)
class Inked:
    """A pattern, the number of the form that draws its contours, and how much room its label has around it, mm."""

    pattern: FlatPattern
    form: int
    room_mm: float


def inked_patterns(report: ReportEntry, files: Mapping[str, bytes]) -> dict[str, Inked]:
    """Return the patterns of the parts that passed, by their names, as their drawings have them."""
    drawings = report.job.dxf
    layers = PROFILES["planish"] if drawings is None else {
        meaning: Layer(entry.name, entry.colour) for meaning, entry in drawings.layers.items()
    }  # fmt: skip
    chord_mm = 0.0 if report.job.tolerance is None else report.job.tolerance.chord_mm
    found: dict[str, Inked] = {}
    for name, safe in safe_names(part.name for part in report.parts).items():
        content = files.get(f"flat/{safe}.dxf")
        if content is not None:
            pattern = _read(content, chord_mm, layers, name)
            found[name] = Inked(pattern, len(found), room(pattern))
    return found


def _read(content: bytes, chord_mm: float, layers: Mapping[str, Layer], name: str) -> FlatPattern:
    try:
        return read_pattern(content.decode("ascii"), chord_mm, layers)
    except NoPatternError as error:
        error.add_note(f"the drawing of part {name!r}")
        raise


def contours_form(pattern: FlatPattern) -> Form:
    """Return the contours of a pattern, filled and drawn in the colours that are set."""
    paths = [contour.path for contour in (pattern.outer, *pattern.inner)]
    low_x, low_y, high_x, high_y = extent(paths)
    beside = BESIDE * max(high_x - low_x, high_y - low_y)
    box = low_x - beside, low_y - beside, high_x + beside, high_y + beside
    return Form(box, " ".join(f"{outline(path)} h" for path in paths) + " B*\n")
