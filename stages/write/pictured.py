"""The drawings in the other formats that the machine wants, beside the DXF files and of the same names, read again."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stages.model.cutfile import CutFile, Machine, Picture
from stages.model.report import Finding
from stages.write.drawing import Drawing
from stages.write.pdfpages import drawing_pdf, too_many_pages
from stages.write.pictureback import picture_faults
from stages.write.svg import svg_text

WRITERS: dict[Picture, Callable[[Drawing, Machine], str]] = {"svg": svg_text, "pdf": drawing_pdf}


@dataclass(frozen=True, slots=True)
class Pictures:
    """Drawings in other formats, what reading them again found, and on what paper they are not."""

    files: tuple[CutFile, ...]
    findings: tuple[Finding, ...]


def pictured(drawings: Sequence[Drawing], machine: Machine) -> Pictures:
    """Return each drawing in each of those formats."""
    made = [(drawing, picture(drawing, machine, how)) for drawing in drawings for how in machine.also]
    found = [fault for drawing, file in made for fault in picture_faults(file, drawing, machine.of_file(drawing.path))]
    told = [finding for drawing in drawings if "pdf" in machine.also for finding in too_many_pages(drawing, machine)]
    return Pictures(tuple(file for _, file in made), (*found, *told))


def picture(drawing: Drawing, machine: Machine, how: Picture) -> CutFile:
    """Return a drawing in a format."""
    return CutFile(f"{drawing.path.rpartition('.')[0]}.{how}", WRITERS[how](drawing, machine.of_file(drawing.path)))
