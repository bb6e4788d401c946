"""Faces of a CAD file that go over into each other smoothly along straight edges, sorted into strips.

Two faces are joined where they share a whole straight edge that is a ruling of both and lies at an end of both, where
their outward normals agree along it, and where the rulings of both are parallel: planes, cylinders and extrusions.
With d along the rulings and n outwards every face runs along n x d, so that what is the end of one is the beginning of
the other.  A strip has no branches and no rings: of more edges the longest are joined, the rest is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.construct.faces.ruled import Rails, parallel, ruled_form
from stages.construct.faces.strip import NoSeamError, sampled, strip_of
from stages.construct.faces.trim import MEETS
from stages.construct.joins import SMOOTH_RAD
from stages.geometry.arrays import Matrix, Points3, Vector3, cross3, diagonal, norm, unit
from stages.geometry.ruled.nearest import nearest
from stages.geometry.ruled.ruled import RuledPatch
from stages.geometry.ruled.strip import Strip, jet
from stages.model.cadface import CadBody, CadFace, CadPlane, CadSweep
from stages.model.report import Finding

OFF_LINE = 1e-9
"""Share of its length by which an edge may leave the line between its ends, and rad by which it may leave a ruling."""
SENSE = np.array([1.0, 0.6180339887498949, 0.3819660112501051])
"""Of two opposite directions that along this one is taken: across it lies nothing that people draw."""
BEGINNING, END = "beginning", "end"


@dataclass(frozen=True, slots=True)
class Joinable:
    """A face with parallel rulings or none of its own, and its strip if it is curved."""

    face: CadFace
    form: CadPlane | CadSweep
    patches: tuple[RuledPatch, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A straight edge along which two faces (by their place in the file's order) go over into each other.

    ends: shape (2, 3), mm.  direction: along it, of length 1.
    before, after: the face that ends there and the one that begins there.
    """

    before: int
    after: int
    ends: Matrix
    direction: Vector3

    @property
    def length_mm(self) -> float:
        """Return the length of the edge."""
        return float(norm(self.ends[1] - self.ends[0]))


@dataclass(frozen=True, slots=True)
class Blank:
    """Faces that make one blank, in the order of its strip, and what is to be told of it."""

    body: CadBody
    notes: tuple[Finding, ...] = ()


def strips_of(body: CadBody) -> tuple[Blank, ...]:
    """Return the strips and single faces that the faces of a file make, in the order of their first faces."""
    joints, apart = chosen(smooth_joints(body.faces))
    after = {joint.before: joint for joint in joints}
    begun = {joint.after for joint in joints}
    found = []
    for i in range(len(body.faces)):
        if i in begun:
            continue
        run, direction = [i], None
        while run[-1] in after:
            direction = after[run[-1]].direction
            run.append(after[run[-1]].after)
        notes = tuple(
            not_joined(body.faces, (joint.before, joint.after), joint.ends, why)
            for joint, why in apart
            if {joint.before, joint.after} & {*run}
        )
        whole = None if direction is None else (float(direction[0]), float(direction[1]), float(direction[2]))
        found.append((min(run), Blank(CadBody(tuple(body.faces[k] for k in run), whole), notes)))
    return tuple(blank for _, blank in sorted(found, key=lambda pair: pair[0]))


def not_joined(faces: Sequence[CadFace], pair: tuple[int, int], ends: Points3, why: str) -> Finding:
    """Say why two faces that go over into each other are not joined, at the middle of their edge."""
    a, b = sorted(faces[i].index for i in pair)
    message = f"faces {a} and {b} go over into each other {middle_of(ends)} and are not joined: {why}"
    return Finding("not-joined", message, False, {"face": a, "other": b})


def middle_of(ends: Points3) -> str:
    """Return the place of an edge by its ends, for messages."""
    x, y, z = ends.mean(axis=0)
    return f"at ({x:.6g}, {y:.6g}, {z:.6g}) mm"


def chosen(joints: Sequence[Joint]) -> tuple[list[Joint], list[tuple[Joint, str]]]:
    """Return the joints that make strips, the longest first, and the others with the reason."""
    taken: list[Joint] = []
    apart: list[tuple[Joint, str]] = []
    group: dict[int, int] = {}

    def root(i: int) -> int:
        while group.get(i, i) != i:
            i = group[i]
        return i

    for joint in sorted(joints, key=lambda one: (-one.length_mm, one.before, one.after)):
        beside = [one for one in taken if {one.before, one.after} & {joint.before, joint.after}]
        if any(one.before == joint.before or one.after == joint.after for one in beside):
            apart.append((joint, "a strip has no branches"))
        elif any(norm(one.direction - joint.direction) > OFF_LINE for one in beside):
            apart.append((joint, "its rulings would not be parallel"))
        elif root(joint.before) == root(joint.after):
            apart.append((joint, "the ring is cut open there"))
        else:
            group[root(joint.before)] = root(joint.after)
            taken.append(joint)
    return taken, apart


# Which faces meet smoothly


def smooth_joints(faces: Sequence[CadFace]) -> list[Joint]:
    """Return the straight edges along which faces go over into each other."""
    rows = [(i, ends) for i, face in enumerate(faces) for ends in straight_edges(face)]
    if not rows:
        return []
    joinable = {i: joinable_of(faces[i]) for i in sorted({i for i, _ in rows})}
    usable = [(i, ends) for i, ends in rows if joinable[i] is not None]
    found = []
    for a, b in coinciding(usable, faces):
        (i, ends), (j, _) = usable[a], usable[b]
        one, other = joinable[i], joinable[j]
        if one is not None and other is not None and i != j:
            joint = _joint((i, one), (j, other), ends)
            found += [joint] if joint is not None else []
    return found


