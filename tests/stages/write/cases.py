"""Every flavour in the versions that hold it, and files in them."""

from functools import cache
from io import StringIO
from math import pi

import ezdxf
import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.entities import DXFEntity

from stages.geometry.curves.plane import CircularArc
from stages.model.cutfile import CutFile, Flavour, Machine, Version
from stages.model.pattern import FlatPattern
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.flavours import as_cut
from tests.stages.write.patterns import (
    contour,
    drop,
    hole,
    line_mark,
    nesting,
    pattern,
    plate,
    polygon_edges,
    sector,
    strip,
)

Case = tuple[Flavour, Version]
CASES: list[Case] = [
    ("polyline-arcs", "R2000"),
    ("polyline-arcs", "R2010"),
    ("polyline-arcs", "R2018"),
    ("lines-arcs", "R12"),
    ("lines-arcs", "R2000"),
    ("lines-arcs", "R2018"),
    ("polylines", "R12"),
    ("polylines", "R2000"),
    ("r12", "R12"),
]


def machine(case: Case) -> Machine:
    return Machine(flavour=case[0], version=case[1])


@cache
def texts_of(case: Case) -> dict[str, str]:
    return texts(machine(case))


def texts(how: Machine) -> dict[str, str]:
    outcome = write([plate(), sector(), strip(), drop()], nesting(), how)
    assert outcome.report.passed, outcome.report.findings
    assert outcome.report.findings == ()
    return {file.path: file.text for file in outcome.product}


def document(text: str) -> Document:
    return ezdxf.read(StringIO(text))


def on(layer: str, text: str) -> list[DXFEntity]:
    return [entity for entity in document(text).modelspace() if entity.dxf.layer == layer]


def told(text: str, how: Machine) -> set[str]:
    part = rounded_as(how.flavour)
    report = judged([CutFile("flat/plate.dxf", text)], [flat_drawing(part, how)], {part.part: part}, how)
    return {finding.code for finding in report.findings if finding.fatal}


def rounded() -> FlatPattern:
    """Return a plate with one round corner, a round hole and a slot."""
    corner = CircularArc(np.array([80.0, 40.0]), 20.0, 0.0, pi / 2.0)
    straight = polygon_edges((80.0, 60.0), (0.0, 60.0), (0.0, 0.0), (100.0, 0.0), (100.0, 40.0))[:4]
    slot = polygon_edges((10.0, 30.0), (10.0, 50.0), (20.0, 50.0), (20.0, 30.0))
    marks = (line_mark((50.0, 5.0), (60.0, 5.0)),)
    return pattern(
        "plate", contour([corner, *straight]), (30.0, 20.0), hole(60.0, 30.0, 10.0), contour(slot), marks=marks
    )


@cache
def rounded_as(flavour: Flavour) -> FlatPattern:
    return as_cut(rounded(), Machine(flavour=flavour))


def good(how: Machine) -> str:
    return dxf_text(flat_drawing(rounded_as(how.flavour), how), how)
