"""Stretching materials: what is said where the limit is passed, and whether the cuts suggested do what is said."""

import tomllib
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from stages.construct import construct
from stages.model.report import Finding, StageReport
from stages.model.scalars import Length, Point
from stages.model.surface import Certificate, Surface
from stages.model.tolerances import STRAIN_LIMIT, Tolerances
from stages.verify import verify
from tests.caps import cap, disc, on_cap, part, pole_strain, rim_strain
from tests.meshes import square_saddle
from tests.near import assert_near

LEATHER = Tolerances("leather")
BALL = cap(0.8, cells=24)


def surface(mesh: object, **keys: object) -> Surface:
    outcome = construct(part(mesh, **keys), LEATHER)  # type: ignore[arg-type]
    assert outcome.product is not None, outcome.report.findings
    return outcome.product


def strain(report: StageReport) -> float:
    return float(report.metric("max_strain").value or 0.0)


def finding(report: StageReport, code: str) -> Finding:
    (found,) = (one for one in report.findings if one.code == code)
    return found


@pytest.fixture(scope="module")
def refused() -> StageReport:
    outcome = verify(surface(BALL), LEATHER)
    assert outcome.product is None
    return outcome.report


def lines(text: str) -> tuple[tuple[Point, ...], ...]:
    """Return the cuts as the job file would have them: the text is pasted into one."""
    read = tomllib.loads(f"cuts = {text}")["cuts"]
    return tuple(
        tuple((Length(Fraction(x)), Length(Fraction(y)), Length(Fraction(z))) for x, y, z in line) for line in read
    )


def test_the_cuts_suggested_bring_what_they_promise(refused: StageReport) -> None:
    told = finding(refused, "cut-suggested")
    assert told.where is not None
    assert not told.fatal
    assert told.where["opens"] == "yes"
    cuts = lines(str(told.where["cuts"]))
    assert 1 <= len(cuts) <= 3
    pasted = verify(surface(BALL, cuts=cuts), LEATHER)
    assert isinstance(pasted.product, Certificate), pasted.report.findings
    assert strain(pasted.report) <= STRAIN_LIMIT["leather"] < strain(refused)
    # lengths beside a slit come from fits to one side of it; the trial is at rest to 1e-6 of the size
    assert_near(float(told.where["strain"]), strain(pasted.report), bound=1e-3, why="edges along the slit")


def test_a_cut_in_a_saddle_is_said_to_overlap() -> None:
    outcome = verify(surface(square_saddle(100.0, 1, 24)), LEATHER)
    told = finding(outcome.report, "cut-suggested")
    assert told.where is not None
    assert told.where["opens"] == "no"
    assert "gusset" in told.message


def test_sheet_metal_is_refused_and_told_what_would_do() -> None:
    gentle = verify(surface(cap(0.3, cells=20)), Tolerances())
    assert gentle.product is None
    assert "accept = 'leather' takes it" in finding(gentle.report, "not-developable").message
    strong = verify(surface(BALL), Tolerances())
    assert "needs `cuts`" in finding(strong.report, "not-developable").message
    assert "cut-suggested" not in [one.code for one in strong.report.findings]


def test_strain_is_that_of_the_closed_form_or_less_where_it_is_averaged() -> None:
    """Cells of 32 to 64 of 1800 triangles, a quarter of the radius wide: the rim's strain falls by half across one."""
    half = 0.45
    outcome = verify(surface(cap(half)), LEATHER)
    largest = max(abs(pole_strain(half)), rim_strain(half))
    assert 0.5 * largest <= strain(outcome.report) <= largest
    assert outcome.product is not None


def test_kept_outline_costs_strain_and_a_cut_gives_it_back() -> None:
    mesh = cap(0.35, cells=20)
    cut = (tuple(on_cap(polar, 1.0) for polar in np.linspace(0.35, 0.02, 4)),)
    free, held, both = (
        float(verify(surface(mesh, **keys), LEATHER).report.metric("strain_rms").value or 0.0)
        for keys in ({}, {"keep": "outline"}, {"keep": "outline", "cuts": cut})
    )
    assert max(free, both) < held


def test_lengths_that_no_plane_figure_has_are_refused_with_the_reason() -> None:
    """The edges around the pole of half a ball: its angles there add up to less than a full turn, and all are kept."""
    mesh = cap(1.4, cells=10)
    middle = int(np.argmax(mesh.vertices[:, 2]))
    around = mesh.faces[(mesh.faces == middle).any(axis=1)]
    pairs = np.unique(np.sort(around[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    outcome = verify(replace(disc(mesh), kept=pairs), LEATHER)
    assert outcome.product is None
    assert [one.code for one in outcome.report.findings if one.fatal] == ["keep-impossible"]
