"""dxfgrabber: entities as they come, those of blocks where the blocks are inserted."""

import json
import sys
from math import radians

import dxfgrabber


def flat(drawing, entities):
    for one in entities:
        if one.dxftype == "INSERT":
            yield from flat(drawing, drawing.blocks[one.name])
        else:
            yield one


def piece(one):
    if one.dxftype in ("CIRCLE", "ARC"):
        angles = {} if one.dxftype == "CIRCLE" else {"from": radians(one.start_angle), "to": radians(one.end_angle)}
        return {"layer": one.layer, "center": list(one.center[:2]), "radius": one.radius, **angles}
    if one.dxftype == "LINE":
        return {"layer": one.layer, "points": [list(one.start[:2]), list(one.end[:2])]}
    points = [list(point[:2]) for point in one.points]
    return {"layer": one.layer, "points": points, "bulges": list(one.bulge), "closed": bool(one.is_closed)}


def answer(file):
    drawing = dxfgrabber.readfile(file)
    entities = list(flat(drawing, drawing.entities))
    return {
        "unit": drawing.header.get("$INSUNITS"),
        "entities": [piece(one) for one in entities if one.dxftype not in ("TEXT", "POINT")],
        "texts": [one.text for one in entities if one.dxftype == "TEXT"],
    }


print(json.dumps({file: answer(file) for file in sys.argv[1:]}))
