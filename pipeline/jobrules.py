"""Rules that the parts of a job keep beside each other: names that stay apart as files, not too many copies."""

from collections import Counter
from collections.abc import Iterator, Sequence
from unicodedata import normalize

from stages.model.caps import MOST_COPIES
from stages.model.curves import Trouble
from stages.model.ducts import is_set
from stages.model.faces import FaceFile
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec


def taken_by_blanks(parts: Sequence[PartSpec]) -> Iterator[Trouble]:
    """Yield the names that a blank of a divided part, or of a set, may take, `<part>.<n>`."""
    divided = {part.name.casefold() for part in parts if _may_divide(part)}
    for i, part in enumerate(parts):
        whole, _, number = part.name.casefold().rpartition(".")
        if number.isdecimal() and whole in divided:
            hint = "choose a name that does not end in a dot and a number"
            yield Trouble(f"part[{i}].name", f'"{part.name}" may be a blank of "{whole}"', hint)


def _may_divide(part: PartSpec) -> bool:
    """Return whether a part may become several blanks."""
    return part.cut == "auto" or is_set(part.surface) or isinstance(part.surface, MeshFile | FaceFile)


def too_many_copies(quantities: Sequence[int]) -> Iterator[Trouble]:
    """Yield the part with which all copies together become too many."""
    total = 0
    for i, quantity in enumerate(quantities):
        if total <= MOST_COPIES < total + quantity:
            message = f"{total + quantity} copies in all"
            yield Trouble(f"part[{i}].quantity", message, f"at most {MOST_COPIES} in one job: divide it")
        total += quantity


def repeated(table: str, key: str, names: Sequence[str]) -> Iterator[Trouble]:
    """Yield the names that are the same as an earlier one, however their letters are put together."""
    seen: Counter[str] = Counter()
    for i, name in enumerate(names):
        seen[alike(name)] += 1
        if seen[alike(name)] > 1:
            yield Trouble(f"{table}[{i}].{key}", f'"{name}" is taken', "upper and lower case count as the same")


def alike(name: str) -> str:
    """Return what is equal for names that look the same but for their case: an e with its accent, and an e and one."""
    return normalize("NFC", normalize("NFD", name).casefold())
