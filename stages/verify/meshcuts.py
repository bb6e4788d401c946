"""Cuts that would bring a mesh within the strain that leather takes: where, and how much strain each would leave.

The end of a cut is put where a conformal map would have to magnify most (`geometry.mesh.scalefactor`); its beginning is
one of several places around the boundary, the nearest among them, along the shortest way.  Each is tried: the mesh is
slit and flattened, and the one that leaves the least strain is kept, its sides made equally long.  Then the next cut is
sought on the mesh with this one, until the limit holds or there are three.  The mesh is tried at full size, so that the
strain told is what verify would find; the larger it is, the fewer places are tried (`BUDGET`).

No search for the best cuts: a start that a tailor may improve on.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Numbers, Points2, Points3, norm
from stages.geometry.mesh.arap import settled
from stages.geometry.mesh.arapkept import settled_with
from stages.geometry.mesh.curvature import defects
from stages.geometry.mesh.cut import along, shortest
from stages.geometry.mesh.flat import by_side, resting
from stages.geometry.mesh.intrinsic import laid
from stages.geometry.mesh.scalefactor import scale_factors
from stages.geometry.mesh.slit import slit
from stages.geometry.mesh.topology import boundary_loops, edge_numbers, edges_of, on_border
from stages.model.report import Finding, Where
from stages.model.surface import MeshSurface, no_pairs
from stages.model.tolerances import STRAIN_LIMIT
from stages.verify.meshbounds import Studied, cell_strains
from stages.verify.meshstudy import ties_of

MOST_CUTS = 3
"""More than a person would sew without drawing a pattern of their own."""
BUDGET = 60_000
"""Triangles that are flattened for one cut, all places tried together: some 4 s."""
MOST_TRIED = 6
"""Places of the boundary where a cut may begin."""
ENOUGH = 5
"""Points by which a cut is told."""
ROUGH = 1e-6
"""How far a trial's last step may move a vertex, as a share of the size: strains to 1e-5."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """A mesh with cuts, flat.

    ways, lines: of the cuts, as vertices of the mesh before and as the points that tell them.
    lengths: of the edges.  strain, largest: the largest strain, and what it may be at most.
    """

    surface: MeshSurface
    ways: tuple[Numbers, ...]
    lines: tuple[Array, ...]
    lengths: Array
    positions: Array
    strain: float
    largest: float


def suggested(surface: MeshSurface, studied: Studied) -> tuple[Finding, ...]:
    """Return the cuts that bring a mesh within the limit of leather, or as near as three do; none if none helps."""
    if not surface.loops:
        return ()
    limit = STRAIN_LIMIT["leather"]
    base = replace(surface, kept=no_pairs())
    flat = studied.flat
    now = _Cut(base, (), (), flat.lengths, flat.positions, *_strain(base, flat.lengths, flat.positions))
    first, opens = now.strain, True
    for _ in range(MOST_CUTS):
        tip, opens_here = _tip(now)
        best = min(_tried(base, flat.lengths, now, tip), key=lambda cut: cut.largest, default=None)
        found = None if best is None else _sewn(best)
        if found is None or found.largest >= now.largest:
            break
        now, opens = found, opens and opens_here
        if now.largest <= limit:
            break
    return (_finding(now, first, opens=opens),) if now.lines else ()


def _strain(surface: MeshSurface, lengths: Array, positions: Points2) -> tuple[float, float]:
    """Return the largest principal strain averaged over cells of triangles, and the largest that it may be."""
    mesh = surface.mesh
    found = cell_strains(resting(mesh, edges_of(mesh), lengths), positions)
    return float(found.size.max()), float((found.size + found.doubt).max())


def _tip(cut: _Cut) -> tuple[int, bool]:
    """Return the vertex inside where a cut does most, and whether it opens there (else its sides overlap)."""
    mesh, edges = cut.surface.mesh, edges_of(cut.surface.mesh)
    inside = (~on_border(mesh, edges)).astype(np.float64)
    found = scale_factors(mesh.faces, laid(by_side(edges, cut.lengths)), defects(mesh, edges, cut.lengths), inside)
    tip = int(np.argmax(np.abs(found)))
    return tip, bool(found[tip] > 0.0)


def _tried(base: MeshSurface, lengths: Array, cut: _Cut, tip: int) -> Iterator[_Cut]:
    """Yield the mesh with one more cut to that end, from several places of the boundary; those that can be made."""
    mesh, edges = cut.surface.mesh, edges_of(cut.surface.mesh)
    loop = base.loops[0]
    taken = np.concatenate([np.zeros(0, dtype=np.int64), *cut.ways, *(s for pair in base.slits for s in pair)])
    taken = np.concatenate([taken, *(side for pair in base.seams for side in pair)])
    nearest = int(np.argmin(norm(mesh.vertices[loop] - mesh.vertices[tip])))
    count = min(MOST_TRIED, max(1, BUDGET // len(mesh.faces)))
    starts = np.roll(loop, -nearest)[np.arange(count) * len(loop) // count]
    for start in starts[~np.isin(starts, taken)]:
        try:
            way = shortest(mesh, edges, np.array([start]), np.array([tip]))
            yield _with(base, lengths, cut, np.round(mesh.vertices[way[_spread(len(way))]], _decimals(base.size_mm)))
        except NoSolutionError:
            continue


def _decimals(size_mm: float) -> int:
    """Return how many decimals of a millimetre tell places to that share of the size."""
    return max(int(np.ceil(DIGITS - np.log10(size_mm))), 0)


DIGITS = 5
"""Decimals of a size of 1: a hundred thousandth is finer than any cloth is marked, and short enough to be typed."""


def _spread(count: int) -> Numbers:
    """Return the numbers of a few points of so many, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, ENOUGH).astype(np.int64))


