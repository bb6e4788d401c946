"""The pattern of a mesh that was not recognised: its flat map, with smooth edges through the corners of its boundary.

    flatten_mesh(certificate, tol) -> Outcome[FlatPattern | None]

The map is the one that `verify` judged.  What is said of it is measured on positions: lengths of the boundary against
cubic splines through the same vertices in space, areas and angles against those of the triangles on the fitted
surface, strains triangle by triangle.  The boundary's own curves are put back (`stages.geometry.refit`), so that arcs
are cut and not facets; how far they leave the polygon, and what they are worth between its points, is told.  Sides of a
cut run straight from end to end: they are congruent, so that their zigzag cancels.

Nothing here is proved, and nothing is better than the mesh: its noise is in every number, in strains most of all.  They
are measured here and not judged; `verify` judged them, over cells of many triangles, with their uncertainty.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry import arcpath, contours
from stages.geometry.arrays import Array, Numbers, Points2, Values, cross2, norm
from stages.geometry.lying import lying
from stages.geometry.meshflat import MeshMap, by_side
from stages.geometry.meshnearest import at
from stages.geometry.meshtopology import edges_of
from stages.geometry.plane import CircularArc, PlaneCurve
from stages.geometry.planespline import spline
from stages.geometry.refit import Refitted, refitted
from stages.model.features import CircleHole, NotchSpec
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Certificate, MeshSurface, Placed
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.features import Features, Flat, assembled
from stages.unroll.limits import overlap, overlap_findings
from stages.unroll.notches import Notch, notched, on_outline
from stages.unroll.plates import rotations

POSITIONS = 1e-9
"""What flat positions are worth without any noise, as a share of the size."""

WITHIN_NOISE = 4.0
"""Standard deviations of the vertices within which points of a boundary count as straight or circular."""


@dataclass(frozen=True, slots=True)
class Loops:
    """The boundary loops in the plane, the outer first: numbers of their vertices, and smooth edges through them."""

    vertices: tuple[Numbers, ...]
    fitted: tuple[Refitted, ...]


def flatten_mesh(certificate: Certificate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the pattern of a mesh in its own frame, or None with the reason.

    Raises NoSolutionError where the arcs do not keep the chord.
    """
    surface, flat = certificate.surface, certificate.flat
    if not isinstance(surface, MeshSurface) or flat is None:
        raise ValueError("a mesh is unrolled with the map that it was judged on")
    rotation, move = lying(flat.positions[surface.loops[0]])
    flat = flat.replace(positions=flat.positions @ rotation.T + move)
    loops = _loops(surface, flat)
    name = surface.part.name
    outer = outline.contour(loops.fitted[0].edges, tol.chord_mm, name)
    holes = tuple(outline.contour(loop.edges, tol.chord_mm, f"hole-{i}") for i, loop in enumerate(loops.fitted[1:], 1))
    covered = overlap(outer)
    made = _features(surface, flat, outer, holes)
    metrics = (*_distortion(surface, flat, loops), covered, *_boundary(loops), *made.metrics)
    findings = (
        *overlap_findings(covered, "along a line, with a seam or in the mesh itself"),
        *_face_findings(surface),
        *made.findings,
    )
    corners = _box(made.outer)
    detail = {"class": certificate.reached} | _figures(surface, flat, made, corners)
    report = StageReport("unroll", name, metrics, findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(_pattern(surface, made, corners, tol), report)


def _loops(surface: MeshSurface, flat: MeshMap) -> Loops:
    """Return the boundary loops without what lies inside the sides of cuts, and smooth edges through them."""
    inside = np.concatenate([np.zeros(0, dtype=np.int64), *(side[1:-1] for pair in surface.seams for side in pair)])
    vertices = tuple(loop[~np.isin(loop, inside)] for loop in surface.loops)
    accuracy = max(WITHIN_NOISE * flat.noise_mm, POSITIONS * surface.size_mm)
    return Loops(vertices, tuple(refitted(flat.positions[loop], accuracy=accuracy) for loop in vertices))


def _distortion(surface: MeshSurface, flat: MeshMap, loops: Loops) -> tuple[Metric, ...]:
    """Return how far the map is from an isometry, by names that are those of every part."""
    strains, at_rest = flat.strains, _areas(_sides(surface, flat))
    worst = np.unravel_index(int(np.argmax(np.abs(strains))), strains.shape)
    face = surface.mesh.faces[int(worst[0])]
    where = dict(zip("xyz", map(float, surface.mesh.vertices[face].mean(axis=0)), strict=True))
    square = np.abs((1.0 + strains) ** 2 - 1.0).max()
    rms = float(np.sqrt(at_rest @ (strains**2).mean(axis=1) / at_rest.sum()))
    return (
        _length_error(surface, flat, loops),
        Metric("area_error", _area_error(surface, flat, at_rest)),
        Metric("angle_error_deg", _angle_error(surface, flat, loops), "deg"),
        Metric("metric_error", float(square)),
        Metric("max_strain", float(np.abs(strains[worst])), where=dict(where)),
        Metric("max_extension", float(max(strains.max(), 0.0))),
        Metric("max_compression", float(max(-strains.min(), 0.0))),
        Metric("strain_rms", rms),
        Metric("flattening_reached_mm", flat.reached_mm, "mm"),
        Metric("strain_energy_mm2", flat.energy_mm2, "mm2"),
    )


def _sides(surface: MeshSurface, flat: MeshMap) -> Array:
    """Return the lengths of the sides of every triangle on the surface, shape (m, 3)."""
    return by_side(edges_of(surface.mesh), flat.lengths)


def _areas(sides: Array) -> Values:
    """Return the areas of triangles from their sides (W. Kahan's order of Heron's formula), mm2."""
    c, b, a = np.sort(sides, axis=1).T
    product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return np.asarray(np.sqrt(np.maximum(product, 0.0)) / 4.0)


def _area_error(surface: MeshSurface, flat: MeshMap, at_rest: Values) -> float:
    """Return the relative difference of the area inside the boundary polygons and that of all triangles at rest."""
    inside = sum(_polygon_area(flat.positions[loop]) for loop in surface.loops)
    return abs(inside / float(at_rest.sum()) - 1.0)


def _polygon_area(points: Points2) -> float:
    about = points - points[0]
    return float(cross2(about, np.roll(about, -1, axis=0)).sum() / 2.0)


def _length_error(surface: MeshSurface, flat: MeshMap, loops: Loops) -> Metric:
    """Return the largest relative difference of the length of a boundary edge, flat against in space."""
    worst, where = 0.0, ""
    for number, (loop, fitted) in enumerate(zip(loops.vertices, loops.fitted, strict=True)):
        for run in _runs(loop, fitted):
            if not _along_mesh(surface, run):
                continue
            in_space, in_plane = (_length(points[run]) for points in (surface.mesh.vertices, flat.positions))
            if abs(in_plane / in_space - 1.0) >= worst:
                worst, where = abs(in_plane / in_space - 1.0), "outline" if number == 0 else f"hole-{number}"
    return Metric("length_error", worst, where={"edge": where} if where else None)


def _runs(loop: Numbers, fitted: Refitted) -> list[Numbers]:
    """Return the vertices along each edge of a refitted loop."""
    ends = [*fitted.at[1:], fitted.at[0] + len(loop)]
    closed = np.concatenate([loop, loop, loop[:1]])
    return [
        closed[low : (high if high > low else high + len(loop)) + 1] for low, high in zip(fitted.at, ends, strict=True)
    ]


def _along_mesh(surface: MeshSurface, run: Numbers) -> bool:
    """Return whether a run of boundary vertices is no side of a cut, which has been made straight."""
    ends = {(int(side[0]), int(side[-1])) for pair in surface.seams for side in pair}
    pair = int(run[0]), int(run[-1])
    return len(run) > len(pair) or not (pair in ends or pair[::-1] in ends)


def _length(points: Array) -> float:
    """Return the length of the cubic spline through points of the plane or of space, mm, by Gauss's rule."""
    from scipy.interpolate import CubicSpline

    if len(points) < LEAST_CURVED:
        return float(norm(np.diff(points, axis=0)).sum())
    chords = norm(np.diff(points, axis=0))
    curve = CubicSpline(np.concatenate([[0.0], np.cumsum(chords)]), points, axis=0)
    nodes, weights = np.polynomial.legendre.leggauss(5)
    low, high = curve.x[:-1, None], curve.x[1:, None]
    speed = norm(curve((low + high) / 2.0 + (high - low) / 2.0 * nodes, 1))
    return float((speed @ weights * (high - low)[:, 0] / 2.0).sum())


LEAST_CURVED = 4
"""Points through which a cubic spline is more than a guess."""


def _angle_error(surface: MeshSurface, flat: MeshMap, loops: Loops) -> float:
    """Return the largest difference of the angle of the part at a corner of its outline, degrees."""
    rest, laid = _angles(_sides(surface, flat)), _angles(_flat_sides(surface, flat))
    count = len(surface.mesh.vertices)
    sums = [np.bincount(surface.mesh.faces.ravel(), angles.ravel(), minlength=count) for angles in (rest, laid)]
    corners = np.concatenate([loop[list(fitted.at)] for loop, fitted in zip(loops.vertices, loops.fitted, strict=True)])
    return float(np.degrees(np.abs(sums[0] - sums[1])[corners].max()))


def _flat_sides(surface: MeshSurface, flat: MeshMap) -> Array:
    corners = flat.positions[surface.mesh.faces]
    return norm(corners - np.roll(corners, -1, axis=1))


def _angles(sides: Array) -> Array:
    """Return the angles at the corners 0, 1, 2 of triangles with sides 01, 12, 20, rad."""
    ab, bc, ca = sides.T
    areas = 4.0 * _areas(sides)
    return np.stack([
        np.arctan2(areas, ab**2 + ca**2 - bc**2),
        np.arctan2(areas, ab**2 + bc**2 - ca**2),
        np.arctan2(areas, bc**2 + ca**2 - ab**2),
    ], axis=1)  # fmt: skip


def _boundary(loops: Loops) -> tuple[Metric, ...]:
    """Return how the smooth edges lie to the polygons of the boundary."""
    return (
        Metric("boundary_sagitta_mm", max(loop.sagitta_mm for loop in loops.fitted), "mm"),
        Metric("boundary_uncertainty_mm", max(loop.uncertainty_mm for loop in loops.fitted), "mm"),
    )


def _face_findings(surface: MeshSurface) -> tuple[Finding, ...]:
    """Say that a mesh is unrolled where it lies, whatever face of the sheet it is."""
    thickness, face = surface.part.material.thickness_mm, surface.part.spec.face
    if face == "middle" or not thickness:
        return ()
    message = (
        f'face = "{face}": a mesh that was not recognised is unrolled where it lies, not on the middle of the sheet; '
        f"give a mesh of the middle, {thickness / 2.0:g} mm away"
    )
    return (Finding("mesh-face", message, fatal=True),)


def _features(surface: MeshSurface, flat: MeshMap, outer: Contour, holes: tuple[Contour, ...]) -> Features:
    """Return holes, marks and notches in the plane."""
    notches = [on_outline(one, one.spec, outer.edges) for one in surface.features if isinstance(one.spec, NotchSpec)]
    found = [_image(surface, flat, one) for one in surface.features if not isinstance(one.spec, NotchSpec)]
    off = [notch for notch in notches if isinstance(notch, Finding)]
    made_outer = notched(outer, [notch for notch in notches if isinstance(notch, Notch)])
    return assembled(surface, made_outer, found, off, holes=holes)


def _image(surface: MeshSurface, flat: MeshMap, one: Placed) -> Flat:
    """Return a feature through the map: a place as a point, with x for a direction, a curve as splines."""
    pieces = [at(surface.mesh, piece, flat.positions) for piece in one.on_mesh]
    x = np.array([1.0, 0.0])
    if len(pieces[0]) > 1:
        return Flat(one, tuple(spline(piece) for piece in pieces))
    middle = pieces[0][0]
    if isinstance(one.spec, CircleHole):
        circle: PlaneCurve = CircularArc(middle, float(one.spec.diameter) / 2.0, 0.0, -2.0 * np.pi)
        return Flat(one, (circle,), middle, x)
    if len(pieces) > 1:
        return Flat(one, (spline(_closed(pieces[1]), periodic=True),), middle, x)
    return Flat(one, (), middle, x)


def _closed(points: Points2) -> Points2:
    """Return points of which the last is the first, to the last bit."""
    closed = points.copy()
    closed[-1] = closed[0]
    return closed


def _box(outer: Contour) -> Points2:
    low_x, low_y, high_x, high_y = arcpath.bounds(outer.path)
    return np.array([[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y]])


def _figures(surface: MeshSurface, flat: MeshMap, made: Features, corners: Points2) -> dict[str, object]:
    """Return the figures of both sides: areas of the triangles on the surface, and of what is cut."""
    width, height = corners[2] - corners[0]
    return {
        "surface": {"area": float(_areas(_sides(surface, flat)).sum()), "edges": None},
        "flat": {
            "area": sum(contours.area(contour.edges) for contour in (made.outer, *made.inner)),
            "outline_length": contours.length(made.outer.edges),
            "width": float(width),
            "height": float(height),
            "corners": corners.tolist(),
            "edges": None,
            "marks": made.mark_rows,
            "holes": made.hole_rows,
        },
        "flattened_on": flat.kind,
    }


def _pattern(surface: MeshSurface, made: Features, corners: Points2, tol: Tolerances) -> FlatPattern:
    spec, material = surface.part.spec, surface.part.material
    return FlatPattern(
        part=spec.name,
        quantity=spec.quantity,
        outer=made.outer,
        inner=made.inner,
        marks=made.marks,
        texts=made.texts,
        label_at=outline.label_place(made.outer.path, tuple(hole.path for hole in made.inner), tol.chord_mm),
        corners=corners,
        rotations=rotations(spec.rotations),
        thickness_mm=material.thickness_mm,
        density_kg_m3=material.density_kg_m3,
    )
