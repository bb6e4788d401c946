"""`planish doctor`: arguments -> what is found; exit code 0 if all is as it should be, 3 if something is not."""

import sys
from pathlib import Path

import click

EXIT_NOT_FIT = 3


@click.command()
@click.argument("out", type=click.Path(path_type=Path), default=Path("out/batch"), metavar="[OUT]")
@click.option("--cluster", metavar="ADDRESS", help="Address of a Dask scheduler: look at its workers too.")
@click.option("--json", "as_json", is_flag=True, help="Write one JSON document to stdout.")
def doctor(out: Path, cluster: str | None, as_json: bool) -> None:
    """Say whether batches can be run here, with outputs in OUT, and what to do if not."""
    import json
    from dataclasses import asdict

    from pipeline.batch.doctor import examine

    all_found = []
    for found in examine(out, cluster):
        all_found.append(found)
        click.echo("" if as_json else f"{found.line()}\n", nl=False)
    if as_json:
        click.echo(json.dumps({"checks": [asdict(found) for found in all_found]}, indent=1))
    sys.exit(0 if all(found.good for found in all_found) else EXIT_NOT_FIT)