def _with(base: MeshSurface, known: Array, cut: _Cut, line: Points3) -> _Cut:
    """Return the mesh with a cut along a line besides, flattened.  Raises NoSolutionError where that cannot be done.

    known: the lengths of the edges of the mesh without cuts.
    """
    edges = edges_of(base.mesh)
    way, border = along(base.mesh, edges, line, ()), on_border(base.mesh, edges)
    if not border[way[0]] or border[way[-1]] or any(np.isin(way, other).any() for other in cut.ways):
        raise NoSolutionError("a cut from the boundary inwards that meets no other", reached=0.0, wanted=1.0)
    ways = (*cut.ways, way)
    made = slit(base.mesh, edges, ways)
    after = edges_of(made.mesh)
    lengths = known[edge_numbers(edges, made.original[after.ends])]
    start = np.zeros((len(made.mesh.vertices), 2))
    start[made.mesh.faces] = cut.positions[cut.surface.mesh.faces]
    loops = sorted(boundary_loops(made.mesh, after), key=lambda loop: not np.isin(base.loops[0], loop).any())
    surface = replace(base, mesh=made.mesh, loops=tuple(loops), slits=(*base.slits, *made.sides))
    found = settled(resting(made.mesh, after, lengths), start, still=ROUGH * surface.size_mm).positions
    return _Cut(surface, ways, (*cut.lines, line), lengths, found, *_strain(surface, lengths, found))


def _sewn(cut: _Cut) -> _Cut | None:
    """Return the mesh with the sides of its cuts as long as each other, None where that cannot be had."""
    surface, edges = cut.surface, edges_of(cut.surface.mesh)
    ties = ties_of(surface, edges, cut.lengths)
    rest = resting(surface.mesh, edges, cut.lengths)
    try:
        found = settled_with(rest, cut.positions, ties, still=ROUGH * surface.size_mm).positions
    except NoSolutionError:
        return None
    strain, largest = _strain(surface, cut.lengths, found)
    return replace(cut, positions=found, strain=strain, largest=largest)


def _finding(cut: _Cut, before: float, *, opens: bool) -> Finding:
    """Return the cuts as the job file has them, and what they bring."""
    limit = STRAIN_LIMIT["leather"]
    text = f"[{', '.join(str(line.tolist()) for line in cut.lines)}]"
    count = "a cut" if len(cut.lines) == 1 else f"{len(cut.lines)} cuts"
    message = (
        f"{count} would bring the strain from {before:.3g} to {cut.strain:.3g}, allowed {limit:g}: "
        f"in [part.surface], in mm, cuts = {text}"
        + ("" if cut.strain <= limit else "; give the part a more pointed outline or several pieces besides")
        + (
            ""
            if opens
            else "; in a saddle the sides of a cut overlap when flat: put a gusset or a piece of its own there"
        )
    )
    where: Where = {"cuts": text, "strain": cut.strain, "opens": "yes" if opens else "no"}
    where |= dict(zip("xyz", map(float, cut.lines[0][0]), strict=True))
    return Finding("cut-suggested", message, False, where)
