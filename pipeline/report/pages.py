"""Pages put together from a template and blocks: `<!--NAME-->` in a template is where the block of that name stands."""

from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files

ASSETS = files("pipeline") / "data" / "report"


def asset(*names: str) -> str:
    """Return the texts of files of this package, one after the other."""
    return "\n".join((ASSETS / name).read_text(encoding="utf-8") for name in names)


def page(template: str, blocks: Mapping[str, str]) -> bytes:
    """Return a page; template: the name of its file.  A block is put in as it is, and not looked into."""
    head, *rest = asset(template).split("<!--")
    return "".join([head, *_filled(rest, blocks)]).encode()


def _filled(pieces: Sequence[str], blocks: Mapping[str, str]) -> Iterator[str]:
    """Yield the pieces of the template, each behind the block that its comment names."""
    for piece in pieces:
        name, _, after = piece.partition("-->")
        yield blocks[name.strip()]
        yield after
