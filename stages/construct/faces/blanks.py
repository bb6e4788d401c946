"""The blanks that the faces of a CAD file make: strips, trees of faces, and single faces.

Faces that go over into each other are one blank as far as they lie flat side by side (`tree`).  Where all their
rulings are parallel and none branches off they are a strip (`chain`), which has the flat frame and the edges of
one; elsewhere a tree, each face unrolled by itself and laid against its neighbour.
"""

from collections.abc import Sequence

from stages.construct.faces.hinges import Meeting, meetings
from stages.construct.faces.joined import ONE_DIRECTION_RAD, Blank, along, middle_of, not_joined, strips_of
from stages.construct.faces.tree import Apart, Grown, grown, in_order, reversed_meeting
from stages.geometry.arrays import Vector3, norm, unit
from stages.model.cadface import CadBody, CadFace, CadJoint
from stages.model.report import Finding


def blanks_of(body: CadBody) -> tuple[Blank, ...]:
    """Return the blanks that the faces of a file make, in the order of their first faces."""
    found, sides = meetings(body.faces)
    tree = grown([one for one in found if not one.why], sides)
    edges = [Apart(one, one.why) for one in found if one.why]
    inside = {i for group in tree.groups for i in group}
    groups = sorted([*tree.groups, *((i,) for i in range(len(body.faces)) if i not in inside)])
    return tuple(_blank(body.faces, group, tree, edges) for group in groups)


def _blank(faces: Sequence[CadFace], group: tuple[int, ...], tree: Grown, edges: Sequence[Apart]) -> Blank:
    """Return the blank of a group of faces with what is to be told of it."""
    crossing = [one for one in tree.apart if {one.meeting.one, one.meeting.other} & {*group}]
    notes = (*(_told(faces, one) for one in crossing), *_edges_told(faces, group, edges))
    if len(group) == 1:
        return Blank(CadBody((faces[group[0]],)), notes)
    hinges = [one for one in tree.hinges if one.one in group]
    closing = [one for one in tree.closing if one.one in group]
    strip = _strip(faces, group, hinges)
    if strip is not None and not closing:
        outwards = [one for one in crossing if not {one.meeting.one, one.meeting.other} <= {*group}]
        others = (*(_told(faces, one) for one in outwards), *_edges_told(faces, group, edges))
        return Blank(strip.body, (*strip.notes, *others))
    return Blank(_branched(faces, group, hinges, closing), notes)


def _strip(faces: Sequence[CadFace], group: tuple[int, ...], hinges: Sequence[Meeting]) -> Blank | None:
    """Return a group as a strip; None where its hinges are not parallel or it branches."""
    directions: list[Vector3] = [along(unit(one.ends[1] - one.ends[0])) for one in hinges]
    if any(float(norm(way - directions[0])) > ONE_DIRECTION_RAD for way in directions):
        return None
    strips = strips_of(CadBody(tuple(faces[i] for i in group)))
    return strips[0] if len(strips) == 1 else None


def _branched(
    faces: Sequence[CadFace], group: tuple[int, ...], hinges: Sequence[Meeting], closing: Sequence[Meeting]
) -> CadBody:
    """Return a group as a tree of faces."""
    order, steps = in_order(group, hinges)
    place = {face: k for k, face in enumerate(order)}
    rings = [one if place[one.one] < place[one.other] else reversed_meeting(one) for one in closing]
    joints = tuple(CadJoint(place[one.one], place[one.other], one.ends) for one in (*steps, *rings))
    return CadBody(tuple(faces[i] for i in order), None, joints)


# Told


def _told(faces: Sequence[CadFace], apart: Apart) -> Finding:
    return not_joined(faces, (apart.meeting.one, apart.meeting.other), apart.meeting.ends, apart.why)


def _edges_told(faces: Sequence[CadFace], group: tuple[int, ...], edges: Sequence[Apart]) -> tuple[Finding, ...]:
    """Say at which other straight edges a blank ends although a face follows there."""
    here = [one for one in edges if {one.meeting.one, one.meeting.other} & {*group}]
    if not here:
        return ()
    named = [
        f"faces {faces[at.one].index} and {faces[at.other].index} {middle_of(at.ends)}: {why}"
        for at, why in ((one.meeting, one.why) for one in here[:MOST_NAMED])
    ]
    more = f"; and at {len(here) - MOST_NAMED} more edges" if len(here) > MOST_NAMED else ""
    first = here[0].meeting
    where: dict[str, float | int | str] = {"face": faces[first.one].index, "other": faces[first.other].index}
    return (Finding("edges-apart", f"not joined are {'; '.join(named)}{more}", False, where),)


MOST_NAMED = 6
"""Edges in a message."""
