"""Duct and pipe work by the words of the trade: transition, elbow, tee, and the saddle at the end of a pipe.

The names of the fields are those of the job file.  An elbow is a set: several blanks that are welded together.
"""

from collections.abc import Collection, Iterator
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta, field

from stages.model.curves import Table, Trouble, not_positive
from stages.model.scalars import HALF_TURN, RIGHT_ANGLE, Angle, Length


class Transition(Table, frozen=True, kw_only=True, tag_field="kind", tag="transition"):
    """From a rectangle to a round: flat triangles on the sides, oblique cones in the corners.

    rectangle: its sides along x and y, about the origin at z = 0.  round: diameter.  height, offset: of its centre.
    tilt: of the round about y; a positive one lowers its +x side.  The seam is in the middle of the side at +x.
    """

    rectangle: tuple[Length, Length]
    round: Length
    height: Length
    offset: tuple[Length, Length] = field(default_factory=lambda: (Length(0), Length(0)))
    tilt: Angle = field(default_factory=Angle)

    def troubles(self) -> Iterator[Trouble]:
        """Yield sizes that make no duct, and a round that stands upright."""
        yield from not_positive(self, "round", "height")
        for i, side in enumerate(self.rectangle):
            if side <= 0:
                yield Trouble(f"rectangle[{i}]", f"{float(side):g} mm", "must be above 0")
        if abs(self.tilt) >= RIGHT_ANGLE:
            yield Trouble("tilt", f"{float(self.tilt):g} deg", "between -90 and 90 deg")


class Elbow(Table, frozen=True, kw_only=True, tag_field="kind", tag="elbow"):
    """A pipe bend of gores; the two end ones are half gores, so that both ends are square.

    angle: by which the pipe turns, in all.  bend_radius: of the centre line, which the gores touch in their middles.
    seam: where each gore is closed; "staggered": in the throat and at the heel by turns, from the throat on.
    """

    diameter: Length
    angle: Angle
    gores: Annotated[int, Meta(ge=2, le=100)]
    bend_radius: Length
    seam: Literal["staggered", "throat", "heel"] = "staggered"

    @property
    def mitre(self) -> Angle:
        """Return the angle between the end of a gore and a square cut, in degrees."""
        return Angle(self.angle / (2 * (self.gores - 1)))

    def troubles(self) -> Iterator[Trouble]:
        """Yield an angle that no bend has, and gores that have no length in the throat."""
        yield from not_positive(self, "diameter")
        if not 0 < self.angle <= HALF_TURN:
            yield Trouble("angle", f"{float(self.angle):g} deg", "above 0 and at most 180 deg")
        elif self.mitre >= RIGHT_ANGLE:
            yield Trouble("gores", f"{self.gores} gores for {float(self.angle):g} deg", "at least 3")
        if 2 * self.bend_radius <= self.diameter:
            hint = f"above half the diameter, {float(self.diameter / 2):g} mm: the gores end in points there"
            yield Trouble("bend_radius", f"{float(self.bend_radius):g} mm", hint)


class Saddle(Table, frozen=True, kw_only=True):
    """A pipe that crosses at the end of a cylinder, whose rulings stop on it.

    radius: of the crossing pipe.  angle: between its axis and the way back along the rulings; below 90 deg the rulings
    on the side of the directrix's x axis are the short ones.  offset: of its axis, along direction x that x axis.
    """

    radius: Length
    angle: Angle = field(default_factory=lambda: Angle(RIGHT_ANGLE))
    offset: Length = field(default_factory=Length)

    def troubles(self) -> Iterator[Trouble]:
        """Yield a pipe of no radius, and one along the rulings."""
        yield from not_positive(self, "radius")
        yield from _crossing_angle(self.angle)


def _crossing_angle(angle: Fraction) -> Iterator[Trouble]:
    if not 0 < angle < HALF_TURN:
        yield Trouble("angle", f"{float(angle):g} deg", "between 0 and 180 deg")


class Tee(Table, frozen=True, kw_only=True, tag_field="kind", tag="tee"):
    """A branch pipe on a main pipe, whose axis is x; the branch leans towards +x where `angle` is below 90 deg.

    branch, main: diameters.  angle: between the axes.  offset: of the branch's axis, along y.
    length: along the branch's axis, from the main's.  The branch's seam is at its shortest ruling.
    hole: the main's opening as a second blank, a template that is laid around the main: `<part>.1` is the branch then.
    """

    branch: Length
    main: Length
    length: Length
    angle: Angle = field(default_factory=lambda: Angle(RIGHT_ANGLE))
    offset: Length = field(default_factory=Length)
    hole: bool = False

    def troubles(self) -> Iterator[Trouble]:
        """Yield sizes that make no tee."""
        yield from not_positive(self, "branch", "main", "length")
        yield from _crossing_angle(self.angle)


class MainOpening(Table, frozen=True, kw_only=True, tag_field="kind", tag="main-opening"):
    """The second blank of a tee, made from it and not a kind of its own in a job file."""

    tee: Tee


def is_set(surface: Table) -> bool:
    """Return whether a surface takes several blanks, `<part>.<n>`."""
    return blank_count(surface) > 1


def blank_count(surface: Table) -> int:
    """Return how many blanks the surface of a set takes, by what the job file says; 1 of any other."""
    if isinstance(surface, Elbow):
        return surface.gores
    return 2 if isinstance(surface, Tee) and surface.hole else 1


def set_troubles(surface: Table, given: Collection[str], *, matched: bool) -> Iterator[Trouble]:
    """Yield what of a part is not said of the blanks that its surface takes.

    given: keys of what lies somewhere on one of them.  matched: whether holes or notches along their edges must meet.
    """
    for key in given if is_set(surface) else ():
        yield Trouble(key, "which of the blanks is meant is not said", "give that blank as a part of its own")
    if matched and isinstance(surface, Elbow) and surface.seam == "staggered":
        message = "edges of staggered gores begin half a turn apart: their holes and notches would not meet"
        yield Trouble("surface.seam", message, 'seam = "throat" or "heel"')
