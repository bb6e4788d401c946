"""dxf2gcode's import of DXF: lines and arcs of each layer, in the unit that it finds.  For Debian's own Python."""

import json
import sys
from types import SimpleNamespace

import dxf2gcode.globals.globals as g
from dxf2gcode.dxfimport.importer import ReadDXF

INCH, MILLIMETRE = 1, 4
g.quiet = True
g.config = SimpleNamespace(
    metric=1,
    update_tool_values=lambda: None,
    fitting_tolerance=0.001,
    point_tolerance=0.001,
    vars=SimpleNamespace(Import_Parameters={"spline_check": 3}),
)


def piece(layer, one):
    if not hasattr(one, "r"):
        return {"layer": layer, "points": [[one.Ps.x, one.Ps.y], [one.Pe.x, one.Pe.y]]}
    sense = 1.0 if one.ext > 0.0 else -1.0
    round_one = {"layer": layer, "center": [one.O.x, one.O.y], "radius": one.r, "turn": sense}
    return {**round_one, "from": one.s_ang, "to": one.s_ang + one.ext}


def flat(drawing, entities):
    blocks = {block.Name: block.geo for block in drawing.blocks.Entities}
    for entity in entities:
        if entity.Typ == "Insert":
            yield from flat(drawing, blocks[entity.BlockName])
        else:
            yield entity


def answer(file):
    drawing = ReadDXF(file)
    pieces = [
        piece(drawing.layers[entity.Layer_Nr].name, one)
        for entity in flat(drawing, drawing.entities.geo)
        for one in entity.geo
        if hasattr(one, "Pe")
    ]
    return {"unit": MILLIMETRE if g.config.metric else INCH, "entities": pieces}


print(json.dumps({file: answer(file) for file in sys.argv[1:]}))
