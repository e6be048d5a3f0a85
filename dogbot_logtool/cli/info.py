"""The words of `info`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    join_logs,
    join_option,
    json_option,
    logs_argument,
    output_file,
    overwrite_option,
    quiet_option,
    scheduler_option,
    topic_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import TopicOptions


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
@click.option("--dot", is_flag=True, help="Print the frame tree for Graphviz instead of the rest.")
@click.option(
    "-o",
    "--output",
    type=output_file,
    metavar="FILE",
    help="Where --dot writes; default: stdout.",
)
@overwrite_option
@jobs_option
@scheduler_option
@json_option
@quiet_option
def info(
    words: tuple[str, ...],
    topics: "TopicOptions",
    output: Path | None,
    jobs: int | None,
    scheduler: str | None,
    *,
    join: bool,
    all_frames: bool,
    dot: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Show what is in a log, what is used of it, and what is wrong."""
    from dogbot_logtool.commands.tasks import Describe  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.io.targets import refuse_other_format  # noqa: PLC0415
    from dogbot_logtool.report.documents.frames_dot import frames_dot  # noqa: PLC0415
    from dogbot_logtool.report.info_report import info_json, print_info  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    if dot and as_json:
        raise CallError("--dot and --json: choose one")
    log_set = find_logs(words, for_workers=scheduler is not None)
    log_set, topics = join_logs(log_set, topics, join=join)
    if output is not None:
        if not dot:
            raise CallError("-o says where --dot writes; without --dot results go to stdout")
        refuse_other_format(output, ".dot")
        for source in log_set.paths:
            refuse_bad_target(output, source, overwrite=overwrite)
    runner = runner_for("info", len(log_set.logs), jobs_or_cores(jobs), scheduler)
    describe = Describe(topics, all_frames=all_frames or dot, jobs=runner.jobs)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    graphs: list[str] = []
    for found in outcomes.of(runner, describe, log_set.paths, log_set.names):
        outcomes.add(info_json(found), found.exit_code)
        if found.frames is not None and dot:
            graphs.append(frames_dot(found, found.frames))
        elif not as_json:
            print_info(results(), found)
    if output is not None and graphs:
        with whole_file(output, overwrite=overwrite) as file:
            file.write("".join(graphs).encode())
    else:
        click.echo("".join(graphs), nl=False)
    outcomes.finish(as_json=as_json)
