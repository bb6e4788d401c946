"""Parts for tests, written as in a job file with its units resolved, and the way through the first three stages."""

import json
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise

import msgspec

from stages.construct import construct
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.material import Material, Part
from stages.model.part import PartSpec
from stages.model.pattern import FlatPattern
from stages.model.report import Metric, StageReport
from stages.model.surface import Certificate, RuledSurface, Surface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify

Table = dict[str, object]
DEFAULT, UNKNOWN = Tolerances(), Material()


def number(kind: type, value: object) -> object:
    """Return a number of the job file exactly: 0.1 is 1/10, "1/3" is 1/3."""
    return kind(Fraction(str(value)))


def read(surface: Table, **keys: object) -> PartSpec:
    """Return a part's specification, its rules unchecked."""
    return msgspec.convert({"name": "part", "surface": surface} | keys, PartSpec, dec_hook=number)


def troubles(surface: Table) -> list[str]:
    """Return the rules of the job file that a surface breaks."""
    return [trouble.message for trouble in read(surface).surface.troubles()]


def part(surface: Table, material: Material = UNKNOWN, **keys: object) -> Part:
    """Return the part with this surface; its rules must hold."""
    spec = read(surface, **keys)
    assert not [*spec.surface.troubles()], "the test's own part breaks a rule of the job file"
    return Part(spec, material)


@dataclass(frozen=True)
class Passage:
    """What the first three stages made of a part; a stage that was not reached is None."""

    surface: Surface | None
    certificate: Certificate | None
    pattern: FlatPattern | None
    reports: dict[str, StageReport]

    def metric(self, stage: str, name: str) -> Metric:
        """Return one metric."""
        return self.reports[stage].metric(name)

    def value(self, stage: str, name: str) -> object:
        """Return the value of one metric."""
        return self.metric(stage, name).value

    def codes(self, stage: str, *, fatal: bool | None = None) -> list[str]:
        """Return the codes of a stage's findings, all or those that are (not) fatal."""
        return [f.code for f in self.reports[stage].findings if fatal in (None, f.fatal)]

    @property
    def refused_by(self) -> str | None:
        """Return the stage that refused, or None."""
        return None if self.pattern is not None else list(self.reports)[-1]

    def side(self, name: str) -> dict[str, object]:
        """Return the figures of one side, "surface" or "flat"."""
        figures = self.reports["unroll"].detail[name]
        assert isinstance(figures, dict)
        return figures


def passage(surface: Table, tol: Tolerances = DEFAULT, material: Material = UNKNOWN, **keys: object) -> Passage:
    """Return what construct, verify and unroll say of a part."""
    made = construct(part(surface, material, **keys), tol)
    reports = {"construct": made.report}
    certificate = pattern = None
    if made.product is not None:
        checked = verify(made.product, tol)
        reports["verify"], certificate = checked.report, checked.product
    if certificate is not None:
        flat = unroll(certificate, tol)
        reports["unroll"], pattern = flat.report, flat.product
    return Passage(made.product, certificate, pattern, reports)


def whole(table: Table) -> Passage:
    """Return what became of a part; each is made once."""
    return _whole(json.dumps(table))


@cache
def _whole(table: str) -> Passage:
    return passage(json.loads(table))


def edges(table: Table, side: str = "flat") -> dict[str, float]:
    """Return the lengths of the edges of a part that is made once, mm."""
    found = whole(table).side(side)["edges"]
    assert isinstance(found, dict)
    return found


def patches(surface: Table) -> tuple[RuledPatch, ...]:
    """Return the ruled patches of a part that can be constructed."""
    made = construct(part(surface), Tolerances()).product
    assert isinstance(made, RuledSurface)
    return made.patches


EXAMPLE_1: Table = {
    "kind": "quintic-planar",
    "p0": [1, 3, 2], "q0": [1, 3, 6], "p1": [3, 81, 2], "q1": [3, 81, 6],
    "alpha0": 2, "alpha1": 3, "beta0": 4, "beta1": 1,
    "alpha0_hat": 2, "alpha1_hat": 4, "beta0_hat": 1, "beta1_hat": 1,
}  # fmt: skip

