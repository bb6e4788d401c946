"""The last steps before a nest is certified: common lines, if they are asked for, and the order of cutting.

Both depend on where the parts lie and on nothing else, so a stored layout comes out as it went in.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from stages.model.pattern import FlatPattern
from stages.model.report import Metric
from stages.model.sheet import Nesting, NestOptions
from stages.nest.commonlines import aligned, common_line
from stages.nest.layout import as_used
from stages.nest.order import in_cut_order


@dataclass(frozen=True, slots=True)
class Finished:
    """A nest as it will be cut, and what was measured on the way."""

    nesting: Nesting
    metrics: tuple[Metric, ...]


def finished(
    nesting: Nesting, patterns: Sequence[FlatPattern], options: NestOptions, fixed: Nesting | None = None
) -> Iterator[Finished]:
    """Yield a nest in the order of cutting; where common lines are asked for, first with neighbours moved together.

    fixed: placements that stay where they are.
    """
    if options.common_line:
        yield _with_common_lines(nesting, patterns, options, fixed)
    yield Finished(*in_cut_order(nesting, patterns))


def _with_common_lines(
    nesting: Nesting, patterns: Sequence[FlatPattern], options: NestOptions, fixed: Nesting | None
) -> Finished:
    """Return a nest with neighbours moved together."""
    held = {(one.part, one.copy) for layout in (fixed.layouts if fixed else ()) for one in layout.placements}
    closer = aligned(nesting, patterns, options, held)
    layouts = [as_used(layout, patterns, options) for layout in closer.layouts]
    made, metrics = in_cut_order(replace(closer, layouts=tuple(layouts)), patterns)
    return Finished(made, (*metrics, common_line(made, patterns, options)))
