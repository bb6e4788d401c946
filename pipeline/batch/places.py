"""The place of a job -> the work that is handed to who runs it: its bytes are read again, and must be the same."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import BinaryIO

from pipeline.batch import families
from pipeline.batch.entries import Source, read_some
from pipeline.batch.identity import content
from pipeline.batch.journal import Place
from pipeline.batch.work import Limits, Work
from pipeline.parse import LARGEST_FILE
from stages.errors import BadInputError


class ChangedError(Exception):
    """A file that many jobs come from is not what it was when they were taken in; says which."""


class UnfitError(Exception):
    """A job that no one need run: a row of a table that sets nothing, a file that cannot be read; says why.

    place: its place as found.
    """

    def __init__(self, why: str, place: Place) -> None:
        super().__init__(why)
        self.place = place


@dataclass(slots=True)
class Places:
    """Reads jobs at their places: the file that many come from is opened once, and read where they lie.

    allow: folders that files which a job names may lie in, beside its own.
    """

    allow: Sequence[str]
    limits: Limits
    source: Source | None = None
    stream: BinaryIO | None = None
    tables: dict[Source, families.Table] = field(default_factory=dict)

    def work(self, place: Place, draft: str) -> tuple[Place, Work]:
        """Return a place as found, and the work of the job there; `ChangedError`, `UnfitError`.

        A job file may be another by now than when it was taken in: it is what is found that is run and recorded.
        """
        if place.source.kind == "table":
            return self._row(place, draft)
        if place.source.kind == "lines":
            own = self._read(place)
            if content(own) != place.content:
                raise ChangedError(place.source.path)
            return self._work(place, draft, own, line=place.line)
        found = read_some(place.source.path)
        place = replace(place, content=content(found or b""))
        if found is None:
            raise UnfitError(f"{place.source.path}: cannot be read: there is no plain file", place)
        return self._work(place, draft, found)

    def _row(self, place: Place, draft: str) -> tuple[Place, Work]:
        source = place.source
        if source not in self.tables:
            self.tables = {source: families.table_of(Path(source.path), Path(source.template))}
        table = self.tables[source]
        own = self._read(place)
        if families.content_of(table, own) != place.content:
            raise ChangedError(source.path)
        try:
            settings = families.settings(table.columns, own, table.between, f"{source.path}: row {place.line}")
        except ValueError as error:
            raise UnfitError(str(error), place) from None
        return self._work(place, draft, table.own, settings=settings)

    def _work(
        self, place: Place, draft: str, own: bytes, *, line: int | None = None, settings: tuple[str, ...] = ()
    ) -> tuple[Place, Work]:
        """Return the work, with the bytes that the job is made from; `UnfitError` for too many."""
        file = place.source.template or place.source.path
        if len(own) > LARGEST_FILE:
            raise UnfitError(f"{file}: larger than {LARGEST_FILE // 10**6} MB", place)
        return place, Work(place.name, file, line, own, settings, tuple(self.allow), draft, self.limits)

    def _read(self, place: Place) -> bytes:
        """Return the bytes at a place of a file that many jobs come from."""
        if self.stream is None or self.source != place.source:
            self.close()
            try:
                self.source, self.stream = place.source, open(place.source.path, "rb")  # noqa: PTH123, SIM115
            except OSError:
                raise ChangedError(place.source.path) from None
        self.stream.seek(place.offset)
        return self.stream.read(place.length)

    def close(self) -> None:
        """Close the file that is open."""
        if self.stream is not None:
            self.stream.close()
            self.stream = None


def settings_at(source: Source, offset: int, length: int) -> tuple[str, ...]:
    """Return what a row of a table sets as it is now; nothing for another job, and where the row cannot be read."""
    if source.kind != "table":
        return ()
    try:
        table = families.table_of(Path(source.path), Path(source.template))
        with table.file.open("rb") as stream:
            stream.seek(offset)
            return families.settings(table.columns, stream.read(length), table.between)
    except (OSError, ValueError, BadInputError):
        return ()
