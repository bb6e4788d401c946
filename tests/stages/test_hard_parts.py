"""Parts at the edge of what has a shape: no NaN, no traceback; a product, or a report that says why not.

Named cases first, then random specifications of every kind.  The project's settings make numpy's warnings errors.
"""

import math

import pytest
from hypothesis import HealthCheck, Phase, assume, example, given, settings

from stages.errors import NoSolutionError
from stages.model.tolerances import Tolerances
from tests.parts import EXAMPLE_1, QUINTIC_TANGENT, RIGHT_FRUSTUM, Passage, Table, passage, troubles
from tests.strategies import quintic_cone, surfaces

ARC: Table = {"arc": {"center": [0, 0, 0], "radius": 10, "start": 10, "end": 100}}
CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 10}}


def lines(first: list[list[float]], second: list[list[float]]) -> Table:
    key = "line" if len(first) == len("ab") else "polyline"
    return {"kind": "ruled", "c0": {key: first}, "c1": {key: second}}


def cylinder(profile: Table, direction: list[float], **end: object) -> Table:
    return {"kind": "cylinder", "directrix": profile, "direction": direction} | (end or {"length": 5})


CASES: dict[str, tuple[Table, str | None]] = {
    "apex at the end of the directrix": ({"kind": "cone", "apex": [10, 0, 0], "directrix": CIRCLE}, "construct"),
    "apex inside a plane circle": ({"kind": "cone", "apex": [1, 0, 0], "directrix": CIRCLE}, None),
    "apex in line with a straight directrix": (
        {"kind": "cone", "apex": [5, 0, 0], "directrix": {"line": [[0, 0, 0], [2, 0, 0]]}}, "verify"),
    "apex on a tangent inside": ({"kind": "cone", "apex": [20, 0, 0], "directrix": CIRCLE}, "verify"),
    "apex on a tangent at the end": (
        {"kind": "cone", "apex": [0, 4, 0], "directrix": {"bezier": [[0, 0, 0], [0, 1, 0], [1, 1, 2]]}}, None),
    "cone from its apex": (RIGHT_FRUSTUM | {"radius0": 0}, None),
    "cone to its apex": (RIGHT_FRUSTUM | {"radius1": 0}, None),
    "plane disc": (RIGHT_FRUSTUM | {"radius1": 0, "height": 0}, None),
    "Theorem 2.1": (EXAMPLE_1, None),
    "triangle, first ruling of no length": (lines([[0, 0, 0], [3, 0, 0]], [[0, 0, 0], [3, 4, 0]]), None),
    "triangle, last ruling of no length": (lines([[0, 0, 0], [3, 0, 0]], [[0, 4, 0], [3, 0, 0]]), None),
    "edges that cross": (lines([[0, 0, 0], [3, 0, 0]], [[0, 1, 0], [3, -1, 0]]), "verify"),
    "edges in one line": (lines([[0, 0, 0], [3, 0, 0]], [[4, 0, 0], [9, 0, 0]]), "verify"),
    "edges that run against each other": (lines([[0, 0, 0], [3, 0, 0]], [[3, 1, 0], [0, 1, 0]]), "verify"),
    "two-piece polylines": (lines([[0, 0, 0], [1, 0, 0], [2, 1, 0]], [[0, 0, 1], [1, 0, 1], [2, 1, 1]]), None),
    "a polyline that doubles back": (
        lines([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], [[0, 0, 1], [1, 0, 1], [0.5, 0, 1]]), None),
    "profile with an inflection": (
        cylinder({"bezier": [[0, 0, 0], [1, 2, 0], [2, -2, 0], [3, 0, 0]]}, [0, 0, 1]), None),
    "profile with a cusp": (cylinder({"bezier": [[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0]]}, [0, 0, 1]), "verify"),
    "profile that starts at rest": (
        cylinder({"bezier": [[0, 0, 0], [0, 0, 0], [1, 1, 0], [2, 0, 0]]}, [0, 0, 1]), None),
    "straight profile that stops and goes on": (
        cylinder({"bezier": [[-1, 0, 0], [1, 0, 0], [-1, 0, 0], [1, 0, 0]]}, [0, 0, 1]), None),
    "direction along a tangent inside": (cylinder(CIRCLE, [1, 0, 0]), "verify"),
    "direction along a tangent at the end": (
        cylinder({"bezier": [[0, 0, 0], [1, 1, 0], [2, 0, 0.5]]}, [1, 1, 0]), None),
    "pipe cut to a point at its seam": (
        cylinder(CIRCLE, [0.3, 0.2, 1], end_plane={"point": [10, 0, 0], "normal": [1, 0, 1]}), None),
    "pipe cut through its start": (
        cylinder(CIRCLE, [0.3, 0.2, 1], end_plane={"point": [0, 0, 0], "normal": [1, 0, 1]}), "verify"),
    "arcs that touch at a point": (
        {"kind": "ruled", "c0": ARC, "c1": {"arc": {"center": [0, 0, 0], "radius": 10, "start": 10, "end": 160}}},
        "verify"),
    "helicoid": (
        {"kind": "ruled", "c0": {"helix": {"radius": 10, "pitch": 5, "turns": 3}},
         "c1": {"helix": {"radius": 5, "pitch": 5, "turns": 3}}}, "unroll"),
    "far from the origin": (
        {"kind": "cone", "apex": [1000000, "2000000.2", 2],
         "directrix": {"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "weights": [1, 2, 0.5],
                       "points": [[1000000, 2000000, 0], ["1000000.5", 2000000, 0.5], [1000001, 2000001, 0]]}}}, None),
}  # fmt: skip


