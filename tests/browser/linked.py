"""One formed part on its page, from its job file: a piece of a cone, its radius smallest at the narrow end."""

import json
from pathlib import Path

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.document import Document
from pipeline.run import run_job

ALLOWED = 0.04
"""Strain by bending: 0.012 at the wide end, 0.036 at the narrow one."""
JOB = f"""
schema = 1
[job]
name = "linked"
[material]
name = "own"
thickness = 8
max_strain = {ALLOWED}
[report]
formats = ["json", "html"]
[[part]]
name = "frustum"
[[part.hole]]
name = "fix"
kind = "drill"
at = [0.5, 0.5]
diameter = 60
[part.surface]
kind = "cone"
radius0 = 300
radius1 = 100
height = 400
sweep = 100
"""


def made(folder: Path) -> tuple[Path, Document, Document]:
    """Return the page as a file, the report, and what is drawn of the part."""
    job, page = folder / "job.toml", folder / "report.html"
    job.write_text(JOB, "utf-8")
    report, files = outputs(run_job(job_of(read(job))))
    page.write_bytes(files["report.html"])
    view = json.loads(files["view.json"])
    return page, report, view["parts"][0]
