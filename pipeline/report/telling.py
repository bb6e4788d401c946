"""What is reported twice, as a number past its limit and in words: which findings tell of which metrics."""

from collections.abc import Iterable

TELLS_OF = {
    "not-developable": ("max_warp_deg", "equivalent_warp_deg", "max_strain"),
    "edge-of-regression": ("max_warp_deg",),
    "bend-radius": ("min_bend_radius_mm",),
    "bend-strain": ("outer_fibre_strain",),
    "curve-off-mesh": ("mesh_distance_mm",),
    "flat-gap": ("flat_gap_mm",),
    "flat-overlap": ("overlap_mm2",),
    "mesh-normals": ("normal_change_deg",),
    "normals-not-perpendicular": ("normal_lean_deg",),
    "not-planar": ("planar_error_mm",),
    "strain": ("max_strain",),
}
"""Findings that say in words what a failed metric of their stage says, which is then not said twice, nor counted."""


def told_of(codes: Iterable[str]) -> frozenset[str]:
    """Return the metrics of a stage of which its findings with these codes tell."""
    return frozenset(name for code in codes for name in TELLS_OF.get(code, ()))
