"""What else lays a developable flat: triangle strips, libigl's maps of a mesh, and the equations of development.

libigl's least squares conformal map, its as-rigid-as-possible map and SLIM lay out the polyhedron of the chords.  A
triangle strip and the differential equations know the rulings, which no mesh tells.  Each as its documentation shows
it.
"""

from collections.abc import Callable

import igl
import numpy as np
from scipy.integrate import solve_ivp

from stages.geometry.arrays import Array, Points2, Points3, Values, cross3, dot, norm
from stages.geometry.mesh.flat import flattened
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.ruled import RuledPatch

ROUNDS = 100
"""Of libigl's local and global steps: more do not change the first two digits."""
STEPS = 20
"""Of SLIM."""
STILL = 1e-10
"""Of the size: where our iteration ends."""
TIGHT = 1e-13
"""The least relative tolerance of the integrator that is above its rounding."""

Method = Callable[[Mesh], Points2]


def planish(mesh: Mesh) -> Points2:
    """Our map of a mesh that nothing explains."""
    return flattened(mesh, accuracy=STILL * float(norm(np.ptp(mesh.vertices, axis=0)))).positions


def conformal(mesh: Mesh) -> Points2:
    """libigl's least squares conformal map, as large as the mesh."""
    loop = max(igl.boundary_loop_all(mesh.faces), key=len)
    held = np.array([loop[0], loop[len(loop) // 2]])
    far = float(norm(mesh.vertices[held[1]] - mesh.vertices[held[0]]))
    made = igl.lscm(np.array(mesh.vertices), np.array(mesh.faces), held, np.array([[0.0, 0.0], [far, 0.0]]))[0]
    a, b, c = (made[mesh.faces[:, k]] for k in range(3))
    flat = np.linalg.det(np.stack([b - a, c - a], axis=1)).sum() / 2.0
    p, q, r = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    whole = norm(np.cross(q - p, r - p)).sum() / 2.0
    return np.asarray(made * [1.0, np.sign(flat)] * np.sqrt(whole / abs(flat)))


def rigid(mesh: Mesh) -> Points2:
    """libigl's as-rigid-as-possible map from its conformal one."""
    state, start = igl.ARAPData(), conformal(mesh)
    state.max_iter, state.energy = ROUNDS, igl.ARAPEnergyType.ARAP_ENERGY_TYPE_ELEMENTS
    igl.arap_precomputation(np.array(mesh.vertices), np.array(mesh.faces), 2, np.zeros(1, dtype=np.int32), state)
    return np.asarray(igl.arap_solve(start[:1], state, start))


def slim(mesh: Mesh) -> Points2:
    """libigl's scalable locally injective map, of symmetric Dirichlet energy, from its conformal one."""
    vertices, faces, start = (
        np.asfortranarray(x) for x in (mesh.vertices, mesh.faces.astype(np.int32), conformal(mesh))
    )
    none, nowhere = np.zeros(0, dtype=np.int32), np.zeros((0, 2), order="F")
    state = igl.slim_precompute(vertices, faces, start, igl.MappingEnergyType.SYMMETRIC_DIRICHLET, none, nowhere, 0.0)
    return np.asarray(igl.slim_solve(state, STEPS)[:, :2])


LIBIGL: dict[str, Method] = {"libigl LSCM": conformal, "libigl ARAP": rigid, "libigl SLIM": slim}


def zigzag(rulings: int) -> tuple[Values, Values]:
    """Return u and v of the corners of a triangle strip: from side to side, ruling after ruling."""
    return np.tile([0.0, 1.0], rulings), np.repeat(np.linspace(0.0, 1.0, rulings), 2)


def in_space(patch: RuledPatch, u: Values, v: Values) -> Points3:
    """Return points of a patch."""
    points: Points3 = patch.c0.jet(v, 0)[0] + u[:, None] * patch.p.jet(v, 0)[0]
    return points


def triangle_strip(corners: Points3) -> Points2:
    """Lay out a zigzag of points, each by its distances from the two before it, triangle by triangle."""
    far, further = norm(np.diff(corners, axis=0)), norm(corners[2:] - corners[:-2])
    flat = np.zeros((len(corners), 2))
    flat[1, 0] = far[0]
    for i in range(2, len(corners)):
        way = (flat[i - 1] - flat[i - 2]) / far[i - 2]
        along = (far[i - 2] ** 2 + further[i - 2] ** 2 - far[i - 1] ** 2) / (2.0 * far[i - 2])
        up = np.sqrt((further[i - 2] - along) * (further[i - 2] + along)) * (1.0 if i % 2 else -1.0)
        flat[i] = flat[i - 2] + along * way + up * np.array([-way[1], way[0]])
    return flat


def by_equations(patch: RuledPatch, u: Values, v: Values) -> Points2:
    """Return the flat S(u, v) by the equations of development, integrated by DOP853.

    The tangent of c0 turns by its geodesic curvature, theta' = (c0' x c0'') . n / |c0'|^2, and c0 runs along it; the
    ruling lies at the angle that it has with the tangent in space.
    """
    places, back = np.unique(v, return_inverse=True)

    def slope(at: float, state: Array) -> tuple[float, float, float]:
        place = np.array([at])
        _, (d1,), (d2,) = patch.c0.jet(place, 2)
        normal = np.cross(patch.p.jet(place, 0)[0][0], d1)
        speed = float(np.sqrt(d1 @ d1))
        turn = float(np.cross(d1, d2) @ normal) / (float(np.sqrt(normal @ normal)) * speed**2)
        return turn, speed * np.cos(state[0]), speed * np.sin(state[0])

    size = float(norm(np.ptp(in_space(patch, u, v), axis=0)))
    start = [float(_between(patch, np.zeros(1))[0]), 0.0, 0.0]
    limits = TIGHT * np.array([1.0, size, size])
    found = solve_ivp(slope, (0.0, 1.0), start, method="DOP853", rtol=TIGHT, atol=limits, t_eval=places)
    theta, x, y = found.y[:, back]
    phi, reach = theta - _between(patch, v), u * norm(patch.p.jet(v, 0)[0])
    return np.column_stack([x + reach * np.cos(phi), y + reach * np.sin(phi)])


def _between(patch: RuledPatch, v: Values) -> Values:
    """Return the angle from the ruling to the tangent of c0, counter-clockwise in the flat, rad."""
    tangent, ruling = patch.c0.jet(v, 1)[1], patch.p.jet(v, 0)[0]
    return np.asarray(np.arctan2(norm(cross3(ruling, tangent)), dot(ruling, tangent)))
