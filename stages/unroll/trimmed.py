"""The outline of a part that is trimmed: its loops through the flat map, lengths and area measured on both sides.

    trimmed(sheet, development, trim, chord_mm) -> Trimmed

A loop is given by curves of u and v (`model.surface.Trim`).  Its flat image is evaluated through the exact map; lengths
and area of the flat loops are integrals along numerical derivatives of the flat positions, those of the surface come
from its tangents alone: the length of S_u u' + S_v v', and the area, by Green's theorem in the plane of u and v, as the
integral of A dv round the loop with dA/du = |S_u x S_v|.  The two sides share no number.

Not for a loop that goes round a seam: cut it there first.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Values, Vector2, norm
from stages.geometry.curves.contours import swept
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.flatmap import Development
from stages.geometry.flat.mapped import FlatStrip, MappedEdge, backwards, images
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import NODES, WEIGHTS
from stages.geometry.ruled.ruled import longest_ruling
from stages.geometry.ruled.strip import Strip, jet
from stages.model.pattern import Contour
from stages.model.report import Metric
from stages.model.surface import RuledSurface, Trim
from stages.unroll import outline
from stages.unroll.thickness import Neutral


@dataclass(frozen=True, slots=True)
class Trimmed:
    """The loops of a trimmed part in the plane, and its figures: areas in mm2, the length of the outer loop in mm.

    surface_area: of the neutral surface.  given_area: of the surface as given.
    """

    outer: Contour
    inner: tuple[Contour, ...]
    metrics: tuple[Metric, ...]
    surface_area: float
    given_area: float
    flat_area: float
    outline_length: float


@dataclass(frozen=True, slots=True, eq=False)
class FlatLoop(ArrayValue):
    """A loop of the pattern, counter-clockwise, and its figures, all positive.

    lengths: on the neutral surface and in the plane, mm.  areas: on the neutral surface, in the plane and on the
    surface as given, mm2.
    """

    name: str
    edges: tuple[MappedEdge, ...]
    lengths: Array
    areas: Array


def trimmed(sheet: Neutral, development: Development, trim: Trim, chord_mm: float) -> Trimmed:
    """Return the loops of a trimmed part on the development of its neutral surface.

    Raises NoSolutionError where a curve is not resolved or its arcs do not keep the chord.
    """
    outer, *inner = flat_loops(sheet, development, trim)
    before, after, given = (float(area) for area in net_areas(outer, inner))
    return Trimmed(
        outline.contour(outer.edges, chord_mm, outer.name),
        tuple(outline.contour(backwards(hole.edges), chord_mm, hole.name) for hole in inner),
        (length_error([outer, *inner]), Metric("area_error", abs(after - before) / before)),
        before,
        given,
        after,
        float(outer.lengths[1]),
    )


def flat_loops(sheet: Neutral, development: Development, trim: Trim) -> tuple[FlatLoop, ...]:
    """Return the loops of a trimmed part with their figures, the outer one first; not traced by lines and arcs."""
    knots = knots_of(sheet.surface)
    flat = FlatStrip(development.pieces, knots)
    strips = Strip(sheet.surface.patches, knots), Strip(sheet.bent.surface.patches, knots_of(sheet.bent.surface))
    outer = _loop(sheet.surface.part.name, trim.outer, flat, strips)
    return (outer, *(_loop(f"hole-{i}", curves, flat, strips) for i, curves in enumerate(trim.inner, 1)))


def net_areas(outer: FlatLoop, inner: Sequence[FlatLoop]) -> Array:
    """Return the areas inside the outer loop without those of the holes: as `FlatLoop.areas`, mm2."""
    return np.asarray(outer.areas - sum(hole.areas for hole in inner))


def knots_of(surface: RuledSurface) -> Values:
    """Return the part's v at the ends of the patches."""
    return np.array([*(float(low) for low, _ in surface.spans), float(surface.spans[-1][1])])


