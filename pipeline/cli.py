"""The command line: arguments -> one call; data on stdout, messages on stderr; exit codes.

0 made; 1 geometry says no; 2 the usage or the job file is wrong; 3 it fits no sheet, or a method fell short; 4 a defect
of the program; 130 interrupted.  What a command needs is imported inside it, so that `--version` waits for nothing.
"""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pipeline import __version__
from pipeline.lazy import Commands
from pipeline.loading import laid, load
from pipeline.plaintext import plain_lines

if TYPE_CHECKING:
    from pipeline.run import Step
    from stages.errors import Problem

EXIT_WORSE, EXIT_USAGE, EXIT_SHORT, EXIT_INTERNAL, EXIT_INTERRUPTED = 1, 2, 3, 4, 130
TRACEBACK = "PLANISH_TRACEBACK"
"""Set in the environment, it shows where in the program an internal error arose."""

JobPath = click.argument("job", type=click.Path(path_type=Path), metavar="JOB.toml")
Settings = click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="part[0].surface.k0=1, say")
Allow = click.option(
    "--allow", multiple=True, metavar="FOLDER", type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="What a job names may lie in FOLDER too, not only beside the job.",
)  # fmt: skip
AsJson = click.option("--json", "as_json", is_flag=True, help="Write one JSON document to stdout.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="%(prog)s %(version)s")
def cli() -> None:
    """Developable surfaces -> verified, unrolled, nested, cut."""


@cli.command()
@JobPath
@click.option("-o", "--out", type=click.Path(path_type=Path), help="Output folder; out/<job name> if absent.")
@Settings
@Allow
@click.option("--layout", type=click.Path(path_type=Path), metavar="FILE", help="Lay parts as layout.json says.")
@click.option("--workers", type=click.IntRange(1, 256), default=1, show_default=True, help="Processes to run it in.")
@AsJson
@click.option("--quiet", is_flag=True, help="No messages but errors.")
def run(
    job: Path,
    out: Path | None,
    settings: tuple[str, ...],
    allow: tuple[Path, ...],
    *,
    layout: Path | None,
    workers: int,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run a job: JOB.toml in, cut files and report out."""
    from pipeline.outputs import left_out_lines, outputs
    from pipeline.report.costs import cost_lines
    from pipeline.report.document import encoded
    from pipeline.report.lines import outcome_line
    from pipeline.report.stockfigures import sheet_lines
    from pipeline.run import run_job, silent, spread
    from pipeline.store import replacement, safe_name, write_files

    ready = load(job, settings, allow, message, quiet=quiet)
    if layout is not None:
        ready = laid(ready, layout, message, quiet=quiet)
    target = out or Path("out") / safe_name(ready.name)
    with replacement(target, keep=[job] if layout is None else [job, layout]) as draft:
        way = spread(workers)
        result = run_job(ready, silent if quiet else tell, way)
        report, files = outputs(result, way.each)
        write_files(draft, files)
    if not quiet:
        for line in (*sheet_lines(result), *cost_lines(result), *left_out_lines(result)):
            message(line)
        message(outcome_line(result, str(target), files))
    if as_json:
        click.echo(encoded(report), nl=False)
    sys.exit(result.exit_code)


@cli.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="OUT...")
@click.option("-o", "--out", type=click.Path(path_type=Path), default=Path("out/pooled"), show_default=True)
@click.option(
    "--stock", type=click.Path(path_type=Path), metavar="FILE.toml", help="Stock; that of the first job if absent."
)
@Allow
@AsJson
@click.option("--quiet", is_flag=True, help="No messages but errors.")
def nest(
    folders: tuple[Path, ...], out: Path, stock: Path | None, *, allow: tuple[Path, ...], as_json: bool, quiet: bool
) -> None:
    """Nest the parts of finished jobs together, by material and thickness."""
    from pipeline.finished import all_finished
    from pipeline.pooled import pool
    from pipeline.report.document import encoded
    from pipeline.report.pooldocument import pool_lines, pool_outputs
    from pipeline.run import silent
    from pipeline.store import REPORT, replacement, write_files
    from pipeline.supply import supply_of

    supply = None if stock is None else supply_of(stock, allow)
    jobs = all_finished(folders)
    keep = [folder / REPORT for folder in folders] + ([] if stock is None else [stock])
    with replacement(out, keep=keep) as draft:
        pooled = pool(jobs, supply, silent if quiet else tell)
        report, files = pool_outputs(pooled)
        write_files(draft, files)
    for line in () if quiet else pool_lines(pooled, str(out)):
        message(line)
    if as_json:
        click.echo(encoded(report), nl=False)
    sys.exit(pooled.exit_code)


@cli.command()
@JobPath
@Settings
@Allow
@AsJson
def check(job: Path, settings: tuple[str, ...], allow: tuple[Path, ...], as_json: bool) -> None:
    """Read and validate a job file, and do nothing else."""
    ready = load(job, settings, allow, message, quiet=as_json)
    if as_json:
        click.echo('{"errors": []}')
    else:
        count = len(ready.parts)
        message(f"{job}: {count} part{'' if count == 1 else 's'}, no errors")


@cli.command()
@click.argument("out", type=click.Path(path_type=Path), metavar="OUT")
@click.argument("measured", required=False, type=click.Path(path_type=Path), metavar="[MEASURED.csv]")
@click.option("--template", "empty", is_flag=True, help="Write an empty sheet of measurements to stdout.")
@click.option("--job", type=click.Path(path_type=Path), metavar="JOB.toml", help="Needed for points: the job of OUT.")
@click.option("--best-fit", "fitted", is_flag=True, help="Points in any frame: each copy moved to where it lies best.")
@Settings
@Allow
@click.option("-o", "target", type=click.Path(path_type=Path), help="compare.json beside MEASURED.csv if absent.")
@AsJson
def compare(
    out: Path,
    measured: Path | None,
    *,
    empty: bool,
    job: Path | None,
    fitted: bool,
    settings: tuple[str, ...],
    allow: tuple[Path, ...],
    target: Path | None,
    as_json: bool,
) -> None:
    """Compare measurements of made parts with a finished job, and fit kerf, K-factor and springback to them."""
    from pipeline.asmade.compare import FILE, comparison, keep
    from pipeline.asmade.document import compare_document, compare_lines
    from pipeline.asmade.nominal import nominal_of
    from pipeline.asmade.sheet import template
    from pipeline.report.document import encoded

    if empty == (measured is not None):
        raise click.UsageError("give either a sheet of measurements or --template")
    if measured is None:
        click.echo(template(nominal_of(out)).encode(), nl=False)
        return
    ready = None if job is None else load(job, settings, allow, message, quiet=True)
    made = comparison(out, measured, ready, fitted=fitted)
    content = encoded(compare_document(made))
    keep(target or measured.with_name(FILE), content)
    click.echo(content if as_json else "\n".join(compare_lines(made)), nl=not as_json)
    sys.exit(1 if made.failed else 0)


@cli.command()
@click.argument("kind")
def init(kind: str) -> None:
    """Print a commented job file for a KIND of surface; it runs as it is."""
    from pipeline.kinds import template

    click.echo(template(kind), nl=False)


@cli.command()
@click.option("--side", "which", flag_value="side", help="Of the side files that lie beside drawings.")
@click.option("--report", "which", flag_value="report", help="Of report.json.")
@click.option("--compare", "which", flag_value="compare", help="Of compare.json.")
def schema(which: str | None) -> None:
    """Print the JSON Schema of the job file, or of another file."""
    from pipeline.asmade.document import compare_schema
    from pipeline.kinds import json_schema
    from pipeline.report.schema import report_schema
    from pipeline.sidefiles import side_schema

    click.echo({None: json_schema, "side": side_schema, "report": report_schema, "compare": compare_schema}[which]())


@cli.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="OUT [OTHER]")
@click.option("--format", "also", multiple=True, metavar="NAME", help="A format beside those the job asked for.")
@AsJson
@click.option("--quiet", is_flag=True, help="No messages but errors.")
def report(folders: tuple[Path, ...], also: tuple[str, ...], *, as_json: bool, quiet: bool) -> None:
    """Render the report of a finished job again, or the summary of a batch; or compare two runs: 1 if one is worse."""
    from pipeline.reports import again, compared

    if len(folders) == 1:
        content, paths = again(folders[0], also)
        for path in () if quiet else paths:
            message(str(folders[0] / path))
        click.echo(content if as_json else "", nl=False)
        return
    data, worse = compared(folders, also, as_json=as_json)
    click.echo(data, nl=False)
    sys.exit(EXIT_WORSE if worse else 0)


@cli.command()
def kinds() -> None:
    """List the kinds of surface with their keys."""
    from pipeline.kinds import listing

    click.echo(listing())


@cli.command()
def materials() -> None:
    """List the materials and the cutting processes with the source of every value."""
    from pipeline import materials as sheets
    from pipeline import processes

    click.echo(f"{sheets.listing()}\n\nCutting processes\n{processes.listing()}")


def tell(step: "Step[object]") -> None:
    """Say how a stage went."""
    from pipeline.report.lines import step_line, trouble_lines

    message(step_line(step), colour="red" if step.status == "fail" else None)
    for line in trouble_lines(step.report):
        message(line)


def message(text: str, colour: str | None = None) -> None:
    """Write a line to stderr; in colour only on a terminal and unless NO_COLOR is set."""
    shown, bare = plain_lines(text), bool(os.environ.get("NO_COLOR")) or not sys.stderr.isatty()
    click.echo(shown if bare or colour is None else click.style(shown, fg=colour), err=True, color=not bare)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit; no error leaves a traceback."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        cli.main(given, prog_name="planish", standalone_mode=False)
    except (KeyboardInterrupt, click.Abort):
        message("interrupted")
        sys.exit(EXIT_INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except Exception as error:
        sys.exit(failed(error, as_json="--json" in given))


def failed(error: Exception, *, as_json: bool) -> int:
    """Say what went wrong, and return the exit code."""
    from stages.errors import BadInputError, NoSolutionError, Problem

    if isinstance(error, BadInputError):
        return _complain(error.problems, as_json=as_json)
    if isinstance(error, NoSolutionError):
        _complain([Problem(str(error))], as_json=as_json)
        return EXIT_SHORT
    if isinstance(error, click.ClickException):
        return _complain([Problem(error.format_message(), hint="planish --help shows the usage")], as_json=as_json)
    if os.environ.get(TRACEBACK):
        raise error
    notes = "; ".join(getattr(error, "__notes__", []))
    where = f" ({notes})" if notes else ""
    text = f"internal error: {type(error).__name__}: {error}{where}; set {TRACEBACK}=1 and run again to see where"
    _complain([Problem(text)], as_json=as_json)
    return EXIT_INTERNAL


def _complain(problems: "Sequence[Problem]", *, as_json: bool) -> int:
    """Write problems, one a line or as a document."""
    if as_json:
        from pipeline.complaints import complaints

        click.echo(complaints(problems))
    for problem in problems:
        message(str(problem), colour="red")
    return EXIT_USAGE
