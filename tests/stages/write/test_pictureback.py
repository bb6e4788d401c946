"""Pictures read again: no alarm on good ones, every planted fault found, and a job that does not pass with one."""

import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from stages.model.cutfile import PROFILES, CutFile, Machine, Picture
from stages.write import write
from stages.write.drawing import Drawing, Item, flat_drawing, sheet_drawing
from stages.write.flavours import as_cut
from stages.write.pictureback import picture_faults
from stages.write.pictured import WRITERS, picture, pictured
from stages.write.svg import svg_text
from tests.stages.write.patterns import drop, nesting, plate, sector, strip

BOTH: tuple[Picture, ...] = ("svg", "pdf")
MACHINES = [
    Machine(also=BOTH),
    Machine(also=BOTH, flavour="lines-arcs", layers=dict(PROFILES["inventor"]), text="strokes"),
    Machine(also=BOTH, flavour="polylines", paper="A4"),
]


def drawings(machine: Machine) -> list[Drawing]:
    parts = [as_cut(one, machine) for one in (plate(), strip(), drop(), sector())]
    by_name = {one.part: one for one in parts}
    return [flat_drawing(one, machine) for one in parts] + [
        sheet_drawing(layout, by_name, machine) for layout in nesting().layouts
    ]


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.flavour)
def test_good_pictures_raise_no_alarm(machine: Machine) -> None:
    for drawing in drawings(machine):
        assert pictured([drawing], machine).findings == ()


def scaled(item: Item) -> Item:
    return replace(item, path=item.path.replace(vertices=100.0 * item.path.vertices))


def test_a_drawing_of_too_many_pages_is_one_page_and_told_of() -> None:
    (drawing, *_) = drawings(MACHINES[2])
    large = replace(drawing, items=tuple(scaled(item) for item in drawing.items))
    assert [finding.code for finding in pictured([large], MACHINES[2]).findings] == ["pdf-pages"]
    assert pictured([large], replace(MACHINES[2], also=("svg",))).findings == ()


def first(pattern: str, other: str) -> Callable[[str], str]:
    return lambda text: re.sub(pattern, other, text, count=1)


FAULTS: dict[str, tuple[Picture, Callable[[str], str]]] = {
    "an arc the other way": ("svg", first(r" 0 0 0 ", " 0 0 1 ")),
    "another radius": ("svg", first(r"A100 100", "A100.0005 100.0005")),
    "a corner moved": ("svg", first(r"M0 60L100 60", "M0 60L100.00001 60")),
    "a path less": ("svg", first(r"<path[^>]*/>", "")),
    "a path open": ("svg", first(r'Z" />', '" />')),
    "another layer": ("svg", first(r'label="CUT_OUTER"', 'label="MARK"')),
    "no number": ("svg", first(r"M0 60L100 60", "M0 60L100 nan")),
    "all of it moved": ("svg", first(r'data-left="0"', 'data-left="0.001"')),
    "not XML": ("svg", first(r"</svg>", "")),
    "a point moved": ("pdf", first(r"100 0 l", "100.001 0 l")),
    "a handle moved": ("pdf", first(r"84 (1[0-9.]+) ", r"83.9 \1 ")),
    "a piece less": ("pdf", first(r" 0 60 l", "")),
    "a path not closed": ("pdf", first(r" s\n", " S\n")),
    "on another layer": ("pdf", first(r"/OC /L0 BDC", "/OC /L1 BDC")),
    "a path gone": ("pdf", first(r"[^\n]* s\n", "")),
    "a word in it": ("pdf", first(r"100 0 l", "1O0 0 l")),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str) -> None:
    kind, spoil = FAULTS[fault]
    machine = MACHINES[0]
    found = 0
    for drawing in drawings(machine)[:4]:
        file = picture(drawing, machine, kind)
        spoilt = CutFile(file.path, spoil(file.text))
        if spoilt == file:
            continue
        found += 1
        faults = picture_faults(spoilt, drawing, machine)
        assert {one.code for one in faults} == {"readback-picture"}, fault
        assert all(one.fatal and file.path in one.message for one in faults)
    assert found


def test_a_job_with_a_spoilt_picture_does_not_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    good = write([plate()], None, MACHINES[0])
    assert good.report.passed
    spoil = FAULTS["another layer"][1]
    monkeypatch.setitem(WRITERS, "svg", lambda drawing, machine: spoil(svg_text(drawing, machine)))
    spoilt = write([plate()], None, MACHINES[0]).report
    assert [finding.code for finding in spoilt.findings if finding.fatal] == ["readback-picture"]
    assert not spoilt.passed
