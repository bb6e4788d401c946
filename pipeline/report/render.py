"""The report in the formats that people and other programs read, made from `report.json` and what lies beside it.

A format is one function: it takes a finished job and returns its files by their paths below the output folder.  It
sees the report as JSON has it and not what was computed on the way, so that `planish run` and `planish report` give the
same bytes, and no number stands in a format that is not in the report.

A report of jobs that were nested together (planish-pool/1) is rendered group by group, each into its own folder, as
the report of a job whose parts have neither stages nor figures of their surface.
"""

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from pipeline.store import POOL_SCHEMA

Report = Mapping[str, object]
FOLDER = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*")
"""What a group may be called: its files go to a folder of that name, and nowhere else."""


@dataclass(frozen=True, slots=True)
class Made:
    """A finished job: its report as JSON has it, and the files beside it by their paths, read when asked for."""

    report: Report
    files: Mapping[str, bytes]


Format = Callable[[Made], dict[str, bytes]]


def _csv(made: Made) -> dict[str, bytes]:
    from pipeline.report.results import results_csv

    return {"results.csv": results_csv(made.report)}


def _junit(made: Made) -> dict[str, bytes]:
    from pipeline.report.junit import junit_xml

    return {"junit.xml": junit_xml(made.report)}


def _html(made: Made) -> dict[str, bytes]:
    if "view.json" not in made.files:
        return {}
    from pipeline.report.html import report_pages

    return report_pages(dict(made.report), dict(as_json_has_it(made.files["view.json"])))


def _traveller(made: Made) -> dict[str, bytes]:
    if "view.json" not in made.files:
        return {}
    from pipeline.report.traveller.book import traveller_pdf

    return {"traveller.pdf": traveller_pdf(made)}


FORMATS: dict[str, Format] = {"csv": _csv, "junit": _junit, "html": _html, "traveller": _traveller}
"""Formats by their names in the job file; what one needs is imported when it is asked for."""


def rendered(made: Made, also: Iterable[str] = (), skipped: Iterable[str] = ()) -> dict[str, bytes]:
    """Return the files of the formats that the job asked for, of others, without those skipped; no json, no png."""
    return {path: content for files in by_format(made, also, skipped).values() for path, content in files.items()}


def by_format(made: Made, also: Iterable[str] = (), skipped: Iterable[str] = ()) -> dict[str, dict[str, bytes]]:
    """Return the same, format by format; one that lacks what it needs beside the report has no files."""
    every: dict[str, dict[str, bytes]] = {}
    for prefix, one in each(made):
        wanted = {*_asked_for(one.report), *also} - {*skipped}
        for name in (name for name in FORMATS if name in wanted):
            made_of = FORMATS[name](one)
            every.setdefault(name, {}).update({f"{prefix}{path}": content for path, content in made_of.items()})
    return every


def _asked_for(report: Report) -> Iterable[str]:
    """Return the formats that a job asked for; all where its report is of a time before it said so."""
    job = report["job"]
    asked = job.get("formats") if isinstance(job, Mapping) else None
    return asked if isinstance(asked, list) else FORMATS


def as_json_has_it(encoded: bytes) -> Report:
    """Return a report from its bytes."""
    report = json.loads(encoded)
    if not isinstance(report, dict):
        raise ValueError("a report is an object")
    return report


def each(made: Made) -> Iterator[tuple[str, Made]]:
    """Yield what is rendered by itself, each with the folder that it goes to: the job, or the groups of a pool.

    Raises `TypeError` or `ValueError` for groups that are none.
    """
    if not str(made.report["schema"]).startswith(POOL_SCHEMA):
        yield "", made
        return
    for group in _listed(made.report, "groups"):
        name = str(group["name"])
        if not FOLDER.fullmatch(name):
            raise ValueError(f"the group {name!r} is no folder")
        prefix = f"{name}/"
        yield prefix, Made(_of_group(made.report, group), _Below(made.files, prefix))


def _of_group(report: Report, group: Report) -> Report:
    """Return a group of a pool as the report of a job."""
    known: Report = {"class": None, "flat": None, "surface": None, "stages": []}
    material = {"name": group["material"], "thickness_mm": group["thickness_mm"]}
    job = {"name": group["name"], "material": material, "notes": group["notes"], "formats": group.get("formats")}
    return {
        "schema": report["schema"],
        "status": group["status"],
        "job": job,
        "parts": [{**known, **part} for part in _listed(group, "parts")],
        "nest": group["nest"],
        "write": group["write"],
        "run": report["run"],
    }


def _listed(within: Report, key: str) -> list[Report]:
    """Return a list of objects of a report."""
    found = within[key]
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise TypeError(f"{key} is no list of objects")
    return found


class _Below(Mapping[str, bytes]):
    """The files below a folder, by their paths there."""

    def __init__(self, files: Mapping[str, bytes], prefix: str) -> None:
        self._files, self._prefix = files, prefix

    def __getitem__(self, path: str) -> bytes:
        return self._files[self._prefix + path]

    def __iter__(self) -> Iterator[str]:
        return (path.removeprefix(self._prefix) for path in self._files if path.startswith(self._prefix))

    def __len__(self) -> int:
        return sum(1 for _ in self)
