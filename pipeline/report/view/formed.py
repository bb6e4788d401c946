"""The formed part for the view of the report that can be turned: two rails and the rulings between, or triangles.

A ruled part is known by both ends of its rulings in space and flat, as all that is shown is linear along a ruling; the
page makes the points between.  A mesh, and a part of several faces, is its triangles.  What it can be coloured by is in
`fields`.

`deviation_mm` says how far what is shown is from the surface (sampled): halfway between rulings, halfway across a cell
along its shorter diagonal, and the rounding of the positions.  For looking at, not for measuring.
"""

import numpy as np

from pipeline.report.document import Document, class_of
from pipeline.report.pictures.branched import as_mesh
from pipeline.report.pictures.edges import flat_pieces
from pipeline.report.pictures.mesh import mesh_view
from pipeline.report.pictures.net import Net, net, view_direction
from pipeline.report.view.arrays import encoded_array, encoded_numbers, encoded_points, rounding_mm
from pipeline.report.view.cells import COLUMNS, cells
from pipeline.report.view.fields import ENDS, patch_of, ruled_fields, strain_field
from pipeline.report.view.lines import Lines, lines_on, trim_rings
from pipeline.run import PartRun
from stages.geometry.arrays import Array, norm
from stages.geometry.flat.mapped import FlatStrip, MappedEdge
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.ruled.ruled import at
from stages.model.pattern import FlatPattern
from stages.model.surface import BranchedSurface, Certificate, MeshSurface, RuledSurface
from stages.model.tolerances import STRAIN_LIMIT


def formed(run: PartRun, worst_v: float | None = None) -> Document | None:
    """Return the formed part of a run for the page; None for a plate, and where nothing was constructed.

    worst_v: the ruling to be pointed out, v counted over the patches.
    """
    surface = run.surface
    if isinstance(surface, RuledSurface) and surface.patches:
        return ruled_part(surface, run.pattern, worst_v)
    if isinstance(surface, BranchedSurface):
        return triangles(as_mesh(surface), None, None)
    if not isinstance(surface, MeshSurface):
        return None
    judged = [step.product.flat for step in run.steps if isinstance(step.product, Certificate)]
    return triangles(surface, judged[0] if judged else None, STRAIN_LIMIT_BY_NAME.get(class_of(run)))


STRAIN_LIMIT_BY_NAME: dict[str, float] = {str(name): limit for name, limit in STRAIN_LIMIT.items()}


def ruled_part(surface: RuledSurface, pattern: FlatPattern | None, worst_v: float | None) -> Document:
    """Return a ruled part: its rails in space and flat, what is left of the net, lines and curvature."""
    shape = net(surface, worst_v)
    rails = shape.points[:, [0, -1]]
    flat = None if pattern is None else flat_rails(shape, pattern)
    lines = lines_on(shape, flat, pattern)
    return {
        "kind": "ruled",
        **view_of(view_direction(shape), rounding_mm(rails) + sagitta_mm(surface, shape)),
        **encoded_points(rails),
        "flat": None if flat is None else encoded_points(flat),
        "v": encoded_array(shape.v, "<f4"),
        "breaks": np.flatnonzero(~shape.joined).tolist(),
        "rulings": shape.rulings.tolist(),
        "worst": shape.worst,
        "cells": _cells(surface, shape, lines),
        "outlines": [_places(ring) for ring in trim_rings(surface, shape)],
        "lines": [{"kind": one.kind, "name": one.name, "places": _places(one.places)} for one in lines],
        "fields": ruled_fields(surface, shape),
    }


def view_of(frame: Array, deviation_mm: float) -> Document:
    """Return the first view (right, up, towards the viewer), and how far what is shown is from the surface."""
    return {"frame": frame.tolist(), "deviation_mm": deviation_mm, "evidence": "sampled"}


def _places(ring: Array) -> str:
    return encoded_array(ring, "<f4")


def _cells(surface: RuledSurface, shape: Net, lines: Lines) -> Document | None:
    """Return what is left of the net; None where all is."""
    rings = trim_rings(surface, shape)
    holes = [one.places for one in lines if one.kind == "hole"] or rings[1:]
    if not rings and not holes:
        return None
    left = cells(rings[0] if rings else None, holes, shape.joined)
    bits = np.packbits(left.whole.astype(np.bool_).ravel(), bitorder="little").astype(np.int64)
    return {"whole": encoded_array(bits, "u1"), "corners": _places(left.corners)}


def flat_rails(shape: Net, pattern: FlatPattern) -> Array | None:
    """Return both ends of the rulings in the flat frame, shape (n, 2, 2), mm; None where the pattern holds no map."""
    mapped = [edge.strip for edge in pattern.outer.edges if isinstance(edge, MappedEdge)]
    pieces = mapped[0].pieces if mapped else tuple(flat_pieces(pattern))
    patch = patch_of(shape)
    if len(pieces) != patch[-1] + 1:
        return None
    strip = FlatStrip(pieces, np.arange(len(pieces) + 1.0))
    flat = np.zeros((shape.v.size, 2, 2))
    for i, piece in enumerate(strip.pieces):
        local = np.clip(shape.v[patch == i] - i, 0.0, 1.0)
        flat[patch == i] = np.stack([piece.positions(np.full_like(local, u), local) for u in ENDS], axis=1)
    return flat


def sagitta_mm(surface: RuledSurface, shape: Net) -> float:
    """Return how far cells are from the surface: at the rails halfway between rulings, and by their own twist."""
    patch = patch_of(shape)[:-1][shape.joined]
    middle = ((shape.v[1:] + shape.v[:-1]) / 2.0)[shape.joined]
    rails = shape.points[:, [0, -1]]
    chords = ((rails[1:] + rails[:-1]) / 2.0)[shape.joined]
    off = 0.0
    for i, one in enumerate(surface.patches):
        here = patch == i
        for side, u in enumerate(ENDS):
            there = at(one, np.full(int(here.sum()), u), middle[here] - i)
            off = max(off, float(norm(there - chords[here, side]).max(initial=0.0)))
    return off + float(np.abs(_twists(rails)[shape.joined]).max(initial=0.0)) / (4.0 * COLUMNS)


def _twists(rails: Array) -> Array:
    """Return by how much the four corners between two rulings fail to be a plane's, across the cell, mm."""
    twist = rails[1:, 1] - rails[1:, 0] - rails[:-1, 1] + rails[:-1, 0]
    across = np.cross(rails[1:, 1] - rails[:-1, 0], rails[1:, 0] - rails[:-1, 1])
    tiny = np.finfo(np.float64).tiny
    found: Array = np.sum(twist * across, axis=1) / np.maximum(norm(across), tiny)
    return found


def triangles(surface: MeshSurface, flat: MeshMap | None, limit: float | None) -> Document:
    """Return a part as its triangles, its edges and cuts as chains of vertices, and the strain of its flattening.

    limit: of strain in its class; without one the scale ends at a round number above the largest.
    """
    vertices = surface.mesh.vertices
    cuts = [side for pair in (*surface.seams, *surface.slits) for side in pair]
    return {
        "kind": "mesh",
        **view_of(mesh_view(surface), rounding_mm(vertices)),
        **encoded_points(vertices),
        "flat": None if flat is None else encoded_points(flat.positions),
        "triangles": encoded_numbers(surface.mesh.faces),
        "outlines": [encoded_numbers(np.append(loop, loop[:1])) for loop in surface.loops],
        "seams": [encoded_numbers(cut) for cut in cuts],
        "fields": [] if flat is None else [strain_field(surface, flat, limit)],
    }
