"""A strip through given points with their tangents and curvatures: a quintic (2.2) from each to the next, all G2.

At every point both spans have the same tangent and the same curvature vector k N, whatever their shape parameters;
these are those of least strain energy, each span by itself, so that points may lie as unevenly as they like.  Over
such a curve the cylinder and the cone are developable exactly, and joined with equal curvature across the common
ruling: their tangent planes and curvatures there are functions of ruling, tangent and k N alone.
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from stages.construct import theorems
from stages.construct.apex import apex_findings
from stages.construct.built import Built
from stages.construct.energy import Shape, least_energy
from stages.construct.quintic import End, cone_over, directrix, moved, patch_between, unit_exact, vector
from stages.construct.shape import bound_findings, shape_detail
from stages.geometry.curves.curves import Bezier
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.quinticstrip import QuinticStrip, Station
from stages.model.report import Finding
from stages.model.tolerances import Tolerances

Span = tuple[End, End]


def strip_through(spec: QuinticStrip, tol: Tolerances) -> Built:
    """Return the cylinder or the cone over the curve through the stations of a strip."""
    stations = [_end(station, normalise=tol.normalise) for station in spec.through or ()]
    shapes = [least_energy(*pair) for pair in pairwise(stations)]
    spans = [_shaped(*pair, shape) for pair, shape in zip(pairwise(stations), shapes, strict=True)]
    patches, off = _patches(spec, spans)
    named = [(f"through[{i}]", station) for i, station in enumerate(stations)]
    metrics, findings = theorems.end_metrics(named, tol)
    bounds = [found for i, shape in enumerate(shapes) for found in bound_findings(shape, where=f"span {i}: ")]
    relative = theorems.relative_c if spec.apex is None else theorems.relative_a
    return Built(
        patches,
        tuple(metrics),
        (*findings, *bounds, *off),
        lambda size: max(relative(patch, size) for patch in patches),
        theorems.coefficients(patches) | {"spans": [shape_detail(shape) for shape in shapes]},
    )


def _end(station: Station, *, normalise: bool) -> End:
    """Return the end data of a station; the shape parameters come later."""
    tangent, normal = vector(station.tangent), vector(station.normal)
    if normalise:
        tangent, normal = unit_exact(tangent), unit_exact(normal)
    return End(vector(station.point), tangent, normal, Fraction(station.k), Fraction(0), Fraction(0))


def _shaped(start: End, end: End, shape: Shape) -> Span:
    return (
        replace(start, alpha=Fraction(shape.alpha0), beta=Fraction(shape.beta0)),
        replace(end, alpha=Fraction(shape.alpha1), beta=Fraction(shape.beta1)),
    )


def _patches(spec: QuinticStrip, spans: Sequence[Span]) -> tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]:
    """Return a patch over every span, and an apex on the curve."""
    if spec.apex is None:
        ruling = vector(spec.ruling or ())
        return tuple(patch_between(span, (moved(span[0], ruling), moved(span[1], ruling))) for span in spans), ()
    apex, (low, high) = vector(spec.apex), spec.range_kept()
    curves: list[Bezier] = [directrix(*span) for span in spans]
    patches = tuple(cone_over(curve, apex, (Fraction(low), Fraction(high))) for curve in curves)
    return patches, apex_findings(curves, apex)
