"""How a call is made for 0, 1, 2, ...: one after the other here, or by several processes (`pipeline.parallel`)."""

from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

T = TypeVar("T")


class Each(Protocol):
    """Makes a call for each number below a count; what comes of them comes in their order."""

    def __call__(self, call: Callable[[int], T], count: int, /) -> Iterable[T]:
        """Return what the calls return, as they are asked for; an error of one is raised when its turn has come."""


def in_turn(call: Callable[[int], T], count: int) -> Iterable[T]:
    """Make the calls one after the other."""
    return map(call, range(count))
