"""The page of the samples, `samples/README.md`: three whole jobs, every kind of surface with a picture, and all jobs.

What it says of a job are the first words of its file, of a kind those of `planish kinds`: nothing is written twice.
"""

import tomllib
from collections.abc import Iterator

from samples.gallery import PAGES, PICTURES, SAMPLES, TRAVELLERS, place, shown
from stages.model.part import KINDS

PAGE = SAMPLES / "README.md"
WHOLE = {
    "ducts/job.toml": ("galvanised-1", "transition", "elbow.3", "branch.1"),
    "strakes/job.toml": ("aluminium-1", "bilge", "topside"),
    "bag/sewn.toml": ("skin-a-1", "body"),
}
"""Jobs that are shown whole: a sheet of each, and parts."""
WIDE, SMALL = 620, 300
"""Widths of pictures on the page, px."""
SHELL = "#   planish "
"""How a line begins that says how a job is run."""
REFUSED = ("paper/as-printed.toml", "strakes/as-drawn.toml")
"""Jobs that are there to be refused; they have no pictures."""


def words(job: str) -> str:
    """Return the first words of a job file: its comment up to how it is run, or to an empty line."""
    said = []
    for line in (SAMPLES / job).read_text("utf-8").splitlines():
        if line == "#" or not line.startswith("# ") or line.startswith(SHELL):
            break
        said.append(line.removeprefix("# "))
    return " ".join(said)


def kinds_shown(job: str) -> dict[str, str]:
    """Return the kinds of surface of which a job has a picture, each with the first of them."""
    parts = tomllib.loads((SAMPLES / job).read_text("utf-8"))["part"]
    kinds = {part["name"]: part["surface"]["kind"] for part in parts}
    found: dict[str, str] = {}
    for picture in PICTURES[job]:
        name = picture if picture in kinds else picture.rpartition(".")[0]
        if name in kinds:
            found.setdefault(kinds[name], picture)
    return found


def pictures_of_kinds() -> dict[str, tuple[str, str]]:
    """Return for every kind of surface a job and the picture of a part of it."""
    found: dict[str, tuple[str, str]] = {}
    for job in PICTURES:
        for kind, picture in kinds_shown(job).items():
            found.setdefault(kind, (job, picture))
    return found


def image(job: str, name: str, width: int) -> str:
    """Return a picture for a page."""
    file = place(job, name).relative_to(SAMPLES).as_posix()
    return f'<img src="{file}" width="{width}" alt="{name.removesuffix(".png")} of {job}">'


def heads() -> Iterator[str]:
    """Yield what the page is."""
    yield "# Samples"
    yield "Each job runs as it is: `planish run samples/ducts/job.toml`. `python3 dev.py gallery` runs them"
    yield "all, makes the pictures and this page; the tests hold figures of each to closed forms or a second method.\n"


def wholes() -> Iterator[str]:
    """Yield three jobs as a shop would get them."""
    yield "## Three whole jobs\n"
    for job, names in WHOLE.items():
        yield f"**[{job}]({job})** {words(job)}\n"
        yield image(job, names[0], WIDE) + "\n"
        yield " ".join(image(job, name, SMALL) for name in names[1:]) + "\n"


def kinds() -> Iterator[str]:
    """Yield a table of the kinds of surface."""
    yield "## Every kind of surface\n"
    yield "| kind | what it is | a part of it |"
    yield "|---|---|---|"
    found = pictures_of_kinds()
    for kind in KINDS:
        tag = str(kind.__struct_config__.tag)
        job, name = found[tag]
        summary = (kind.__doc__ or "").split("\n")[0].replace("|", "\\|")
        yield f"| `{tag}` | {summary} [{job}]({job}) | {image(job, name, SMALL)} |"
    yield ""


def jobs() -> Iterator[str]:
    """Yield a table of all jobs."""
    yield "## All jobs\n"
    yield "| job | what it is |"
    yield "|---|---|"
    for job in sorted({*PICTURES, *REFUSED}):
        yield f"| [{job}]({job}) | {words(job)} |"
    yield ""


def looks() -> Iterator[str]:
    """Yield what a shop looks at: pages of reports and of a traveller."""
    yield "## Report and traveller\n"
    names = [(job, name) for job in sorted({*PAGES, *TRAVELLERS}) for name in shown(job) if name not in PICTURES[job]]
    yield " ".join(image(job, name, SMALL) for job, name in names)


def page() -> str:
    """Return the page."""
    return "\n".join([*heads(), *wholes(), *kinds(), *jobs(), *looks()]) + "\n"
