"""How a part is bent: bend lines for step bending, as a job file asks for them."""

from collections.abc import Iterator
from typing import Annotated

from msgspec import Meta

from stages.model.curves import Table, Trouble, not_positive
from stages.model.scalars import Angle, Length


class BendSpec(Table, frozen=True, kw_only=True):
    """Bend lines at equal turning: steps of at most `max_angle`, or so many that no facet is `facet_error` off."""

    name: Annotated[str, Meta(min_length=1, max_length=80)] = "bend"
    max_angle: Angle | None = None
    facet_error: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield neither or both of max_angle and facet_error, and values that make no bend."""
        if (self.max_angle is None) == (self.facet_error is None):
            yield Trouble("max_angle", "exactly one of max_angle and facet_error", "say how finely the part is bent")
        yield from not_positive(self, "max_angle", "facet_error")
        if self.max_angle is not None and self.max_angle > LARGEST_STEP:
            yield Trouble("max_angle", f"{float(self.max_angle):g} deg", f"at most {LARGEST_STEP} deg in one step")


LARGEST_STEP = 90
"""A step of more, in degrees, would make corners of what is round."""
