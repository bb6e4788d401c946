"""A report and what is drawn of it, small enough to be known by heart: for the tests of the page.

Three parts: a strained strip whose name is markup, a plate with a round end that failed, and one without a pattern.
"""

from pathlib import Path

import numpy as np

from pipeline.report.document import Document
from pipeline.report.html import report_html
from stages.geometry.arrays import Array

HOSTILE = '<script>document.title="taken"</script><img src=x onerror=alert(1)> =cmd()"\u2028'
PLATE, REFUSED = "plate äöü", "x" * 300
LIMIT = 0.005
WIDE, HIGH = 200.0, 100.0
U, V = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 13)
X, Y = np.meshgrid(U * WIDE, V * HIGH)
MOST = LIMIT * 1.3 * np.sin(np.pi * (X / WIDE - 0.5)) * (0.4 + Y / HIGH)
LEAST = MOST / 4.0
VALUE = np.where(MOST + LEAST >= 0.0, MOST, LEAST)
RULINGS = [[0.0, y, WIDE, y + 7.0, y / HIGH] for y in (11.0, 33.0, 61.0, 83.0)]


def metric(name: str, value: object, limit: object = None, *, passed: bool = True) -> Document:
    """Return a metric as the report has it."""
    return {
        "name": name,
        "value": value,
        "unit": "",
        "evidence": "sampled",
        "limit": limit,
        "pass": passed,
        "where": None,
    }


def path(*points: tuple[float, float, float]) -> Document:
    """Return a closed path of x, y and bulge."""
    return {"closed": True, "points": np.ravel(points).tolist(), "name": "", "purpose": "cut"}


def part(name: str, stages: list[Document], reached: str) -> Document:
    """Return a part of a report."""
    flat = {"width": WIDE, "height": HIGH, "area": WIDE * HIGH}
    return {"name": name, "quantity": 1, "class": reached, "flat": flat, "surface": None, "mass_kg": 0.25,
            "cut_length_mm": 600.0, "pierces": 1, "stages": stages}  # fmt: skip


def stage(name: str, metrics: list[Document], **more: object) -> Document:
    """Return a stage of a part."""
    status = "pass" if all(one["pass"] for one in metrics) else "fail"
    return {"stage": name, "status": status, "metrics": metrics, "findings": [], **more}


def field() -> Document:
    """Return the strain field of the strip."""
    grids = {"x": X, "y": Y, "most": MOST, "least": LEAST}
    return {"u": U.tolist(), "v": V.tolist(), **{name: grid.tolist() for name, grid in grids.items()}}


def report() -> Document:
    """Return a report of the three parts on one sheet."""
    strained = stage("unroll", [metric("max_strain", 0.0065, LIMIT)], detail={"strain_field": field()})
    failed = stage("verify", [metric("max_warp_deg", 0.1), metric("outer_fibre_strain", 0.3, 0.25, passed=False)])
    refused = {"stage": "construct", "status": "fail", "metrics": [],
               "findings": [{"code": "no-solution", "message": HOSTILE, "fatal": True,
                             "where": {"v": 0.5}}]}  # fmt: skip
    places = [{"part": HOSTILE, "copy": 1, "x": 10.0, "y": 10.0, "angle": 0.0, "mirrored": False},
              {"part": PLATE, "copy": 1, "x": 480.0, "y": 20.0, "angle": 90.0, "mirrored": True}]  # fmt: skip
    sheet = {"stock": "s", "index": 1, "utilisation": 0.4, "file": "cut/s-1.dxf", "mass_kg": None,
             "cut_length_mm": 900.0, "pierces": 2, "cost": None, "offcut": None, "placements": places}  # fmt: skip
    stock = {"id": "s", "kind": "sheet", "width_mm": 500.0, "height_mm": 300.0}
    return {
        "schema": "planish-report/1",
        "status": "rejected",
        "job": {"name": HOSTILE, "material": {"name": "DC01", "thickness_mm": 2.0}, "tolerance": None},
        "parts": [
            part(HOSTILE, [strained], "fabrication"), part(PLATE, [failed], "exact"),
            {**part(REFUSED, [refused], "rejected"), "flat": None},
        ],
        "nest": {"status": "pass", "metrics": [metric("utilisation", 0.4)], "findings": [],
                 "stock": [stock], "sheets": [sheet]},
        "write": {"status": "pass", "metrics": [], "findings": []},
        "run": {"version": "0"},
    }  # fmt: skip


def view() -> Document:
    """Return what is drawn of the parts."""
    box = path((0.0, 0.0, 0.0), (WIDE, 0.0, 0.0), (WIDE, HIGH, 0.0), (0.0, HIGH, 0.0))
    round_end = path((0.0, 0.0, 0.0), (150.0, 0.0, 1.0), (150.0, HIGH, 0.0), (0.0, HIGH, 0.0))
    bare: Document = {"marks": [], "texts": [], "label": [90.0, 50.0], "places": [], "rulings": []}
    return {"parts": [
        {"name": HOSTILE, "flat": {**bare, "contours": [box], "rulings": RULINGS}, "formed": None},
        {"name": PLATE, "flat": {**bare, "contours": [round_end]}, "formed": None},
        {"name": REFUSED, "flat": None, "formed": None},
    ], "sheets": [{"outline": None, "defects": [], "zones": []}]}  # fmt: skip


def written(folder: Path) -> Path:
    """Return the page as a file."""
    file = folder / "report.html"
    file.write_bytes(report_html(report(), view()))
    return file


def colours(values: Array, limit: float = LIMIT) -> Array:
    """Return the colours that strains have on the page, 0 to 255: white, orange stretched, blue pressed."""
    share = np.clip(values / limit, -1.0, 1.0)[..., None]
    ends = np.where(share >= 0.0, [213.0, 94.0, 0.0], [0.0, 114.0, 178.0])
    return np.asarray(255.0 + np.abs(share) * (ends - 255.0))