_ENDS_2: Table = {
    "p0": [1, 0.8415, 2], "q0": [1, 0.8415, 6], "p1": [5.2832, -0.8415, 2],
    "t0": [0.8798, 0.4754, 0], "t1": [0.8798, 0.4754, 0], "n0": [0, -1, 0], "n1": [0, 1, 0], "k0": 0.5, "k1": 0.5,
}  # fmt: skip
EXAMPLE_2_PRINTED: Table = _ENDS_2 | {
    "kind": "quintic-ruled", "q1": [5.2832, -0.8415, 10],
    "t0_hat": [0.8798, 0.4754, 0], "t1_hat": [0.8798, 0.4754, 0], "n0_hat": [0, -1, 0], "n1_hat": [0, 1, 0],
    "k0_hat": 0.5, "k1_hat": 0.5, "alpha0": 2, "alpha1": 3, "beta0": 4, "beta1": 1,
    "alpha0_hat": 2, "alpha1_hat": 4, "beta0_hat": 1, "beta1_hat": 1,
}  # fmt: skip
EXAMPLE_2_CYLINDER: Table = _ENDS_2 | {
    "kind": "quintic-cylinder", "alpha0": 2, "alpha1": 3, "s0": 2, "s1": "1/3", "g": 2,
}  # fmt: skip
EXAMPLE_3: Table = {
    "kind": "quintic-cone",
    "p0": [0.5, 0.4794, 2], "p1": [1.0708, 0.8776, 2], "t0": [0.7516, 0.6596, 0], "t1": [0.9017, 0.4323, 0],
    "n0": [0, -1, 0], "n1": [0, -1, 0], "k0": 0.5, "k1": 0.5, "apex": [0.8, 0.5, 5],
}  # fmt: skip
EXAMPLE_3_PRINTED: Table = EXAMPLE_3 | {"alpha0": 0.6983, "alpha1": 0.6968, "beta0": 0.1541, "beta1": 0.079}

QUINTIC_TANGENT: Table = {
    "kind": "ruled",
    "c0": {"bezier": [[125, 12.5, 0], [225, 52.5, 15], [310, 122.5, 48.75], [365, 217.5, 106.25], [382.5, 325, 190],
                      [352.5, 435, 290]]},
    "c1": {"bezier": [[350, 35, 0], [450, 129, 42], [508, 253, 109.5], [518, 393, 207.5], [477, 532, 334],
                      [375, 660, 470]]},
}  # fmt: skip
"""Part of the tangent surface of a quintic: developable with curved edges, neither cone nor cylinder."""

RIGHT_FRUSTUM: Table = {"kind": "cone", "radius0": 3, "radius1": 1.5, "height": 4, "sweep": 360}
CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 2}}
TAN_30 = "0.57735026918962576451"
MITRED_CYLINDER: Table = {
    "kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1],
    "end_plane": {"point": [0, 0, 5], "normal": [f"-{TAN_30}", 0, 1]},
}  # fmt: skip
OBLIQUE_CONE: Table = {"kind": "cone", "apex": [1.5, 0.5, 4], "directrix": CIRCLE, "fraction": [0, 0.75]}
ELLIPTIC_CYLINDER: Table = {
    "kind": "cylinder", "directrix": {"ellipse": {"center": [0, 0, 0], "major": [5, 0, 0], "minor": [0, 2, 0]}},
    "direction": [0, 0.5, 1], "length": 3,
}  # fmt: skip


def aumann(points: list[list[object]], first: list[object], lam: str, mu: str) -> Table:
    """Return Aumann's developable Bezier pair: d_{i+1} = ((1 - L) c_i + L c_{i+1} - (1 - M) d_i) / M, exact.

    The edge of regression lies at the share (M - t) / (M - L) of the way from c to d.
    """
    c = [[Fraction(str(x)) for x in point] for point in points]
    d = [[Fraction(str(x)) for x in first]]
    L, M = Fraction(lam), Fraction(mu)
    for a, b in pairwise(c):
        d.append([((1 - L) * x + L * y - (1 - M) * z) / M for x, y, z in zip(a, b, d[-1], strict=True)])
    rows = [[[str(x) for x in point] for point in curve] for curve in (c, d)]
    return {"kind": "ruled", "c0": {"bezier": rows[0]}, "c1": {"bezier": rows[1]}}


AUMANN_POINTS: list[list[object]] = [[0, 0, 0], [1, 0, 0.2], [2, 1.3, 0.6], [2.5, 2, 1.8]]
AUMANN_FIRST: list[object] = [0.1, 0.2, 1]
AUMANN_CUBIC = aumann(AUMANN_POINTS, AUMANN_FIRST, "1.8", "2.3")
NEXT_PATCH: Table = {
    "p1": [9, 1, 2.5], "t1": [0.6, 0, 0.8], "n1": [0, 1, 0], "k1": 0.2, "alpha1": 3, "s1": 0.5, "g": 1.25,
}  # fmt: skip
STRIP: Table = {"kind": "quintic-strip", "first": EXAMPLE_2_CYLINDER, "next": [NEXT_PATCH]}
AFTER_CONE: Table = {"p1": [1.6, 0.9, 2.2], "t1": [0.8, 0.6, 0], "n1": [0.6, -0.8, 0], "k1": 0.3, "alpha1": 0.6,
                     "beta1": 0.1}  # fmt: skip
CONE_STRIP: Table = {"kind": "quintic-strip", "first": EXAMPLE_3 | {"fraction": [0, 0.5]}, "next": [AFTER_CONE]}
