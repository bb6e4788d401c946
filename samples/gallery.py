"""Makes the pictures that lie beside the samples, and the page that shows them: `python3 dev.py gallery [JOB...]`.

Runs each job, `ducts/job.toml` for example, and copies the chosen previews into its folder.  Of some jobs also what a
shop looks at: the page of the report on a laptop and on a phone, in chromium, and a page of the traveller, by
pdftocairo of poppler.  Where one of the two programs cannot be had, it is said and its pictures stay.

Pictures are kept small, with colours of their own: drawings have few, and shades lose nothing that one sees.
"""

import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

from PIL import Image

SAMPLES = Path(__file__).parent
PICTURES = {
    "auger/job.toml": ("flight", "flare", "visor", "spout"),
    "bag/job.toml": ("flap",),
    "bag/sewn.toml": ("body", "skin-a-1"),
    "bracket/job.toml": ("bracket",),
    "cladding/job.toml": ("fascia", "handrail-band", "joint-band", "swan-neck"),
    "ducts/job.toml": ("transition", "elbow.3", "branch.1", "galvanised-1"),
    "flanges/job.toml": ("base", "plate-1"),
    "guard/job.toml": ("hood",),
    "hides/job.toml": ("right-1",),
    "hopper/job.toml": ("offset-cone", "plate-1"),
    "paper/job.toml": ("example-1", "example-2", "example-3"),
    "strakes/job.toml": ("bilge", "topside", "hood", "aluminium-1"),
    "upper/job.toml": ("toe", "seat"),
}
"""Of each job the pictures that are shown: of parts, and of sheets."""
SCREENS = {"laptop": (1366, 1260), "phone": (390, 1640)}
"""Width and height in px of what is shown of a page."""
PAGES = {"guard/job.toml": ("laptop", "phone"), "upper/job.toml": ("laptop",)}
"""Jobs whose page is shown."""
TRAVELLERS = {"guard/job.toml": 1}
"""Jobs of whose traveller a page is shown, and which one."""
TRAVELLER_DPI = 90
SETTLED_MS = 6000
"""Of the page's own clock, after which both views are drawn."""
COLOURS = 256


def shown(job: str) -> tuple[str, ...]:
    """Return the names of all pictures of a job."""
    screens = tuple(f"report-{screen}" for screen in PAGES.get(job, ()))
    return (*PICTURES[job], *screens, *(("traveller",) if job in TRAVELLERS else ()))


def main(jobs: Sequence[str]) -> int:
    """Make the pictures of some jobs, or of all; return the exit code of the first that cannot be."""
    from samples.listing import PAGE, page

    for job in jobs or PICTURES:
        with TemporaryDirectory() as scratch:
            code = made(job, Path(scratch) / "out")
            if code:
                return code
    PAGE.write_text(page(), "utf-8")
    return 0


def made(job: str, out: Path) -> int:
    """Run a job and make its pictures; return the exit code."""
    code = called(sys.executable, "-m", "pipeline", "run", str(SAMPLES / job), "-o", str(out), "--quiet")
    if code:
        return code
    for name in PICTURES[job]:
        copyfile(out / "preview" / f"{name}.png", told(job, name))
    codes = [screenshot(job, out / "report.html", screen) for screen in PAGES.get(job, ())]
    codes += [traveller(job, out / "traveller.pdf", TRAVELLERS[job])] if job in TRAVELLERS else []
    for name in shown(job):
        made_small(place(job, name))
    return max(codes, default=0)


def made_small(picture: Path) -> None:
    """Write a picture anew with colours of its own, unless it has them."""
    with Image.open(picture) as image:
        if image.mode != "P":
            few = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
            few.save(picture, "PNG", optimize=True)


def called(*command: str) -> int:
    """Return the exit code of a command that runs beside the samples."""
    return subprocess.run(command, cwd=SAMPLES.parent, check=False).returncode


def place(job: str, name: str) -> Path:
    """Return where a picture lies."""
    return (SAMPLES / job).parent / f"{name}.png"


def told(job: str, name: str) -> Path:
    """Return where a picture goes, and say so."""
    picture = place(job, name)
    sys.stdout.write(f"samples/{picture.relative_to(SAMPLES).as_posix()}\n")
    return picture


def screenshot(job: str, file: Path, screen: str) -> int:
    """Make the picture of a report as a screen shows it; return the exit code."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        return left_out(f"report-{screen}", job, "chromium")
    width, height = SCREENS[screen]
    picture = told(job, f"report-{screen}")
    with TemporaryDirectory() as profile:
        return called(
            program, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--log-level=3",
            f"--user-data-dir={profile}", f"--window-size={width},{height}", f"--virtual-time-budget={SETTLED_MS}",
            f"--screenshot={picture}", file.as_uri(),
        )  # fmt: skip


def traveller(job: str, file: Path, number: int) -> int:
    """Make the picture of a page of a traveller; return the exit code."""
    program = shutil.which("pdftocairo")
    if program is None:
        return left_out("traveller", job, "pdftocairo")
    which = ("-f", str(number), "-l", str(number), "-singlefile", "-r", str(TRAVELLER_DPI))
    return called(program, "-png", *which, str(file), str(told(job, "traveller").with_suffix("")))


def left_out(name: str, job: str, program: str) -> int:
    """Say that a picture stays as it is; return the exit code."""
    sys.stderr.write(f"samples/{Path(job).parent}/{name}.png: left as it is, {program} is not installed\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
