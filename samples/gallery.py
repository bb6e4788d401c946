"""Makes the pictures that lie beside the samples: runs each job and copies the chosen previews into its folder."""

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


def main() -> int:
    """Return the exit code: that of the first job that is not made."""
    for sample, names in PICTURES.items():
        with TemporaryDirectory() as scratch:
            out = Path(scratch) / sample
            job = SAMPLES / sample / "job.toml"
            command = [sys.executable, "-m", "pipeline", "run", str(job), "-o", str(out), "--quiet"]
            code = subprocess.run(command, cwd=SAMPLES.parent, check=False).returncode
            if code:
                return code
            for name in names:
                copyfile(out / "preview" / f"{name}.png", SAMPLES / sample / f"{name}.png")
                sys.stdout.write(f"samples/{sample}/{name}.png\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
