"""The pattern of a pattern file for a machine that reads none: what the file says by points is drawn out as cuts.

A drill hole becomes a round contour of its diameter; a notch is cut into the outline, or drawn beside it, as in the job
that it comes from.  The outline stays the chords of the file, so a notch stands across the chord that it is in, which
may be turned by as much as chords within the tolerance turn.
"""

from dataclasses import replace
from fractions import Fraction

from pipeline.recalled import circle, spot_of
from stages.errors import BadInputError, Problem
from stages.model.features import NotchSpec
from stages.model.pattern import Contour, Drill, FlatPattern, NotchPlace
from stages.model.scalars import Length
from stages.unroll import outline
from stages.unroll.notches import Notch, cut_into

NO_WIDTH = Length(1)
"""Of a slit, which takes none."""


def drawn_out(pattern: FlatPattern) -> FlatPattern:
    """Return the pattern with nothing said by points; one from a drawing stays as it is.

    Raises BadInputError where a notch cannot be cut into the chords.
    """
    if pattern.outer.traced is None:
        return pattern
    outer = replace(pattern.outer, traced=None)
    made = cut_into(outer, [_notch(one, outer) for one in pattern.notches])
    problems = [Problem(f'"{pattern.part}": {one.message}') for one in made.findings if one.fatal]
    if problems:
        raise BadInputError(*problems)
    return pattern.replace(
        outer=made.outer,
        inner=(*(replace(hole, traced=None) for hole in pattern.inner), *(_hole(one, outer) for one in pattern.drills)),
        marks=(*pattern.marks, *made.lines),
        notches=made.places,
        boundary=made.boundary,
        drills=(),
    )


def _notch(place: NotchPlace, outer: Contour) -> Notch:
    """Return a notch as a job would ask for it."""
    spec = NotchSpec(
        edge="outline",
        kind=place.kind,
        width=Length(Fraction(place.width_mm)) or NO_WIDTH,
        depth=Length(Fraction(place.depth_mm)),
        cut=place.is_cut,
    )
    return Notch(place.name, spec, spot_of(place.at, outer), (0, len(outer.edges)))


def _hole(drill: Drill, outer: Contour) -> Contour:
    """Return a drill hole as a contour."""
    made = outline.contour((circle(drill.at, drill.diameter_mm),), outer.chord_mm, drill.name)
    return replace(made, purpose=drill.purpose)
