"""Problems and layouts as lines of JSON, between the search and the process that does it."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from shapely import Polygon

from stages.nest.separation.problem import Item, Kind, Problem, Spot, polygons
from stages.nest.separation.sampling import Area


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A problem, a layout to start from, and how long to search, on how many cores at most.

    settled: nothing overlaps in the layout; else items in bin -1 lie nowhere yet.
    cost, area, rectangle: of each bin, what it counts, its usable area, and whether its width is to be made small.
    """

    problem: Problem
    start: tuple[Spot, ...]
    settled: bool
    seconds: float
    threads: int
    seed: int
    cost: tuple[float, ...]
    area: tuple[float, ...]
    rectangle: tuple[bool, ...]


def request_line(request: Request) -> bytes:
    """Return a request as one line of JSON."""
    problem = request.problem
    fields = {
        "kinds": [
            {"shape": _rings(kind.shape), "spans": kind.spans, "regions": kind.regions} for kind in problem.kinds
        ],
        "items": [(item.kind, item.other, item.fixed) for item in problem.items],
        "bins": problem.bins,
        "regions": [_rings(region) for region in problem.regions],
        "start": spot_rows(request.start),
        "settled": request.settled,
        "seconds": request.seconds,
        "threads": request.threads,
        "seed": request.seed,
        "cost": request.cost,
        "area": request.area,
        "rectangle": request.rectangle,
    }
    return json.dumps(fields).encode() + b"\n"


def as_request(line: str | bytes) -> Request:
    """Return the request of a line."""
    read: dict[str, Any] = json.loads(line)
    problem = Problem(
        tuple(
            Kind(_polygon(kind["shape"][0]), tuple(_spans(spans) for spans in kind["spans"]), tuple(kind["regions"]))
            for kind in read["kinds"]
        ),
        tuple(Item(kind, other, fixed) for kind, other, fixed in read["items"]),
        tuple((width, height) for width, height in read["bins"]),
        tuple(_area(rings) for rings in read["regions"]),
    )
    start = tuple(as_spot(row) for row in read["start"])
    return Request(
        problem, start, read["settled"], read["seconds"], read["threads"], read["seed"], tuple(read["cost"]),
        tuple(read["area"]), tuple(read["rectangle"]),
    )  # fmt: skip


def spot_rows(spots: Sequence[Spot]) -> list[tuple[int, int, float, float, float]]:
    """Return spots as rows of numbers."""
    return [(spot.bin, spot.kind, spot.angle_deg, spot.x, spot.y) for spot in spots]


def as_spot(row: Sequence[int | float]) -> Spot:
    """Return the spot of a row; ValueError if it is none."""
    bin_, kind, angle, x, y = row
    if not np.isfinite(row).all():
        raise ValueError(f"not finite: {row}")
    return Spot(int(bin_), int(kind), float(angle), float(x), float(y))


def _rings(area: Area) -> list[list[list[tuple[float, float]]]]:
    """Return the rings of all polygons of an area."""
    return [
        [[(float(x), float(y)) for x, y in np.asarray(ring.coords)[:, :2]] for ring in (one.exterior, *one.interiors)]
        for one in polygons(area)
    ]


def _polygon(rings: Sequence[Sequence[Sequence[float]]]) -> Polygon:
    return Polygon(rings[0], rings[1:])


def _area(parts: Sequence[Sequence[Sequence[Sequence[float]]]]) -> Area:
    return shapely.multipolygons([_polygon(rings) for rings in parts]) if len(parts) != 1 else _polygon(parts[0])


def _spans(spans: Sequence[Sequence[float]]) -> tuple[tuple[float, float], ...]:
    return tuple((low, high) for low, high in spans)
