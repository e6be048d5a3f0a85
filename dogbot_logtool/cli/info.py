"""The words of `info`."""

from typing import TYPE_CHECKING

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    join_logs,
    join_option,
    json_option,
    logs_argument,
    quiet_option,
    scheduler_option,
    topic_options,
)
from dogbot_logtool.cli.outcomes import Outcomes

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import TopicOptions


@click.command()
@logs_argument
@join_option
@topic_options
@click.option(
    "--frames",
    "all_frames",
    is_flag=True,
    help="Read every transform: rate, gaps and senders of each frame, and what breaks the tree.",
)
@jobs_option
@scheduler_option
@json_option
@quiet_option
def info(
    words: tuple[str, ...],
    topics: "TopicOptions",
    jobs: int | None,
    scheduler: str | None,
    *,
    join: bool,
    all_frames: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Show what is in a log, what is used of it, and what is wrong."""
    from dogbot_logtool.commands.tasks import Describe  # noqa: PLC0415
    from dogbot_logtool.report.info_report import info_json, print_info  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    log_set = find_logs(words, for_workers=scheduler is not None)
    log_set, topics = join_logs(log_set, topics, join=join)
    runner = runner_for("info", len(log_set.logs), jobs_or_cores(jobs), scheduler)
    describe = Describe(topics, all_frames=all_frames, jobs=runner.jobs)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    for found in outcomes.of(runner, describe, log_set.paths, log_set.names):
        outcomes.add(info_json(found))
        if not as_json:
            print_info(results(), found)
    outcomes.finish(as_json=as_json)
