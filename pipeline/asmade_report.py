"""What of a report, and of the side files beside drawings, says how made parts are to be measured.

Only what is needed is read; whatever else is there may change.
"""

import json
from math import pi
from pathlib import Path

import msgspec
from msgspec import Struct, field

from stages.errors import BadInputError, Problem

SCHEMA = "planish-report/1"
ROUND = 1e-6
"""A hole is round if 4 pi A falls short of L^2 by less than this share."""


class Hole(Struct, frozen=True):
    """A hole of a pattern."""

    name: str
    area: float


class Flat(Struct, frozen=True):
    """Figures of a pattern."""

    outline_length: float
    width: float
    height: float
    corners: tuple[tuple[float, float], ...]
    edges: dict[str, float] | None
    holes: tuple[Hole, ...] = ()


class Bend(Struct, frozen=True, rename={"start": "from", "end": "to"}):
    """A bend line."""

    name: str
    angle_deg: float
    fold: bool
    radius_mm: tuple[float | None, float | None]
    start: tuple[float, float]
    end: tuple[float, float]


class Roll(Struct, frozen=True):
    """A station of a roll schedule."""

    radius_mm: tuple[float | None, float | None]
    tool_radius_mm: tuple[float | None, float | None] = (None, None)


class Thickness(Struct, frozen=True):
    """How thick the sheet is and where its neutral line lies."""

    thickness_mm: float | None = None
    k_factor: float | None = None


class Detail(Struct, frozen=True):
    """What unroll says besides."""

    thickness: Thickness = Thickness()
    bends: tuple[Bend, ...] = ()
    rolls: tuple[Roll, ...] = ()


class StageEntry(Struct, frozen=True):
    """A stage of a part."""

    stage: str
    detail: msgspec.Raw = msgspec.Raw(b"{}")


class PartEntry(Struct, frozen=True):
    """A part; `flat` is absent where it was rejected."""

    name: str
    flat: Flat | None = None
    stages: tuple[StageEntry, ...] = ()


class Material(Struct, frozen=True):
    """The sheet."""

    name: str
    thickness_mm: float | None


class Process(Struct, frozen=True):
    """How it was cut."""

    kerf_mm: float | None = None


class Helps(Struct, frozen=True):
    """Whether the contours were written beside the nominal ones."""

    beam_mm: float | None = None
    compensated: bool = False


class Dxf(Struct, frozen=True):
    """How the drawings were written."""

    helps: Helps = Helps()


class Job(Struct, frozen=True):
    """A job."""

    name: str
    digest: str
    material: Material
    process: Process = Process()
    dxf: Dxf = Dxf()


class Report(Struct, frozen=True):
    """What is needed of a report."""

    schema: str
    job: Job
    parts: tuple[PartEntry, ...] = field(default_factory=tuple)


def report_of(file: Path) -> tuple[Report, bytes]:
    """Return a report and its bytes; `BadInputError` if it is none."""
    hint = "give the output folder of a finished job"
    try:
        content = file.read_bytes()
    except OSError as error:
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=hint, file=str(file))) from None
    try:
        report = msgspec.json.decode(content, type=Report)
    except (msgspec.DecodeError, RecursionError) as error:
        message = f"is no report that can be read: {error}"
        raise BadInputError(Problem(message, hint="run the job again with this version", file=str(file))) from None
    if report.schema != SCHEMA:
        raise BadInputError(Problem(f'"{report.schema}" is not the report of a job', "schema", hint, str(file)))
    return report, content


def detail_of(part: PartEntry) -> Detail:
    """Return what unroll says of a part; nothing where it says nothing, as of a mesh."""
    for stage in part.stages:
        if stage.stage == "unroll":
            try:
                return msgspec.json.decode(stage.detail, type=Detail)
            except msgspec.ValidationError:
                return Detail()
    return Detail()


def round_holes(file: Path) -> frozenset[str]:
    """Return the names of the round holes of a pattern, by the side file of its drawing; none if it cannot be read."""
    try:
        contours = json.loads(file.read_bytes())["contours"]
        lacks = {str(one["name"]): 1.0 - 4.0 * pi * one["area_mm2"] / one["length_mm"] ** 2 for one in contours}
    except (OSError, ValueError, KeyError, TypeError, ZeroDivisionError, RecursionError):
        return frozenset()
    return frozenset(name for name, lack in lacks.items() if name and lack < ROUND)
