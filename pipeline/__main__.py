"""`planish` and `python -m pipeline`.

`planish --version` is answered before click is loaded, which takes three quarters of the time to start.
"""

import sys

from pipeline import __version__


def main() -> None:
    """Run the command line and exit."""
    if sys.argv[1:] == ["--version"]:
        sys.stdout.write(f"planish {__version__}\n")
        return
    from pipeline.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
