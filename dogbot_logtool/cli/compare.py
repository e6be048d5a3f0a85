"""The words of `compare`."""

import sys
from pathlib import Path

import click

from dogbot_logtool.cli.options import json_option, number, quietness


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
    help="Glob of topics or fields (or TOPIC:FIELD) that may differ.",
)
@click.option("--topics", multiple=True, metavar="TOPIC", help="Glob of the topics to compare.")
@click.option(
    "--max-differences",
    type=click.IntRange(min=0),
    metavar="N",
    default=20,
    show_default=True,
    help="Differences that are told one by one.",
)
@click.option(
    "--junit", type=click.Path(path_type=Path), metavar="FILE", help="Write JUnit XML as well."
)
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
    write_over: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Say whether two logs, or two `stats --json` files, mean the same, and if not, where.

    Exit code 0: the same; 1: different; 2: the call or a file is wrong; 3: the same as far as can
    be read, but a file is damaged.
    """
    from dogbot_logtool.compare import CompareOptions, update  # noqa: PLC0415
    from dogbot_logtool.compare import compare as compare_files  # noqa: PLC0415
    from dogbot_logtool.report.comparison_json import comparison_json  # noqa: PLC0415
    from dogbot_logtool.report.comparison_text import show_comparison  # noqa: PLC0415
    from dogbot_logtool.report.console import results  # noqa: PLC0415
    from dogbot_logtool.report.junit import junit_xml  # noqa: PLC0415
    from dogbot_logtool.writer.output import whole_file  # noqa: PLC0415

    del verbose
    if write_over:
        done = update(expected, actual)
        for line in done.lines or ("nothing changed",):
            click.echo(line)
        return
    options = CompareOptions(atol, rtol, tolerances, ignore, topics, max_differences)
    comparison = compare_files(expected, actual, options)
    if junit is not None:
        with whole_file(junit, overwrite=True) as file:
            file.write(junit_xml(comparison))
    if as_json:
        click.echo(comparison_json(comparison), nl=False)
    elif not quiet:
        show_comparison(comparison, results())
    sys.exit(comparison.exit_code)
