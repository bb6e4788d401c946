"""Features of parts that are divided into blanks: each on one of them, or refused where a cut goes through it."""

from dataclasses import replace
from fractions import Fraction

import pytest

from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import part as stretch_of
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll import outline, unroll
from stages.unroll.divide import blanks
from stages.unroll.features import on_strip
from stages.verify import verify
from tests.parts import construct, part, passage
from tests.stages.geometry.ruled.test_drill import HALF_TUBE
from tests.stages.unroll.test_divide import WAVY
from tests.stages.unroll.test_features import circle


def test_a_blank_takes_what_lies_on_it_and_refuses_what_a_cut_goes_through() -> None:

    def blank(surface: RuledSurface, low: Fraction, high: Fraction) -> tuple[list[str], list[str]]:
        piece = stretch_of(surface.patches[0], low, high)
        made = replace(surface, patches=(piece,), spans=((low, high),), divided=True)
        flat = develop(made.patches)
        found = on_strip(made, flat, outline.contour(outline.edges(flat), 0.05))
        return [hole.name for hole in found.inner], [finding.code for finding in found.findings]

    across = {
        "kind": "curve",
        "curve": {"polyline": [["0.4", "0.45"], ["0.6", "0.45"], ["0.6", "0.55"], ["0.4", "0.45"]]},
    }
    cut = Fraction(1, 2)
    for third, codes in ((circle(["0.2", "0.75"]), []), (circle(["0.5", "0.51"]), ["feature-cut"]),
                         ({"kind": "drill", "at": ["0.5", "0.51"], "diameter": 20}, ["feature-cut"]),
                         (across, ["feature-cut"])):  # fmt: skip
        holes = [circle(["0.5", "0.25"]), circle(["0.5", "0.75"]), third]
        surface = construct(part(HALF_TUBE, hole=holes), Tolerances()).product
        assert isinstance(surface, RuledSurface)
        first, second = blank(surface, Fraction(0), cut), blank(surface, cut, Fraction(1))
        assert second[1] == codes
        if not codes:
            assert (first, second) == ((["hole-1"], []), (["hole-2", "hole-3"], []))


def test_every_hole_of_a_divided_part_comes_out_on_one_blank() -> None:
    """A winding stair of two turns and a half: its pattern overlaps itself and is cut into three."""
    c0, c1 = ({"helix": {"radius": radius, "pitch": 10, "turns": "2.5"}} for radius in (20, 50))
    holes = [circle(["0.5", f"0.{k:02d}"], 4) for k in range(5, 100, 10)]
    tol = Tolerances(accept="leather")
    surface = construct(part({"kind": "ruled", "c0": c0, "c1": c1}, hole=holes, cut="auto"), tol).product
    assert surface is not None
    certificate = verify(surface, tol).product
    assert certificate is not None
    patterns = [unroll(blank, tol).product for blank in blanks(certificate, tol)]
    inner = [[hole.name for hole in pattern.inner] for pattern in patterns if pattern is not None]
    assert len(inner) == 3 and all(inner)
    assert [name for names in inner for name in names] == [f"hole-{k}" for k in range(1, 11)]


@pytest.mark.parametrize(("v", "on"), [("4", [False, True]), ("3.999", [True, False]), ("8", [False, True])])
def test_a_mark_on_the_cut_is_drawn_on_the_blank_that_begins_there_alone(v: str, on: list[bool]) -> None:
    """The cone of eight triangles is cut at v = 4, where a patch ends too; v = 8 is the end of the part."""
    marks = [{"kind": "point", "name": "here", "at": ["0.5", v], "size": 1}]
    whole = passage(WAVY, cut="auto", mark=marks).certificate
    assert whole is not None
    patterns = [unroll(blank, Tolerances()).product for blank in blanks(whole, Tolerances())]
    drawn = [{mark.name for mark in pattern.marks} for pattern in patterns if pattern is not None]
    assert ["here" in names for names in drawn] == on
