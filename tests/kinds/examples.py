"""One irregular example of every kind of surface, its edges restated in 40 digits by other formulas than the program's.

Directrices are uneven: control points close together, weights, inflections, planes at a slant.
"""

from tests.kinds import bands, ducts, paper, plain
from tests.kinds.example import Example

EXAMPLES: dict[str, Example] = {
    "quintic-ruled": Example(paper.quintic_ruled, paper.ruled_pairs, proved=True),
    "quintic-planar": Example(paper.quintic_planar, paper.planar_pairs, proved=True),
    "quintic-cylinder": Example(paper.quintic_cylinder, lambda: [[paper.cylinder_pair()]], proved=True),
    "quintic-cone": Example(paper.quintic_cone, paper.cone_pairs, proved=True),
    "quintic-strip": Example(paper.quintic_strip, paper.strip_pairs, proved=True),
    "ruled": Example(plain.ruled, plain.ruled_pairs, proved=True),
    "cone": Example(plain.cone, plain.plain_cone_pairs, proved=True),
    "cylinder": Example(plain.cylinder, plain.cylinder_pairs, proved=True),
    "bezier-pair": Example(plain.bezier_pair, plain.pair_pairs, proved=True),
    "tangent": Example(plain.tangent, plain.tangent_pairs, proved=False),
    "slope": Example(plain.slope, plain.slope_pairs, proved=False),
    "strap": Example(bands.strap, bands.strap_pairs, proved=False),
    "ribbon": Example(bands.ribbon, bands.ribbon_pairs, proved=False),
    "rails": Example(ducts.rails, ducts.rails_pairs, proved=False),
    "transition": Example(ducts.transition, ducts.transition_pairs, proved=False),
    "elbow": Example(ducts.elbow, ducts.elbow_pairs, proved=False),
    "tee": Example(ducts.tee, ducts.tee_pairs, proved=False),
    "strip": Example(ducts.strip, ducts.pieces_pairs, proved=True),
}
