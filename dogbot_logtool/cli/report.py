"""The words of `report`."""

from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    join_logs,
    join_option,
    json_option,
    logs_argument,
    overwrite_option,
    quietness,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import StatsOptions


@click.command()
@logs_argument
@join_option
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="File, or a directory (ends in /, or several logs); default: <log>.report.html here.",
)
@click.option(
    "--against",
    multiple=True,
    metavar="LOG",
    help="Other logs (directory, glob, @LIST): one page shows both sides, and what differs; "
    "default: <log>.against.html here.",
)
@stats_options
@click.option(
    "--no-replay",
    "with_replay",
    is_flag=True,
    default=True,
    flag_value=False,
    help="Leave out the walk in 3D, which takes up to a megabyte.",
)
@jobs_option
@overwrite_option
@json_option
@quietness
def report(
    words: tuple[str, ...],
    output: str | None,
    against: tuple[str, ...],
    measuring: "StatsOptions",
    jobs: int | None,
    *,
    join: bool,
    with_replay: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Write a page: the walk in 3D, gait, loads, and what to doubt.

    One HTML file a log, which opens from disk and loads nothing. Several logs also give an
    index.html with a row each. With --against, one page says whether two runs, or two groups of
    runs, can be compared, and which figures differ. Needs the extra `report`.
    """
    from dogbot_logtool.report.page.libraries import require_libraries  # noqa: PLC0415

    require_libraries()
    from dogbot_logtool.commands.report import Reports  # noqa: PLC0415
    from dogbot_logtool.io.targets import may_be_several, output_at  # noqa: PLC0415
    from dogbot_logtool.report.page.page_result import page_json, print_page  # noqa: PLC0415
    from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.results import Page  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415
    from dogbot_logtool.run.runner import SerialRunner  # noqa: PLC0415

    chosen = replace(measuring, jobs=jobs_or_cores(jobs))
    if against:
        if join:
            raise CallError("--join and --against: choose one")
        _report_against(words, against, output, chosen, overwrite=overwrite, as_json=as_json,
                        quiet=quiet)  # fmt: skip
    console = diagnostics()
    log_set, topics = join_logs(find_logs(words), chosen.topics, join=join)
    chosen = replace(chosen, topics=topics)
    several = not join and may_be_several(words, log_set.paths)
    where = output_at(output, ".report.html", several=several)
    reports = Reports(log_set.paths, where, chosen, overwrite=overwrite, with_replay=with_replay)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    # One after the other, since the index needs them all.
    runner: SerialRunner[Page] = SerialRunner(chosen.jobs)
    for done in outcomes.of(runner, reports.write, log_set.paths, log_set.names):
        outcomes.add(page_json(done))
        if not quiet:
            print_page(console, done, verbose=verbose)
    reports.finish(dict(outcomes.failures))
    outcomes.finish(as_json=as_json)


def _report_against(
    words: tuple[str, ...],
    against: tuple[str, ...],
    output: str | None,
    options: "StatsOptions",
    *,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
) -> NoReturn:
    """Write a page that compares two sides; exit."""
    from dogbot_logtool.cli.two_sides import measured_side  # noqa: PLC0415
    from dogbot_logtool.commands.report_against import ENDING, comparison_target, report_against  # noqa: PLC0415
    from dogbot_logtool.io.plain_json import to_json  # noqa: PLC0415
    from dogbot_logtool.io.storage import shown  # noqa: PLC0415
    from dogbot_logtool.io.targets import output_at  # noqa: PLC0415
    from dogbot_logtool.report.comparison_report import gait_comparison_json, print_comparison_page  # noqa: PLC0415
    from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    log_sets = [find_logs(words), find_logs(against)]
    where = output_at(output, ENDING, several=False)
    target = comparison_target(where, *(each.paths for each in log_sets), overwrite=overwrite)
    outcomes = Outcomes(quiet=quiet)
    first, second = (measured_side(outcomes, each, options) for each in log_sets)
    if not (first and second):
        outcomes.finish()
    done = report_against(first, second, target, overwrite=overwrite, makes_folder=where.is_folder)
    if as_json:
        found = {"output": shown(done.target), "bytes": done.size}
        click.echo(to_json({**found, **gait_comparison_json(done.found)}, indent=2))
    if not quiet:
        print_comparison_page(diagnostics(), shown(done.target), done.size, done.found)
    outcomes.finish()
