"""Bend tables of every kind that bends: their angles against the turning of the surface, their ends on the contour.

The turning is measured by a second method: the normal of the finished surface is followed from ruling to ruling, and
its turns about the ruling are added up with their signs.  No table, no quadrature of the program comes in.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from stages.construct import construct
from stages.construct.sets import parts_of
from stages.geometry.arrays import Array, Points2, Points3, cross3, dot, unit
from stages.geometry.paths.arcpath import ArcPath, distances, piece_count, split
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.pattern import FlatPattern
from stages.model.surface import RuledSurface
from stages.unroll import unroll
from stages.verify import verify
from tests.kinds.examples import EXAMPLES
from tests.near import assert_near
from tests.parts import DEFAULT, part

SIZE = Fraction(40)
STEPS = 2000
W12_DEG = 0.1
"""Sum of the signed angles of all bends against the turning of the surface."""
W12_MM = 0.05
"""From the end of a bend line to the contour that it ends on."""

Row = dict[str, object]


@cache
def blanks(kind: str) -> list[tuple[RuledSurface, FlatPattern, list[Row]]]:
    """Return the blanks of a kind: their surfaces, their patterns, their bend tables."""
    found = []
    for piece in parts_of(part(EXAMPLES[kind].table(SIZE), bend=[{"max_angle": 12}])):
        made = construct(piece, DEFAULT).product
        assert isinstance(made, RuledSurface)
        certificate = verify(made, DEFAULT).product
        assert certificate is not None
        outcome = unroll(certificate, DEFAULT)
        rows = outcome.report.detail["bends"]
        assert outcome.product is not None
        assert isinstance(rows, list)
        found.append((made, outcome.product, rows))
    return found


def normals(patch: RuledPatch) -> tuple[Points3, Points3]:
    """Return unit normals p x S_v and unit rulings of a patch from its first ruling to its last."""
    # the ends themselves may be apexes or cusps of an edge
    v = np.linspace(1e-7, 1.0 - 1e-7, STEPS)
    along = unit(patch.p.jet(v, 0)[0])
    middle = (patch.c0.jet(v, 1)[1] + patch.c1.jet(v, 1)[1]) / 2.0
    return unit(cross3(along, middle)), along


def turning_deg(surface: RuledSurface) -> float:
    """Return the turns of the normal about the rulings added up, towards the normal positive, in degrees."""
    found = [normals(patch) for patch in surface.patches]
    across, along = (np.concatenate([pair[k] for pair in found]) for k in (0, 1))
    sine = dot(cross3(across[:-1], across[1:]), unit(along[:-1] + along[1:]))
    return float(np.degrees(np.arctan2(sine, dot(across[:-1], across[1:])).sum()))


@pytest.mark.parametrize("kind", EXAMPLES)
def test_the_signed_angles_add_up_to_the_turning_of_the_surface(kind: str) -> None:
    for surface, _, rows in blanks(kind):
        told = sum(float(str(row["angle_deg"])) for row in rows)
        assert_near(told, turning_deg(surface), bound=W12_DEG, why="W12")


@pytest.mark.parametrize("kind", EXAMPLES)
def test_bend_lines_end_on_the_contour(kind: str) -> None:
    for _, pattern, rows in blanks(kind):
        ends = np.array([end for row in rows for piece in row["pieces"] for end in piece]).reshape(-1, 2)  # type: ignore[attr-defined]
        assert_near(away(ends, pattern), np.zeros(len(ends)), bound=W12_MM, why="W12")


def away(points: Points2, pattern: FlatPattern) -> Array:
    """Return how far points are from the nearest contour, mm."""
    paths = [split(contour.path, max_bulge=0.4) for contour in (pattern.outer, *pattern.inner)]
    return np.array([min(_away(point, path) for path in paths) for point in points])


def _away(point: Array, path: ArcPath) -> float:
    count = piece_count(path)
    return float(distances(np.broadcast_to(point, (count, 2)), path, np.arange(count)).min())


@pytest.mark.parametrize("fault", ["a bend less", "a sign", "an angle"])
def test_a_fault_in_a_table_is_seen(fault: str) -> None:
    ((surface, _, rows),) = blanks("cone")
    angles = [float(str(row["angle_deg"])) for row in rows]
    if fault == "a bend less":
        angles = angles[1:]
    elif fault == "a sign":
        angles[3] = -angles[3]
    else:
        angles[0] += 2.0 * W12_DEG
    with pytest.raises(AssertionError):
        assert_near(sum(angles), turning_deg(surface), bound=W12_DEG, why="W12")


def test_a_line_that_ends_beside_the_contour_is_seen() -> None:
    ((_, pattern, rows),) = blanks("cylinder")
    (low, high), *_ = rows[len(rows) // 2]["pieces"]  # type: ignore[misc, attr-defined]
    along = unit(np.subtract(high, low))
    assert away(np.array([high - 2.0 * W12_MM * along]), pattern)[0] > W12_MM


def test_only_what_is_plane_has_no_bends() -> None:
    assert [kind for kind in EXAMPLES if not any(rows for _, _, rows in blanks(kind))] == ["quintic-planar"]
