"""The words of `report`."""

from typing import Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    json_option,
    logs_argument,
    measuring_options,
    overwrite_option,
    parse_topics,
    quietness,
    tare_option,
    time_range,
    topic_options,
    wrench_frame_option,
)
from dogbot_logtool.cli.outcomes import Outcomes


@click.command()
@logs_argument
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="File, or a directory (ends in /, or several logs); default: <log>.report.html here.",
)
@topic_options
@tare_option
@wrench_frame_option
@measuring_options
@time_range
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
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    tares: tuple[str, ...],
    jobs: int | None,
    *,
    with_replay: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Write a page that shows what happened: the walk in 3D, gait, loads, path, what to doubt.

    One HTML file a log, which opens from disk and loads nothing. Several logs also give an
    index.html with a row each. Needs the extra `report`.
    """
    from dogbot_logtool.report.page.libraries import require_libraries  # noqa: PLC0415

    require_libraries()
    from dogbot_logtool.commands.report import Reports  # noqa: PLC0415
    from dogbot_logtool.io.targets import may_be_several, output_at  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415
    from dogbot_logtool.report.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.report.page.page_result import page_json, print_page  # noqa: PLC0415
    from dogbot_logtool.results import Page  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415
    from dogbot_logtool.run.runner import SerialRunner  # noqa: PLC0415

    topics = parse_topics(robot, odom_topic, feet, mass_kg, tares)
    chosen = StatsOptions(topics=topics, jobs=jobs_or_cores(jobs), **options)
    console = diagnostics()
    log_set = find_logs(words)
    several = may_be_several(words, log_set.paths)
    where = output_at(output, ".report.html", several=several)
    reports = Reports(log_set.paths, where, chosen, overwrite=overwrite, with_replay=with_replay)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    # One after the other, since the index needs them all.
    runner: SerialRunner[Page] = SerialRunner(chosen.jobs)
    for done in outcomes.of(runner, reports.write, log_set.paths, log_set.names):
        outcomes.add(page_json(done), done.exit_code)
        if not quiet:
            print_page(console, done, verbose=verbose)
    reports.finish(dict(outcomes.failures))
    outcomes.finish(as_json=as_json)
