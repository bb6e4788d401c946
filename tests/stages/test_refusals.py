"""What no kind can make: refused with reason, place and the largest value that would do; a thousandth inside, made."""

from math import cos, radians, sin

import pytest

from tests.parts import AUMANN_FIRST, AUMANN_POINTS, Table, passage, troubles

PAIR: Table = {"kind": "bezier-pair", "points": AUMANN_POINTS, "first": AUMANN_FIRST, "mu": 2.3}
CUBIC: Table = {"bezier": [[0, 0, 0], [1, 0, 0], [2, 1, 0.2], [3, 3, 2]]}
CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 100}}
ARC: Table = {"arc": {"center": [0, 0, 0], "radius": 50, "start": 0, "end": 90}}
TEE: Table = {"kind": "tee", "branch": 100, "main": 100, "length": 150}
ELLIPSE: Table = {"ellipse": {"center": [0, 0, 9], "major": [5, 0, 0], "minor": [0, 3, 0]}}


def normals(lean_deg: float) -> list[list[str]]:
    """Return normals of a cone of 45 deg along the quarter circle, leaning ahead along it by an angle."""
    lean, made = radians(lean_deg), []
    for k in range(4):
        a = radians(30.0 * k)
        up = cos(lean) / 2**0.5
        ahead = sin(lean)
        made.append([repr(up * cos(a) - ahead * sin(a)), repr(up * sin(a) + ahead * cos(a)), repr(up)])
    return made


def slope(length: float) -> Table:
    return {"kind": "slope", "curve": CIRCLE, "angle": 60, "side": "in", "length": repr(length)}


def ribbon(left: float, lean_deg: float = 0.0) -> Table:
    return {"kind": "ribbon", "curve": ARC, "normals": normals(lean_deg), "widths": [repr(left), 5]}


def strap(half: float) -> Table:
    return {"kind": "strap", "centre": CUBIC, "half_width": repr(half)}


def cone(height: float) -> Table:
    """Return the cone over a quarter circle with its apex above one of its points."""
    return {"kind": "cone", "apex": [0, 50, repr(height)], "directrix": ARC}


def cylinder(rise: float) -> Table:
    """Return rulings along x, or nearly, over an arc whose tangent has that direction at its end or inside."""
    return {"kind": "cylinder", "directrix": ARC | {"arc": {**ARC["arc"], "end": 180}},  # type: ignore[dict-item]
            "direction": [1, 0, repr(rise)], "length": 5}  # fmt: skip


def largest(table: Table, name: str) -> float:
    """Return the largest width that construct tells."""
    value = passage(table).value("construct", name)
    assert isinstance(value, float)
    return value


@pytest.mark.parametrize(("inside", "outside", "stage", "code", "words"), [
    (PAIR | {"lambda": "1.001"}, PAIR | {"lambda": "0.999"}, "construct", "edge-of-regression", "at least 1"),
    (slope(199.8), slope(200.2), "construct", "slope-past-ridge", "at most 199.999999 mm"),
    (TEE | {"branch": "99.9"}, TEE | {"branch": "100.1"}, "construct", "saddle-misses", "branch at most 100 mm"),
    (TEE | {"branch": 60, "offset": "19.98"}, TEE | {"branch": 60, "offset": "20.02"}, "construct", "saddle-misses",
     "offset at most 20 mm"),
    (ribbon(5.0, 0.999), ribbon(5.0, 1.001), "construct", "normals-not-perpendicular", "at most 1 deg"),
    (cone(0.05), cone(0.0), "construct", "apex-on-directrix", "apex lies on the directrix"),
    (cylinder(0.001), cylinder(0.0), "verify", "singular-ruling", "v = 0.5"),
], ids=["pair", "slope", "branch", "offset", "normals", "apex", "direction"])  # fmt: skip
def test_a_thousandth_inside_is_made_and_outside_is_refused_with_the_reason(
    inside: Table, outside: Table, stage: str, code: str, words: str
) -> None:
    good = passage(inside)
    assert code not in [found for report in good.reports for found in good.codes(report, fatal=True)]
    assert good.refused_by is None
    bad = passage(outside)
    assert bad.refused_by == stage
    (finding,) = (f for f in bad.reports[stage].findings if f.fatal and f.code == code)
    assert words in finding.message
    assert finding.where


@pytest.mark.parametrize(("made", "metric", "code"), [
    (strap, "half_width_max_mm", "strap-too-wide"), (ribbon, "width_left_max_mm", "ribbon-too-wide"),
])  # fmt: skip
def test_the_largest_width_that_is_told_is_the_largest(made: object, metric: str, code: str) -> None:
    assert callable(made)
    most = largest(made(0.01), metric)
    assert passage(made(0.999 * most)).refused_by is None
    bad = passage(made(1.001 * most))
    (finding,) = (f for f in bad.reports["construct"].findings if f.fatal)
    assert finding.code == code and f"{most:.6g} mm" in finding.message and finding.where


def test_an_open_rail_does_not_go_with_a_closed_one() -> None:
    """Said before anything runs where the job file shows it, else by construct: an unclamped spline."""
    ring = [[5, 0, 0], [0, 5, 0], [-5, 0, 0], [0, -5, 0], [5, 0, 0]]
    rails = {"kind": "rails", "rail_a": {"points": ring}, "rail_b": ELLIPSE}
    assert troubles(rails) == []
    ajar = [*ring[:-1], [5, "0.001", 0]]
    assert troubles(rails | {"rail_a": {"points": ajar}}) == ["rail_a is open and rail_b is closed"]
    spline = {"degree": 3, "knots": [0, 1, 2, 3, 4, 5, 6, 7], "points": ring[:-1]}
    made = passage(rails | {"rail_a": {"bspline": spline}})
    assert made.codes("construct", fatal=True) == ["open-and-closed"]


def test_a_tangent_surface_may_begin_on_its_edge_but_not_cross_it() -> None:
    tangent: Table = {"kind": "tangent", "edge": CUBIC, "from": "-0.001", "to": 1}
    assert troubles(tangent) == ["the edge of regression lies between from and to"]
    for start in ("0", "0.001"):
        assert passage(tangent | {"from": start}).refused_by is None
