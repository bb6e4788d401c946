"""A blank that bends in several directions: the worst face is what it is, and figures are gathered by their rules."""

from dataclasses import replace

import numpy as np
import pytest

from stages.construct.faces.surface import face_blanks, face_surface
from stages.geometry.curves.curves import bezier, exactly
from stages.geometry.ruled.ruled import between
from stages.model.gathered import Rule, gathered, told
from stages.model.report import Evidence, Finding, Metric
from stages.model.surface import BranchedSurface
from stages.model.tolerances import Tolerances
from stages.verify import verify
from tests import cad, cadshells

TOL = Tolerances()


@pytest.fixture(scope="module")
def surface(tmp_path_factory: pytest.TempPathFactory) -> BranchedSurface:
    file = cad.step(tmp_path_factory.mktemp("cad") / "a.step", cadshells.sewn(cadshells.conical_bend()))
    (one,) = face_blanks(cad.part(*cad.read(file).faces))
    made = face_surface(one, TOL).product
    assert isinstance(made, BranchedSurface)
    return made


def test_faces_that_are_developable_make_a_blank_that_is(surface: BranchedSurface) -> None:
    made = verify(surface, TOL)
    assert made.product is not None
    assert (made.product.reached, made.product.proved) == ("exact", True)
    assert made.report.metric("max_warp_deg").evidence == "proved"
    assert made.report.metric("min_bend_radius_mm").value == pytest.approx(60.0 * 0.5 / 0.75**0.5, rel=1e-9)


def twisted(surface: BranchedSurface, by: float) -> BranchedSurface:
    """Return the surface with the far corner of its last plane lifted."""
    face = surface.faces[2]
    (patch,) = face.patches
    c0, c1 = (curve.jet(np.array([0.0, 1.0]), 0)[0] for curve in (patch.c0, patch.c1))
    c1[1] += by * np.array([0.0, 0.0, 1.0])
    wrong = between(*(bezier([exactly(row) for row in rows]) for rows in (c0, c1)))
    return replace(surface, faces=(*surface.faces[:2], replace(face, patches=(wrong,))))


@pytest.mark.parametrize(("by", "passes"), [(0.0, True), (0.001, True), (20.0, False)])
def test_one_twisted_face_is_found_and_named(surface: BranchedSurface, by: float, passes: bool) -> None:
    made = verify(twisted(surface, by), TOL)
    assert (made.product is not None) == passes
    classes = {0.0: "exact", 0.001: "fabrication", 20.0: "rejected"}
    assert made.report.detail["class"] == classes[by]
    if not passes:
        fatal = [finding for finding in made.report.findings if finding.fatal]
        assert [finding.code for finding in fatal] == ["not-developable"]
        assert fatal[0].message.startswith("face 2: ")
        assert (made.report.metric("max_warp_deg").where or {})["face"] == 2


def rows(*values: float | bool | None, evidence: tuple[Evidence, ...] = ()) -> list[tuple[Metric, ...]]:
    kinds = evidence or ("proved",) * len(values)
    return [(Metric("x", v, "mm", kind, 5.0, {"v": i}),) for i, (v, kind) in enumerate(zip(values, kinds, strict=True))]


@pytest.mark.parametrize(
    ("rule", "values", "expected", "face"),
    [
        ("largest", (1.0, -3.0, 2.0), -3.0, 11),
        ("least", (1.0, -3.0, 2.0), -3.0, 11),
        ("least", (None, 3.0, 2.0), 2.0, 12),
        ("sum", (1.0, -3.0, 4.0), 2.0, None),
        ("sum", (1.0, None, 4.0), None, None),
        ("largest", (1.0, None, 4.0), None, 11),
        ("alike", (2.0, 2.0, 2.0), 2.0, 10),
        ("alike", (2.0, 2.0, 3.0), None, 10),
        ("all", (True, False, True), False, 11),
        ("all", (True, True, True), True, 10),
        ("largest", (None, None, None), None, 10),
    ],
)
def test_figures_are_gathered_by_their_rule(
    rule: Rule, values: tuple[float | bool | None, ...], expected: float | bool | None, face: int | None
) -> None:
    (metric,) = gathered(rows(*values), [10, 11, 12], {"x": rule})
    assert metric.value == expected
    assert type(metric.value) is type(expected)
    assert (metric.where or {}).get("face") == face
    assert (metric.unit, metric.limit) == ("mm", 5.0)


def test_a_face_on_which_a_figure_is_not_defined_anywhere_is_passed_over() -> None:
    (metric,) = gathered([*rows(1.0), (Metric("x", None, "mm", "proved", 5.0),), *rows(2.0)], [10, 11, 12], {})
    assert (metric.value, (metric.where or {}).get("face")) == (2.0, 12)


def test_a_gathered_figure_is_proved_where_all_are() -> None:
    (proved,) = gathered(rows(1.0, 2.0), [0, 1], {})
    (sampled,) = gathered(rows(1.0, 2.0, evidence=("sampled", "proved")), [0, 1], {})
    assert (proved.evidence, sampled.evidence) == ("proved", "sampled")


def test_what_is_said_of_several_faces_is_said_once() -> None:
    thin, other = Finding("thin", "it is thin"), Finding("thin", "it is thick", True, {"v": 1.0})
    found = told([(thin,), (thin, other), ()], [7, 3, 5])
    assert [one.message for one in found] == ["faces 3, 7: it is thin", "face 3: it is thick"]
    assert [one.fatal for one in found] == [False, True]
    assert found[1].where == {"v": 1.0, "face": 3}
