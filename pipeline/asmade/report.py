"""The report of a finished job, and the side files beside its drawings, as `compare` reads them."""

import json
from math import pi
from pathlib import Path

import msgspec
from msgspec import Struct

from pipeline.report.shopentries import DetailEntry, JobEntry, PartEntry
from stages.errors import BadInputError, Problem

SCHEMA = "planish-report/1"
ROUND = 1e-6
"""A hole is round if 4 pi A falls short of L^2 by less than this share."""


class Kind(Struct, frozen=True):
    """What a report is one of; read before all else of it."""

    schema: str


class Report(Struct, frozen=True):
    """What is needed of a report."""

    job: JobEntry
    parts: tuple[PartEntry, ...]


def report_of(file: Path) -> tuple[Report, bytes]:
    """Return a report and its bytes; `BadInputError` if it is none."""
    hint = "give the output folder of a finished job"
    try:
        content = file.read_bytes()
    except OSError as error:
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=hint, file=str(file))) from None
    try:
        schema = msgspec.json.decode(content, type=Kind).schema
        if schema != SCHEMA:
            raise BadInputError(Problem(f'"{schema}" is not the report of a job', "schema", hint, str(file)))
        return msgspec.json.decode(content, type=Report), content
    except (msgspec.DecodeError, RecursionError) as error:
        message = f"is no report that can be read: {error}"
        raise BadInputError(Problem(message, hint="run the job again with this version", file=str(file))) from None


def detail_of(part: PartEntry) -> DetailEntry:
    """Return what unroll says of a part; nothing where it says nothing, as of a mesh."""
    return next((stage.detail for stage in part.stages if stage.stage == "unroll"), DetailEntry())


def round_holes(file: Path) -> frozenset[str]:
    """Return the names of the round holes of a pattern, by the side file of its drawing; none if it cannot be read."""
    try:
        contours = json.loads(file.read_bytes())["contours"]
        lacks = {str(one["name"]): 1.0 - 4.0 * pi * one["area_mm2"] / one["length_mm"] ** 2 for one in contours}
    except (OSError, ValueError, KeyError, TypeError, ZeroDivisionError, RecursionError):
        return frozenset()
    return frozenset(name for name, lack in lacks.items() if name and lack < ROUND)
