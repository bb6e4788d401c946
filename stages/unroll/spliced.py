"""The contours of faces that lie side by side: their loops joined into one where they share an edge.

Every loop is a ring of edges with the face on its left.  At a shared edge the two rings pass it in opposite ways; it is
taken out of both, and what came before it on the one side is followed by what came after it on the other.  Two rings
become one so, a ring that meets itself becomes two; nothing is cut or approximated.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")
Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Ring(Generic[Key, T]):
    """A closed run of edges; key: what shared edges are named by, the same for the pieces of one that was divided."""

    keys: tuple[Key, ...]
    edges: tuple[T, ...]


def spliced(rings: Sequence[Ring[Key, T]], shared: Sequence[tuple[Key, Key]]) -> list[tuple[T, ...]]:
    """Return the rings that are left when shared edges, by the keys on both sides, are taken out.

    Raises ValueError where an edge is shared that no ring has.
    """
    edges = [edge for ring in rings for edge in ring.edges]
    keys = [key for ring in rings for key in ring.keys]
    following, before = _links(rings)
    gone: set[int] = set()
    for one, other in shared:
        a, b = (_run(keys, before, key) for key in (one, other))
        if not a or not b:
            raise ValueError(f"no ring has the shared edge {one if not a else other}")
        ends = (before[a[0]], following[b[-1]]), (before[b[0]], following[a[-1]])
        for low, high in ends:
            following[low], before[high] = high, low
        gone.update(a, b)
    return _walked(edges, following, gone)


def _links(rings: Sequence[Ring[Key, T]]) -> tuple[list[int], list[int]]:
    """Return for every edge, counted over all rings, the next and the one before."""
    following: list[int] = []
    before: list[int] = []
    for ring in rings:
        first, count = len(following), len(ring.edges)
        following += [first + (i + 1) % count for i in range(count)]
        before += [first + (i - 1) % count for i in range(count)]
    return following, before


def _run(keys: Sequence[Key], before: Sequence[int], key: Key) -> list[int]:
    """Return the pieces of an edge in the order of their ring."""
    found = [i for i, one in enumerate(keys) if one == key]
    first = next((k for k, i in enumerate(found) if before[i] not in found), 0)
    return [*found[first:], *found[:first]]


def _walked(edges: Sequence[T], following: Sequence[int], gone: set[int]) -> list[tuple[T, ...]]:
    """Return what is left, ring by ring."""
    left = [i for i in range(len(edges)) if i not in gone]
    found: list[tuple[T, ...]] = []
    seen: set[int] = set()
    for start in left:
        run: list[T] = []
        at = start
        while at not in seen:
            seen.add(at)
            run.append(edges[at])
            at = following[at]
        if run:
            found.append(tuple(run))
    return found
