"""The words of `compare`."""

from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from dogbot_logtool.cli.options import (
    json_option,
    junit_option,
    junit_overwrite_option,
    number,
    quietness,
    tared_topic_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import CompareOptions, TopicOptions


@click.command()
@click.argument("expected", type=click.Path(path_type=Path))
@click.argument("actual", type=click.Path(path_type=Path))
@click.option(
    "--atol",
    type=number("atol"),
    help="Absolute tolerance of numbers, in each field's own unit; default: 0.",
)
@click.option("--rtol", type=number("rtol"), help="Relative tolerance; default: 0.")
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
    "compared_topics",
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
    help="Differences that are printed one by one.",
)
@junit_option
@junit_overwrite_option
@click.option(
    "--gait",
    "by_gait",
    is_flag=True,
    help="Compare how the robot walks in two logs, or groups of logs: which figures differ?",
)
@tared_topic_options
@json_option
@quietness
def compare(
    expected: Path,
    actual: Path,
    atol: float | None,
    rtol: float | None,
    tolerances: Path | None,
    ignore: tuple[str, ...],
    compared_topics: tuple[str, ...],
    topics: "TopicOptions",
    max_differences: int,
    junit: Path | None,
    *,
    overwrite: bool,
    by_gait: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Compare two logs, or two `stats --json` files, with tolerances.

    A field is named by its path without positions: pose.position.x, feet.front_left.slip_m. A
    glob's * stands for dots and slashes, too; one that fits nothing gives a warning. Integers are
    exact unless a tolerance names them. That nothing is left to compare is a wrong call.

    Exit code 0: the same; 1: different, or a file cannot be read; 2: the call is wrong; 3: the same
    as far as can be read, but a file is damaged.

    With --gait, either side is a log, a directory, a glob or @LIST; its strides are compared figure
    by figure, with intervals. Exit code 1: some differ, or the runs are not comparable. Options of
    the robot (--robot, --foot, --mass ...) say how logs are measured.
    """
    from dogbot_logtool.robot.options import CompareOptions, TopicOptions  # noqa: PLC0415

    others = {
        "--atol": atol is not None,
        "--rtol": rtol is not None,
        "--tolerances": tolerances is not None,
        "--ignore": ignore,
        "--topics": compared_topics,
        "--junit": junit is not None,
    }
    if by_gait:
        for option in (name for name, given in others.items() if given):
            raise CallError(f"--gait compares figures of strides: {option} has no meaning with it")
        _compare_gait(expected, actual, topics, as_json=as_json, quiet=quiet, verbose=verbose)
    if topics != TopicOptions():
        raise CallError(
            "--robot, --odom-topic, --foot, --mass and --tare say how logs are measured: they go "
            "with --gait"
        )
    options = CompareOptions(atol, rtol, tolerances, ignore, compared_topics, max_differences)
    _compare_messages(
        expected, actual, options, junit, overwrite=overwrite, as_json=as_json, quiet=quiet
    )


def _compare_messages(
    expected: Path,
    actual: Path,
    options: "CompareOptions",
    junit: Path | None,
    *,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
) -> NoReturn:
    """Compare two logs, or two `stats --json` files, field by field; exit."""
    from dogbot_logtool.commands.compare import compare as compare_files  # noqa: PLC0415
    from dogbot_logtool.io.output import whole_file  # noqa: PLC0415
    from dogbot_logtool.io.printable import printable  # noqa: PLC0415
    from dogbot_logtool.io.targets import refuse_bad_report  # noqa: PLC0415
    from dogbot_logtool.report.comparison_report import (  # noqa: PLC0415
        comparison_json,
        junit_xml,
        show_comparison,
    )
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415

    if junit is not None:
        refuse_bad_report(junit, (expected, actual), overwrite=overwrite)
    comparison = compare_files(expected, actual, options)
    outcomes = Outcomes(quiet=quiet)
    for damage in comparison.damage:
        outcomes.add_damage(damage)
    if junit is not None:
        with whole_file(junit, overwrite=overwrite) as file:
            file.write(junit_xml(comparison))
    for warning in comparison.warnings:
        click.echo(printable(f"warning: {warning}"), err=True)
    if as_json:
        click.echo(comparison_json(comparison), nl=False)
    elif not quiet:
        show_comparison(comparison, results())
    outcomes.finish(exit_code=comparison.exit_code)


def _compare_gait(
    expected: Path,
    actual: Path,
    topics: "TopicOptions",
    *,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> NoReturn:
    """Compare how the robot walks on either side; exit."""
    from dogbot_logtool.cli.options import jobs_or_cores  # noqa: PLC0415
    from dogbot_logtool.cli.two_sides import measured_side  # noqa: PLC0415
    from dogbot_logtool.commands.compare_gait import compare_gait  # noqa: PLC0415
    from dogbot_logtool.io.plain_json import to_json  # noqa: PLC0415
    from dogbot_logtool.report.comparison_report import gait_comparison_json, print_gait_comparison  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415
    from dogbot_logtool.robot.options import StatsOptions  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    options = StatsOptions(topics, jobs=jobs_or_cores(None))
    outcomes = Outcomes(quiet=quiet)
    sides = [
        measured_side(outcomes, find_logs((str(word),)), options) for word in (expected, actual)
    ]
    if not all(sides):
        outcomes.finish()
    found = compare_gait(*sides)
    if as_json:
        click.echo(to_json(gait_comparison_json(found), indent=2))
    elif not quiet:
        print_gait_comparison(results(), found, verbose=verbose)
    outcomes.finish(exit_code=found.exit_code)
