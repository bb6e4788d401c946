"""Cuts and kept lengths: what becomes of good ones, and what is said of those that cannot be made."""

from fractions import Fraction

import numpy as np
import pytest

from stages.construct import construct
from stages.geometry.mesh.topology import edges_of
from stages.model.meshes import MeshFile
from stages.model.report import Outcome
from stages.model.scalars import Length, Point
from stages.model.surface import MeshSurface, Surface
from stages.model.tolerances import Tolerances
from tests.caps import RADIUS, cap, on_cap, part
from tests.near import assert_near

HALF = 0.5
MESH = cap(HALF, cells=16)


def made(**keys: object) -> Outcome[Surface | None]:
    return construct(part(MESH, **keys), Tolerances("leather"))


def line(start: float, end: float, turn: float = 0.3) -> tuple[Point, ...]:
    return tuple(on_cap(polar, turn) for polar in np.linspace(start, end, 4))


def surface(outcome: Outcome[Surface | None]) -> MeshSurface:
    assert isinstance(outcome.product, MeshSurface), outcome.report.findings
    return outcome.product


def point(place: np.ndarray) -> Point:
    x, y, z = (Length(Fraction(float(value))) for value in place)
    return x, y, z


def fatal(outcome: Outcome[Surface | None]) -> list[str]:
    return [finding.code for finding in outcome.report.findings if finding.fatal]


ACROSS = tuple(on_cap(polar, turn) for polar, turn in ((HALF, 0.9), (0.25, 0.2), (0.3, -0.8)))


@pytest.mark.parametrize("cut", [line(HALF, 0.1), line(0.1, HALF)])
def test_a_cut_is_slit_from_either_of_its_ends(cut: tuple[Point, ...]) -> None:
    outcome = made(cuts=(cut,))
    found = surface(outcome)
    ((one, other),) = found.slits
    assert len(one) == len(other)
    assert len(found.loops[0]) == 64 + 2 * (len(one) - 1)
    assert outcome.report.metric("cuts").value == 1
    length = float(outcome.report.metric("cut_length_mm").value or 0.0)
    assert RADIUS * 0.4 * 0.9 <= length <= RADIUS * 0.4 * 1.4


@pytest.mark.parametrize(
    ("cuts", "code"),
    [
        ((line(0.3, 0.05),), "mesh-cut"),
        ((tuple(on_cap(p, t) for p, t in ((HALF, 0.0), (0.0, 0.0), (HALF, np.pi))),), "mesh-cut"),
        ((line(HALF, 0.05, 0.2), ACROSS), "mesh-cuts-meet"),
        ((tuple(on_cap(p, 0.0, 2.0 * RADIUS) for p in (HALF, 0.1)),), "mesh-cut"),
    ],
    ids=["begins inside", "from rim to rim", "two that cross", "off the mesh"],
)  # fmt: skip
def test_a_cut_that_cannot_be_made_is_refused_with_its_place(cuts: tuple[tuple[Point, ...], ...], code: str) -> None:
    outcome = made(cuts=cuts)
    assert fatal(outcome) == [code]
    (finding,) = (finding for finding in outcome.report.findings if finding.fatal)
    assert finding.where is not None
    assert {"x", "y", "z"} <= set(finding.where)


def test_the_outline_is_kept_but_for_the_sides_of_cuts() -> None:
    assert len(surface(made(keep="outline")).kept) == 64
    assert len(surface(made(keep="outline", cuts=(line(HALF, 0.1),))).kept) == 64
    length = made(keep="outline").report.metric("kept_mm")
    assert_near(float(length.value or 0.0), 64.0 * 2.0 * RADIUS * np.sin(HALF) * np.sin(np.pi / 64.0), bound=0.5,
                why="64 chords of the rim, nearly even")  # fmt: skip


def test_lengths_along_lines_are_kept() -> None:
    rim = tuple(on_cap(HALF, turn) for turn in np.linspace(0.1, 1.5, 9))
    found = surface(made(keep=(rim, line(0.4, 0.1, 2.5))))
    assert 0 < len(found.kept) < 64
    assert (found.kept[:, 0] < found.kept[:, 1]).all()


@pytest.mark.parametrize(
    "keep",
    [
        (tuple(on_cap(p, 0.0, 3.0 * RADIUS) for p in (HALF, 0.1)),),
        (tuple(on_cap(p, 0.0) for p in (0.2, 0.201)),),
    ],
    ids=["off the mesh", "shorter than an edge"],
)
def test_a_line_that_no_edge_follows_is_refused(keep: tuple[tuple[Point, ...], ...]) -> None:
    assert fatal(made(keep=keep)) == ["mesh-keep"]


def test_more_lengths_than_a_plane_figure_has_are_refused() -> None:
    """Every edge well inside: three to a vertex, where two are enough."""
    ends = MESH.vertices[edges_of(MESH).ends]
    inside = ends[(np.hypot(ends[..., 0], ends[..., 1]) < 0.6 * RADIUS * np.sin(HALF)).all(axis=1)]
    every = tuple(tuple(point(place) for place in pair) for pair in inside)
    outcome = made(keep=every)
    assert fatal(outcome) == ["mesh-keep"]
    assert "more than a plane figure has" in outcome.report.findings[-1].message


def test_a_line_without_length_is_trouble_of_the_job_file() -> None:
    spec = MeshFile(file="m.stl", keep=((on_cap(0.1, 0.0),) * 2,), cuts=((on_cap(0.2, 0.0),) * 3,))
    assert [trouble.key for trouble in spec.troubles()] == ["keep[0]", "cuts[0]"]