def straight_edges(face: CadFace) -> list[Matrix]:
    """Return the ends of the straight edges that a face has once, each of shape (2, 3)."""
    found = []
    for loop in face.loops:
        numbers = [edge.number for edge in loop]
        for edge in loop:
            points = edge.curves[0].jet(np.linspace(0.0, 1.0, 9), 0)[0]
            if len(edge.curves) > 1 or numbers.count(edge.number) > 1:
                continue
            if is_straight(points):
                found.append(points[[0, -1]])
    return found


def is_straight(points: Points3) -> bool:
    """Return whether points lie on the line from the first to the last, which is another one."""
    step = points[-1] - points[0]
    off = norm(np.cross(points - points[0], unit(step)))
    return bool(norm(step) > 0.0 and off.max() <= OFF_LINE * norm(step))


def joinable_of(face: CadFace) -> Joinable | None:
    """Return a face as one that can be joined; None if its rulings are not parallel."""
    form = ruled_form(face.surface)
    if isinstance(form, Rails):
        form = parallel(form)
    if isinstance(form, CadPlane):
        return Joinable(face, form, ())
    if not isinstance(form, CadSweep):
        return None
    level = CadSweep(form.profile, along(form.direction))
    try:
        return Joinable(face, level, strip_of(level, face))
    except NoSeamError:
        return None


def along(direction: Vector3) -> Vector3:
    """Return the direction or its opposite: for parallel ones the same."""
    return direction if direction @ SENSE > 0.0 else -direction


def coinciding(rows: Sequence[tuple[int, Matrix]], faces: Sequence[CadFace]) -> list[tuple[int, int]]:
    """Return the pairs of edges with the same ends, either way round."""
    from scipy.spatial import cKDTree

    if not rows:
        return []
    size = {i: MEETS * _size(faces[i]) for i in {i for i, _ in rows}}
    tree = cKDTree(np.array([ends.mean(axis=0) for _, ends in rows]))
    pairs = sorted((int(a), int(b)) for a, b in tree.query_pairs(max(size.values())))
    return [(a, b) for a, b in pairs if _apart(rows[a][1], rows[b][1]) <= max(size[rows[a][0]], size[rows[b][0]])]


def _size(face: CadFace) -> float:
    return diagonal(np.concatenate(sampled(face)))


def _apart(one: Matrix, other: Matrix) -> float:
    """Return how far apart the ends of two edges are, mm, the better way round."""
    return min(float(norm(one - other).max()), float(norm(one - other[::-1]).max()))


def _joint(one: tuple[int, Joinable], other: tuple[int, Joinable], ends: Matrix) -> Joint | None:
    """Return the joint of two faces along an edge; None where they do not go over into each other."""
    direction = along(unit(ends[1] - ends[0]))
    curved = [side.form.direction for _, side in (one, other) if isinstance(side.form, CadSweep)]
    if any(norm(way - direction) > ONE_DIRECTION_RAD for way in curved):
        return None
    direction = curved[0] if curved else direction
    middle = ends.mean(axis=0)
    a, b = (normal_at(side, middle) for _, side in (one, other))
    if np.arctan2(norm(np.cross(a, b)), a @ b) > SMOOTH_RAD:
        return None
    sides = [side_of(side, middle, direction) for _, side in (one, other)]
    if sides == [END, BEGINNING]:
        return Joint(one[0], other[0], ends, direction)
    return Joint(other[0], one[0], ends, direction) if sides == [BEGINNING, END] else None


ONE_DIRECTION_RAD = 1e-7
"""Rulings that differ by less are one direction: what files keep of it."""


def normal_at(side: Joinable, point: Vector3) -> Vector3:
    """Return the outward normal at a point of a face."""
    if isinstance(side.form, CadPlane):
        return side.face.normal
    found = nearest(_strip(side), point).place
    here = jet(_strip(side), found[:1], found[1:])
    normal: Vector3 = unit(cross3(here.s_u, here.s_v))[0]
    return normal


def _strip(side: Joinable) -> Strip:
    return Strip(side.patches, np.arange(len(side.patches) + 1.0))


def side_of(side: Joinable, point: Vector3, direction: Vector3) -> str | None:
    """Return at which end of a face, run along n x d, an edge through a point lies; None inside the face."""
    if isinstance(side.form, CadPlane):
        low, high = run_of(side.face, direction)
        place = float(point @ np.cross(side.face.normal, direction))
        near = MEETS * (high - low)
        return BEGINNING if place <= low + near else END if place >= high - near else None
    v, last = float(nearest(_strip(side), point).place[1]), float(len(side.patches))
    if min(v, last - v) > MEETS * last:
        return None
    # the strip's own p may run against d, and its v with it
    p = side.patches[0].p.jet(np.zeros(1), 0)[0][0]
    return BEGINNING if (v < last / 2.0) == bool(p @ direction > 0.0) else END


def run_of(face: CadFace, direction: Vector3) -> tuple[float, float]:
    """Return from where to where a plane face reaches along n x d, mm."""
    across = np.cross(face.normal, direction)
    reach = np.concatenate([points @ across for points in sampled(face)])
    return float(reach.min()), float(reach.max())
