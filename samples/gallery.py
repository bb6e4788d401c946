"""Makes the pictures that lie beside the samples: runs each job and copies the chosen previews into its folder.

Of some jobs also what a shop looks at: the page of the report on a laptop and on a phone, in chromium, and a page of
the traveller, by pdftocairo of poppler.  Where one of the two programs cannot be had, it is said and its pictures stay.
"""

import shutil
import subprocess
import sys
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

SAMPLES = Path(__file__).parent
PICTURES = {
    "auger": ("flight", "flare"),
    "bag": ("flap",),
    "bracket": ("bracket",),
    "cladding": ("fascia", "handrail-band"),
    "ducts": ("transition", "galvanised-1"),
    "flanges": ("plate-1",),
    "guard": ("hood",),
    "hides": ("right-1",),
    "hopper": ("offset-cone", "plate-1"),
    "paper": ("example-2",),
    "strakes": ("bilge", "hood", "aluminium-1"),
    "upper": ("toe", "seat"),
}
SCREENS = {"laptop": (1366, 1260), "phone": (390, 1640)}
"""Width and height in px of what is shown of a page."""
PAGES = {"guard": ("laptop", "phone"), "upper": ("laptop",)}
"""Jobs whose page is shown."""
TRAVELLERS = {"guard": 1}
"""Jobs of whose traveller a page is shown, and which one."""
TRAVELLER_DPI = 90
SETTLED_MS = 6000
"""Of the page's own clock, after which both views are drawn."""


def shown(sample: str) -> tuple[str, ...]:
    """Return the names of all pictures of a sample."""
    screens = tuple(f"report-{screen}" for screen in PAGES.get(sample, ()))
    return (*PICTURES[sample], *screens, *(("traveller",) if sample in TRAVELLERS else ()))


def main() -> int:
    """Return the exit code: that of the first job that is not made, or of the first picture that cannot be."""
    for sample in PICTURES:
        with TemporaryDirectory() as scratch:
            code = made(sample, Path(scratch) / sample)
            if code:
                return code
    return 0


def made(sample: str, out: Path) -> int:
    """Run a job and make its pictures; return the exit code."""
    job = SAMPLES / sample / "job.toml"
    code = called(sys.executable, "-m", "pipeline", "run", str(job), "-o", str(out), "--quiet")
    if code:
        return code
    for name in PICTURES[sample]:
        copyfile(out / "preview" / f"{name}.png", told(sample, name))
    codes = [page(sample, out / "report.html", screen) for screen in PAGES.get(sample, ())]
    codes += [traveller(sample, out / "traveller.pdf", TRAVELLERS[sample])] if sample in TRAVELLERS else []
    return max(codes, default=0)


def called(*command: str) -> int:
    """Return the exit code of a command that runs beside the samples."""
    return subprocess.run(command, cwd=SAMPLES.parent, check=False).returncode


def told(sample: str, name: str) -> Path:
    """Return where a picture goes, and say so."""
    sys.stdout.write(f"samples/{sample}/{name}.png\n")
    return SAMPLES / sample / f"{name}.png"


def page(sample: str, file: Path, screen: str) -> int:
    """Make the picture of a report as a screen shows it; return the exit code."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        return left_out(f"report-{screen}", sample, "chromium")
    width, height = SCREENS[screen]
    picture = told(sample, f"report-{screen}")
    with TemporaryDirectory() as profile:
        return called(
            program, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--log-level=3",
            f"--user-data-dir={profile}", f"--window-size={width},{height}", f"--virtual-time-budget={SETTLED_MS}",
            f"--screenshot={picture}", file.as_uri(),
        )  # fmt: skip


def traveller(sample: str, file: Path, number: int) -> int:
    """Make the picture of a page of a traveller; return the exit code."""
    program = shutil.which("pdftocairo")
    if program is None:
        return left_out("traveller", sample, "pdftocairo")
    which = ("-f", str(number), "-l", str(number), "-singlefile", "-r", str(TRAVELLER_DPI))
    return called(program, "-png", *which, str(file), str(told(sample, "traveller").with_suffix("")))


def left_out(name: str, sample: str, program: str) -> int:
    """Say that a picture stays as it is; return the exit code."""
    sys.stderr.write(f"samples/{sample}/{name}.png: left as it is, {program} is not installed\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
