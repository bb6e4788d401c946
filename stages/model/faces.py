"""A face of a CAD file as a surface: which file, and which of its faces.

The names of the fields are those of the job file.
"""

from collections.abc import Iterator
from typing import Annotated

from msgspec import Meta

from stages.model.curves import Table, Trouble


class FaceFile(Table, frozen=True, kw_only=True, tag_field="kind", tag="face"):
    """A face of a STEP, IGES or 3DM file, or all of them; its edges trim it, and what is ruled is unrolled exactly.

    index: of the face in the order of the file, from 0; may be left out where there is one only.
    all: every face; those that join smoothly along straight edges make one blank.
    """

    file: Annotated[str, Meta(min_length=1, max_length=500)]
    index: Annotated[int, Meta(ge=0)] | None = None
    all: bool = False

    def troubles(self) -> Iterator[Trouble]:
        """Yield one face asked for beside all of them."""
        if self.index is not None and self.all:
            yield Trouble("index", "beside all = true", "leave one of them out")
