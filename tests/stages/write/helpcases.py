"""Helps for the process that the tests ask for, and the files that the usual nest has with them."""

from dataclasses import replace
from functools import cache

from stages.model.cutfile import CutFile, Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.model.pattern import FlatPattern
from stages.model.report import Outcome
from stages.model.sheet import Nesting
from stages.write import write
from stages.write.chains import Entity
from stages.write.readback import read
from tests.stages.write.patterns import nesting, plate, sector

BEAM_MM = 0.2
ROUNDING = 1e-8
"""Sums of ten coordinates of a file, rounded to 1e-10 mm, doubled by the chords."""

NONE = Helps(beam_mm=BEAM_MM)
OFFSET = replace(NONE, compensated=True)
LEADS = replace(NONE, lead_in=Lead("line", 3.0, 45.0), lead_out=Lead("arc", 2.0, 90.0))
TABS = replace(NONE, tabs=Tabs(0.4, count=4, holes=True))
ALL = replace(OFFSET, start="corner", lead_in=Lead("arc", 2.0, 90.0), tabs=Tabs(0.4, spacing_mm=80.0))
EVERY = {"offset": OFFSET, "mitred": replace(OFFSET, mitred=True), "leads": LEADS, "tabs": TABS, "all": ALL}
FLAVOURS = [("lines-arcs", "R2010"), ("polylines", "R2018"), ("r12", "R12")]


def machine(helps: Helps, flavour: str = "polyline-arcs", version: str = "R2000") -> Machine:
    return Machine(flavour=flavour, version=version, helps=helps)  # type: ignore[arg-type]


@cache
def usual(helps: Helps, flavour: str = "polyline-arcs", version: str = "R2000") -> Outcome[tuple[CutFile, ...]]:
    """Return the files of the usual nest, made once for all tests."""
    return made(machine(helps, flavour, version))


def made(
    how: Machine, parts: tuple[FlatPattern, ...] = (plate(), sector()), nest: Nesting | None = None
) -> Outcome[tuple[CutFile, ...]]:
    return write(parts, nest or nesting(), how)


def first_sheet(how: Machine) -> list[Entity]:
    texts = {file.path: file.text for file in usual(how.helps).product}
    return list(read(texts["cut/stock-1.dxf"], how.of_file("cut/").layers).entities)


def codes(outcome: Outcome[tuple[CutFile, ...]]) -> set[str]:
    return {finding.code for finding in outcome.report.findings}
