"""What the formed part can be coloured by: curvature, strain by bending, strain when laid flat.

A scale ends at a limit that does not depend on what the part reaches, where the material or the class gives one, else
at a round number.  Along a ruling the radius is linear, and so is the radius of the middle of the sheet: curvature and
strain by bending are known there from both ends.

The sheet is bent to k / (1 - k m) about its middle, which lies m from the surface as given towards the side seen flat;
the face that is seen is strained by t/2 of that, pressed where the sheet bends towards it.
"""

from math import floor, inf, log10

import numpy as np

from pipeline.report.document import Document
from pipeline.report.pictures.net import Net
from pipeline.report.pictures.strain import vertex_strains
from pipeline.report.view.arrays import encoded_array
from stages.geometry.arrays import Array, Indices
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.ruled.ruled import curvature
from stages.model.sheetface import about
from stages.model.surface import MeshSurface, RuledSurface

ENDS = np.array([0.0, 1.0])
"""u at both ends of a ruling."""

ROUND = "a round number above the largest halfway along a ruling"


def ruled_fields(surface: RuledSurface, shape: Net) -> list[Document]:
    """Return the fields of a ruled part; strain by bending where the thickness is known."""
    values = curvatures(surface, shape)
    bending = bending_field(surface, values)
    return [curvature_field(values), *([] if bending is None else [bending])]


def patch_of(shape: Net) -> Indices:
    """Return the patch of each ruling of a net."""
    return np.concatenate([[0], np.cumsum(~shape.joined)]).astype(np.int64)


def curvatures(surface: RuledSurface, shape: Net) -> Array:
    """Return the curvature across the rulings at both ends of each, 1/mm, positive towards the side seen flat."""
    patch, values = patch_of(shape), np.zeros((shape.v.size, 2))
    for i, one in enumerate(surface.patches):
        here = patch == i
        local = np.clip(shape.v[here] - i, 0.0, 1.0)
        for side, u in enumerate(ENDS):
            values[here, side] = curvature(one, local, float(u))
    return values


def curvature_field(values: Array) -> Document:
    """Return curvatures as a field."""
    return {
        "name": "curvature",
        "title": "curvature across the rulings",
        "unit": "1/mm",
        "limit": scale_end(halfway(values)),
        "limit_is": ROUND,
        "evidence": "sampled",
        "values": encoded_array(values, "<f4"),
    }


def bending_field(surface: RuledSurface, values: Array) -> Document | None:
    """Return how far the face seen is strained by bending; None where no thickness is known."""
    material = surface.part.material
    if material.thickness_mm is None:
        return None
    strains = bending_strains(values, material.thickness_mm, middle_mm(surface, values))
    allowed = material.max_strain
    return {
        "name": "bending",
        "title": "strain of the face seen, by bending",
        "unit": "1",
        "limit": scale_end(halfway(strains)) if allowed is None else allowed,
        "limit_is": ROUND if allowed is None else "the largest that the material allows",
        "evidence": "sampled",
        "values": encoded_array(strains, "<f4"),
    }


def middle_mm(surface: RuledSurface, values: Array) -> float:
    """Return how far the middle of the sheet lies from the surface as given, mm, towards the side seen flat."""
    known = values[np.isfinite(values)]
    thickness = surface.part.material.thickness_mm or 0.0
    return about(surface.part.spec.face, thickness, towards=float(known.sum()) >= 0.0).middle_mm


def bending_strains(values: Array, thickness: float, middle: float) -> Array:
    """Return the strain of the face seen; without bound where the sheet is too thick for its radius."""
    with np.errstate(divide="ignore", invalid="ignore"):
        room = 1.0 - values * middle
        bent = np.where(np.isfinite(values) & (room > 0.0), values / room, np.copysign(inf, values))
    return np.asarray(-0.5 * thickness * bent + 0.0)


def halfway(ends: Array) -> float:
    """Return the largest size halfway along a ruling of what is the inverse of something linear."""
    size = np.abs(ends)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = 2.0 / (1.0 / size[:, 0] + 1.0 / size[:, 1])
    known = middle[np.isfinite(middle)]
    return float(known.max(initial=0.0))


ROUND_NUMBERS = (1.0, 2.0, 5.0, 10.0)


def scale_end(largest: float) -> float:
    """Return the next of 1, 2, 5 times a power of ten above a value; 1 for none that is above rounding."""
    if not FLAT < largest < inf:
        return 1.0
    power = floor(log10(largest))
    return float(f"1e{power}") * ROUND_NUMBERS[[largest <= one * 10.0**power for one in ROUND_NUMBERS].index(True)]


FLAT = 1e-12
"""Largest curvature, 1/mm, that is rounding: it bends a part of ten metres by less than a tenth of a nanometre."""


def strain_field(surface: MeshSurface, flat: MeshMap, limit: float | None) -> Document:
    """Return at every vertex the principal strain of larger size.

    limit: of strain in its class; without one the scale ends at a round number above the largest.
    """
    values = vertex_strains(surface, flat)
    return {
        "name": "strain",
        "title": "strain when laid flat",
        "unit": "1",
        "limit": limit or scale_end(float(np.abs(values).max())),
        "limit_is": "the largest that its class allows" if limit else "a round number above the largest",
        "evidence": "sampled",
        "values": encoded_array(values, "<f4"),
    }
