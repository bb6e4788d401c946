"""Whether the formed surface passes through itself, which no sheet can: a fatal finding for every crossing.

Sampled: sheets that pass through each other by less than 1e-5 of the size count as touching (`geometry.crossing`).
"""

from stages.geometry import crossing
from stages.model.report import Finding
from stages.model.surface import RuledSurface


def crossings(surface: RuledSurface) -> list[Finding]:
    """Return a finding for every two patches that cross, a patch with itself too: where, and how deep."""
    return [_finding(surface, found) for found in crossing.crossings(surface.patches, surface.size_mm)]


def _finding(surface: RuledSurface, found: crossing.Crossing) -> Finding:
    v, v2 = (surface.v_of(piece, v) for piece, v in zip(found.patches, found.v, strict=True))
    x, y, z = (float(value) for value in found.point)
    message = (
        f"the formed surface passes through itself at ({x:.6g}, {y:.6g}, {z:.6g}) mm, {found.depth_mm:.3g} mm deep: "
        f"v = {v:.6g}, u = {found.u[0]:.4g} meets v = {v2:.6g}, u = {found.u[1]:.4g}"
    )
    place = {"v": v, "u": found.u[0], "v2": v2, "u2": found.u[1], "x": x, "y": y, "z": z}
    return Finding("self-crossing", message, True, {**place, "depth_mm": found.depth_mm})
