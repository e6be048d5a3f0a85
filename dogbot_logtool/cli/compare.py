"""The words of `compare`."""

import sys
from collections.abc import Mapping
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
from dogbot_logtool.cli.outcomes import say_damaged
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import CompareOptions, TopicOptions


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
    "--update",
    "write_over",
    is_flag=True,
    help="Write ACTUAL over EXPECTED and say what changed, a line a topic.",
)
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
    write_over: bool,
    by_gait: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Compare two logs, or two `stats --json` files, with tolerances.

    A field is named by its path without positions: pose.position.x, feet.front_left.slip_m. A
    glob's * stands for dots and slashes, too; one that fits nothing gives a warning. Integers are
    exact unless a tolerance names them. That nothing is left to compare is a wrong call.

    Exit code 0: the same; 1: different; 2: the call or a file is wrong; 3: the same as far as can
    be read, but a file is damaged.

    Where EXPECTED holds labelled events (.yaml EUROBENCH, .tsv BIDS, .csv as of stats --events),
    those of a log or of another such file are matched with them, within --atol (0.05 s). Exit code
    1: some are missed or invented.

    With --gait, either side is a log, a directory, a glob or @LIST; its strides are compared figure
    by figure, with intervals. Exit code 1: some differ, or the runs are not comparable. Options of
    the robot (--robot, --foot, --mass ...) say how logs are measured.
    """
    from dogbot_logtool.comparison.walks.event_files import is_event_file  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import CompareOptions, TopicOptions  # noqa: PLC0415

    of_messages = {
        "--rtol": rtol is not None,
        "--tolerances": tolerances is not None,
        "--ignore": ignore,
        "--topics": compared_topics,
        "--junit": junit is not None,
    }
    if is_event_file(expected):
        others = {**of_messages, "--gait": by_gait, "--update": write_over}
        _refuse(f"{expected} holds labelled events", others)
        _compare_events(expected, actual, atol, topics, as_json=as_json, quiet=quiet)
    others = {"--atol": atol is not None, **of_messages}
    if by_gait:
        _refuse("--gait compares figures of strides", {**others, "--update": write_over})
        _compare_gait(expected, actual, topics, as_json=as_json, quiet=quiet, verbose=verbose)
    if topics != TopicOptions():
        raise CallError(
            "--robot, --odom-topic, --foot, --mass and --tare say how logs are measured: they go "
            "with --gait and with labelled events"
        )
    if write_over:
        _refuse("--update writes the whole file", {**others, "--json": as_json})
        _update(expected, actual)
    options = CompareOptions(atol, rtol, tolerances, ignore, compared_topics, max_differences)
    _compare_messages(
        expected, actual, options, junit, overwrite=overwrite, as_json=as_json, quiet=quiet
    )


def _refuse(why: str, options: Mapping[str, object]) -> None:
    """Refuse options that have no meaning with another one.

    Raises:
        CallError: one is given.
    """
    for option in (name for name, given in options.items() if given):
        raise CallError(f"{why}: {option} has no meaning with it")


def _update(expected: Path, actual: Path) -> NoReturn:
    """Write one file over the other, and say what changed; exit."""
    from dogbot_logtool.commands.compare import update  # noqa: PLC0415

    for line in update(expected, actual).lines or ("nothing changed",):
        click.echo(line)
    sys.exit(0)


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
    from dogbot_logtool.report.documents.comparison_json import comparison_json  # noqa: PLC0415
    from dogbot_logtool.report.documents.junit import junit_xml  # noqa: PLC0415
    from dogbot_logtool.report.text.comparison_text import show_comparison  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415

    if junit is not None:
        refuse_bad_report(junit, (expected, actual), overwrite=overwrite)
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
    elif comparison.losses:
        say_damaged(len({found.path for found in comparison.losses}))
    sys.exit(comparison.exit_code)


def _compare_events(
    labels: Path,
    actual: Path,
    atol: float | None,
    topics: "TopicOptions",
    *,
    as_json: bool,
    quiet: bool,
) -> NoReturn:
    """Match labelled events with those that are found; exit."""
    from dogbot_logtool.commands.compare_events import compare_events  # noqa: PLC0415
    from dogbot_logtool.comparison.walks.labelled_events import WITHIN_S  # noqa: PLC0415
    from dogbot_logtool.io.plain_json import to_json  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415
    from dogbot_logtool.report.event_matches import event_matches_json, print_event_matches  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415

    within_s = WITHIN_S if atol is None else atol
    matches = compare_events(labels, actual, within_s, StatsOptions(topics))
    if as_json:
        click.echo(to_json(event_matches_json(matches, within_s), indent=2))
    elif not quiet:
        print_event_matches(results(), matches, within_s)
    sys.exit(1 if any(each.missed_s or each.invented_s for each in matches) else 0)


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
    from dogbot_logtool.cli.two_sides import exit_code_of, measured_side  # noqa: PLC0415
    from dogbot_logtool.commands.compare_gait import compare_gait  # noqa: PLC0415
    from dogbot_logtool.io.plain_json import to_json  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415
    from dogbot_logtool.report.gait_comparison import gait_comparison_json, print_gait_comparison  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    options = StatsOptions(topics, jobs=jobs_or_cores(None))
    sides = [
        measured_side(find_logs((str(word),)), options, quiet=quiet) for word in (expected, actual)
    ]
    found = compare_gait(*(side.figures for side in sides))
    if as_json:
        click.echo(to_json(gait_comparison_json(found), indent=2))
    elif not quiet:
        print_gait_comparison(results(), found, verbose=verbose)
    sys.exit(found.exit_code or exit_code_of(sides))
