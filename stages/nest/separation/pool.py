"""Layouts that did not quite work out, to go on from: the least bad ones more often."""

from dataclasses import dataclass, field

import numpy as np

from stages.nest.separation.separate import copy_places
from stages.nest.separation.sharing import same_again
from stages.nest.separation.state import Layout

MOST = 50
"""Layouts that are kept."""

BIAS = 0.25
"""Spread of the normal distribution that the place of the next one in the list is drawn from, as a share of it."""


@dataclass(slots=True)
class Pool:
    """Layouts with their overlap, the least first."""

    layouts: list[tuple[float, Layout]] = field(default_factory=list)
    most: int = MOST

    @property
    def least(self) -> float:
        """The least overlap so far."""
        return self.layouts[0][0] if self.layouts else np.inf

    def keep(self, left: float, layout: Layout) -> None:
        """Keep a copy of a layout if it is among the least bad."""
        if len(self.layouts) == self.most and left >= self.layouts[-1][0]:
            return
        self.layouts.append((left, same_again(layout)))
        self.layouts.sort(key=lambda one: one[0])
        del self.layouts[self.most :]

    def take(self, layout: Layout, rng: np.random.Generator) -> None:
        """Copy one of the layouts, if there is any."""
        if self.layouts:
            place = min(int(abs(rng.normal(0.0, BIAS)) * len(self.layouts)), len(self.layouts) - 1)
            copy_places(self.layouts[place][1], layout)

    def clear(self) -> None:
        """Forget all of them."""
        self.layouts.clear()