def length_error(loops: Sequence[FlatLoop]) -> Metric:
    """Return the largest relative difference of the length of a loop."""
    errors = {loop.name: abs(float(loop.lengths[1] / loop.lengths[0]) - 1.0) for loop in loops}
    worst = max(errors, key=lambda name: errors[name])
    return Metric("length_error", errors[worst], where={"edge": worst})


def _loop(name: str, curves: Sequence[PlaneCurve], flat: FlatStrip, strips: tuple[Strip, Strip]) -> FlatLoop:
    """Return a loop with its figures; strips: the neutral surface, which the map is of, and the surface as given."""
    edges = images(flat, curves)
    about = edges[0].at(np.zeros(1))[0]
    lengths, areas = np.zeros(2), np.zeros(3)
    for edge in edges:
        breaks, figures = _on_surface(edge, strips[0])
        flat_length, flat_area = _in_plane(edge, breaks, about)
        given = figures[1] if strips[1].patches is strips[0].patches else _on_surface(edge, strips[1])[1][1]
        lengths += np.array([figures[0], flat_length])
        areas += np.array([figures[1], flat_area, given])
    return FlatLoop(name, edges if areas[1] > 0.0 else backwards(edges), lengths, np.abs(areas))


def _on_surface(edge: MappedEdge, strip: Strip) -> tuple[Values, Array]:
    """Return panels that resolve an edge, and its length in mm and swept area in mm2 on a surface.

    All stretches between breaks of the curve are integrated at once, each as a channel of its own.
    """
    stops = edge.breaks
    width = np.diff(stops)
    scale = longest_ruling(strip.patches[0])

    def sample(share: Values) -> Array:
        t = (stops[:-1] + share[:, None] * width).ravel()
        figures = _rates(edge, strip, t) / np.array([1.0, scale])
        channels: Array = (figures.reshape(share.size, width.size, 2) * width[:, None]).reshape(share.size, -1)
        return channels

    shares, values = quadrature.panels(sample, "lengths and area of a trim")
    sums = np.einsum("p,j,pjc->c", np.diff(shares) / 2.0, WEIGHTS, values).reshape(-1, 2).sum(axis=0)
    breaks = (stops[:-1, None] + shares[:-1] * width[:, None]).ravel()
    return np.append(breaks, 1.0), sums * np.array([1.0, scale])


def _rates(edge: MappedEdge, strip: Strip, t: Values) -> Array:
    """Return the rates of length in mm and of swept area in mm2 along an edge on a surface, shape (n, 2)."""
    share = (NODES + 1.0) / 2.0
    inner, width = edge.low + (edge.high - edge.low) * t, edge.high - edge.low
    place, rate = edge.curve.at(inner), width * edge.curve.derivative(inner)
    here, u = jet(strip, place[:, 0], place[:, 1]), place[:, :1]
    speed = norm(rate[:, :1] * here.s_u + rate[:, 1:] * here.s_v)
    # S_v at 16 places of the ruling between the directrix c0 and the edge
    across = (here.s_v - u * here.s_uv)[:, None] + (u * share)[..., None] * here.s_uv[:, None]
    element = norm(np.cross(here.s_u[:, None], across)) @ (WEIGHTS / 2.0)
    return np.stack([speed, element * place[:, 0] * rate[:, 1]], axis=1)


def _in_plane(edge: MappedEdge, breaks: Values, about: Vector2) -> tuple[float, float]:
    """Return the length in mm and the area in mm2 swept about a point of an edge's flat image, from positions alone.

    The panels that resolve the surface's figures serve the positions too, which are as smooth.
    """
    points = edge.at(quadrature.nodes(breaks[:-1], breaks[1:]).ravel()).reshape(breaks.size - 1, -1, 2)
    return swept(points, about)


def with_trim(metrics: tuple[Metric, ...], cut: Trimmed) -> tuple[Metric, ...]:
    """Return the metrics of the patches with lengths and area of the trimmed part in the place of theirs."""
    of_trim = {metric.name: metric for metric in cut.metrics}
    return tuple(of_trim.get(metric.name, metric) for metric in metrics)
