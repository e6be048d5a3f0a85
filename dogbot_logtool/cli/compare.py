"""The words of `compare`."""

import sys
from pathlib import Path

import click

from dogbot_logtool.cli.options import json_option, number, output_file, quietness
from dogbot_logtool.errors import CallError


@click.command()
@click.argument("expected", type=click.Path(path_type=Path))
@click.argument("actual", type=click.Path(path_type=Path))
@click.option(
    "--atol",
    type=number(0.0, 1e300),
    help="Absolute tolerance of numbers, in each field's own unit; default: 0.",
)
@click.option("--rtol", type=number(0.0, 1.0), help="Relative tolerance; default: 0.")
@click.option(
    "--tolerances",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="Tolerances by quantity: metres, radians, newtons ...",
)
@click.option(
    "--ignore",
    multiple=True,
    metavar="TOPIC|FIELD",
    help="Glob of what may differ: topics, fields, TOPIC:FIELD, metadata:NAME, attachment:NAME.",
)
@click.option(
    "--topics",
    multiple=True,
    metavar="TOPIC",
    help="Glob of the topics to compare; of JSON, of paths (gait, feet.*.duty_factor.median).",
)
@click.option(
    "--max-differences",
    type=click.IntRange(min=0),
    metavar="N",
    default=20,
    show_default=True,
    help="Differences that are told one by one.",
)
@click.option(
    "--junit",
    type=output_file,
    metavar="FILE",
    help="Write JUnit XML as well, to a new file.",
)
@click.option("--overwrite", is_flag=True, help="Replace the file of --junit if it exists already.")
@click.option(
    "--update",
    "write_over",
    is_flag=True,
    help="Write ACTUAL over EXPECTED and say what changed, a line a topic.",
)
@json_option
@quietness
def compare(
    expected: Path,
    actual: Path,
    atol: float | None,
    rtol: float | None,
    tolerances: Path | None,
    ignore: tuple[str, ...],
    topics: tuple[str, ...],
    max_differences: int,
    junit: Path | None,
    *,
    overwrite: bool,
    write_over: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Say whether two logs, or two `stats --json` files, mean the same, and if not, where.

    A field is named by its path without positions: pose.position.x, feet.front_left.slip_m. A
    glob's * stands for dots and slashes, too; one that fits nothing gives a warning. Integers are
    exact unless a tolerance names them. That nothing is left to compare is a wrong call.

    Exit code 0: the same; 1: different; 2: the call or a file is wrong; 3: the same as far as can
    be read, but a file is damaged.
    """
    from dogbot_logtool.commands.compare import compare as compare_files  # noqa: PLC0415
    from dogbot_logtool.commands.compare import refuse_bad_report, update  # noqa: PLC0415
    from dogbot_logtool.io.output import whole_file  # noqa: PLC0415
    from dogbot_logtool.io.printable import printable  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import CompareOptions  # noqa: PLC0415
    from dogbot_logtool.report.comparison_json import comparison_json  # noqa: PLC0415
    from dogbot_logtool.report.comparison_text import show_comparison  # noqa: PLC0415
    from dogbot_logtool.report.console import results  # noqa: PLC0415
    from dogbot_logtool.report.junit import junit_xml  # noqa: PLC0415

    del verbose
    if write_over:
        others = {
            "--atol": atol is not None,
            "--rtol": rtol is not None,
            "--tolerances": tolerances is not None,
            "--ignore": ignore,
            "--topics": topics,
            "--junit": junit is not None,
            "--json": as_json,
        }
        for option in (name for name, given in others.items() if given):
            raise CallError(f"--update writes the whole file: {option} has no meaning with it")
        done = update(expected, actual)
        for line in done.lines or ("nothing changed",):
            click.echo(line)
        return
    if junit is not None:
        refuse_bad_report(junit, expected, actual, overwrite=overwrite)
    options = CompareOptions(atol, rtol, tolerances, ignore, topics, max_differences)
    comparison = compare_files(expected, actual, options)
    if junit is not None:
        with whole_file(junit, overwrite=overwrite) as file:
            file.write(junit_xml(comparison))
    for warning in comparison.warnings:
        click.echo(printable(f"warning: {warning}"), err=True)
    if as_json:
        click.echo(comparison_json(comparison), nl=False)
    elif not quiet:
        show_comparison(comparison, results())
    sys.exit(comparison.exit_code)
