"""Whether the formed surface passes through itself, which no sheet can: a fatal finding for every crossing.

Sampled (`geometry.ruled.crossing`): sheets that pass through each other by less than 1e-5 of the size touch.
Where sheets lie on each other over an area, as a pipe wound twice, whether they cross too is not decided: told.
"""

from stages.geometry.ruled import crossing
from stages.model.report import Finding
from stages.model.surface import RuledSurface


def crossings(surface: RuledSurface) -> list[Finding]:
    """Return a finding for every two patches that cross, a patch with itself too: where, and how deep.

    One more, not fatal, where the search ended before all places were settled.
    """
    search = crossing.crossings(surface.patches, surface.size_mm)
    found = [_finding(surface, one) for one in search.found]
    return found if search.unsettled is None else [*found, _undecided(surface, search.unsettled)]


def _undecided(surface: RuledSurface, left: crossing.Unsettled) -> Finding:
    """Say that the part lies on itself, or so nearly that it was not seen whether it crosses there."""
    v, v2 = (surface.v_of(piece, v) for piece, v in zip(left.patches, left.v, strict=True))
    x, y, z = (float(value) for value in left.point)
    message = (
        f"the formed surface lies on itself, or nearly, about ({x:.6g}, {y:.6g}, {z:.6g}) mm: v = {v:.6g} and "
        f"v = {v2:.6g}; whether it passes through itself there was not decided ({left.pairs} pairs of places up to "
        f"{left.cell_mm:.3g} mm wide were left)"
    )
    place = {"v": v, "u": left.u[0], "v2": v2, "u2": left.u[1], "x": x, "y": y, "z": z}
    return Finding("lies-on-itself", message, False, {**place, "pairs": left.pairs, "cell_mm": left.cell_mm})


def _finding(surface: RuledSurface, found: crossing.Crossing) -> Finding:
    v, v2 = (surface.v_of(piece, v) for piece, v in zip(found.patches, found.v, strict=True))
    x, y, z = (float(value) for value in found.point)
    message = (
        f"the formed surface passes through itself at ({x:.6g}, {y:.6g}, {z:.6g}) mm, {found.depth_mm:.3g} mm deep: "
        f"v = {v:.6g}, u = {found.u[0]:.4g} meets v = {v2:.6g}, u = {found.u[1]:.4g}"
    )
    place = {"v": v, "u": found.u[0], "v2": v2, "u2": found.u[1], "x": x, "y": y, "z": z}
    return Finding("self-crossing", message, True, {**place, "depth_mm": found.depth_mm})