def numbers(value: object) -> list[float]:
    """Return every number in a detail, however nested."""
    if isinstance(value, dict):
        return [x for item in value.values() for x in numbers(item)]
    if isinstance(value, list | tuple):
        return [x for item in value for x in numbers(item)]
    return [float(value)] if isinstance(value, float | int) else []


def assert_sound(made: Passage) -> None:
    """Fail unless the last stage has a product, or its report says why not; all figures are numbers."""
    for report in made.reports.values():
        for metric in report.metrics:
            assert metric.value is None or math.isfinite(metric.value), metric
            assert metric.where is None or all(isinstance(x, str) or math.isfinite(x) for x in metric.where.values())
        assert all(math.isfinite(x) for x in numbers(report.detail)), report.detail
        for finding in report.findings:
            assert finding.message
    if made.pattern is None:
        last = [*made.reports.values()][-1]
        assert not last.passed, f"{last.stage} made nothing and does not say why"


@pytest.mark.parametrize("name", CASES)
def test_a_hard_part_is_made_or_refused_with_a_reason(name: str) -> None:
    table, refused_by = CASES[name]
    made = passage(table, Tolerances(accept="metal"))
    assert_sound(made)
    assert made.refused_by == refused_by, {k: v.findings for k, v in made.reports.items()}


SPECK = [
    ["0", "0.001", "-0.001"],
    ["0.002", "-0.002", "0.003"],
    ["-0.003", "0.004", "-0.004"],
    ["0.005", "-0.005", "0.006"],
]
LONG_TANGENTS: Table = {"kind": "tangent", "edge": {"points": SPECK}, "from": 0, "to": 3}
"""An edge of 0.02 mm that turns by 355 deg: in its pattern chords are far below the freedom that arcs have to move."""
CALM = {"deadline": None, "suppress_health_check": (HealthCheck.too_slow, HealthCheck.filter_too_much)}
PHASES = (Phase.explicit, Phase.generate)
"""No shrinking: a part takes up to a second, and a random one is small already."""


def assert_sound_or_short(table: Table) -> None:
    """Fail unless a part is made, refused with a reason, or given up with both numbers."""
    assume(not troubles(table))
    try:
        assert_sound(passage(table, Tolerances(accept="leather")))
    except NoSolutionError as error:
        assert not error.reached <= error.wanted


@settings(max_examples=80, phases=PHASES, **CALM)
@given(surfaces())
@example(QUINTIC_TANGENT)
@example(LONG_TANGENTS)
def test_any_part_is_made_or_refused_with_a_reason(table: Table) -> None:
    assert_sound_or_short(table)


@settings(max_examples=8, phases=PHASES, **CALM)
@given(quintic_cone(given=False))
def test_any_minimax_is_found_or_refused_with_a_reason(table: Table) -> None:
    assert_sound_or_short(table)
