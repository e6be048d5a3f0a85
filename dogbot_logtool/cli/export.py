"""The words of `export`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    logs_argument,
    measuring_options,
    output_name,
    overwrite_option,
    parse_topics,
    quietness,
    tare_option,
    time_range,
    topic_options,
    wrench_frame_option,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.api.export import Export
    from dogbot_logtool.run.inputs import LogSet

_STDOUT = "-"


@click.command()
@logs_argument
@click.option(
    "--table",
    type=click.Choice(["strides", "stances", "joints", "events", "base", "samples"]),
    default="strides",
    show_default=True,
    help="What to write, a row each; samples are all messages of all feet.",
)
@click.option(
    "-o",
    "--output",
    default=_STDOUT,
    metavar="FILE",
    help="File that ends in .csv, .parquet, .arrow or .feather; default: CSV on stdout.",
)
@topic_options
@tare_option
@wrench_frame_option
@measuring_options
@time_range
@jobs_option
@overwrite_option
@quietness
def export(
    words: tuple[str, ...],
    table: str,
    output: str,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    tares: tuple[str, ...],
    jobs: int | None,
    *,
    overwrite: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    r"""Write strides, stances, events, poses or contact samples as a table.

    The tables are those of a walk in Python, behind a column with the log's name. Several logs
    make one table.

    \b
    dogbot-logtool export walk.bag > strides.csv
    dogbot-logtool export walk.bag --table samples -o samples.parquet
    """
    from dogbot_logtool.api.export import Export  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415
    from dogbot_logtool.report.table_file import table_file  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    del verbose
    topics = parse_topics(robot, odom_topic, feet, mass_kg, tares)
    chosen = StatsOptions(topics=topics, jobs=jobs_or_cores(jobs), **options)
    log_set = find_logs(words)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    if output == _STDOUT:
        if overwrite:
            raise CallError("--overwrite goes with -o FILE")
        _run(Export(chosen, table, table_file("stdout.csv", sys.stdout.buffer)), log_set, outcomes)
        outcomes.finish(as_json=False)
    target = Path(output_name(output))
    for log in log_set.paths:
        refuse_bad_target(target, log, overwrite=overwrite)
    written: list[int] = []
    with whole_file(target, overwrite=overwrite, is_wanted=lambda: bool(written)) as file:
        work = Export(chosen, table, table_file(target.name, file))
        written.extend(_run(work, log_set, outcomes))
        work.file.finish()
    outcomes.finish(as_json=False)


def _run(work: "Export", log_set: "LogSet", outcomes: Outcomes) -> list[int]:
    """Export all logs, one after the other; return the exit codes of those that were measured."""
    from dogbot_logtool.run.runner import SerialRunner  # noqa: PLC0415

    runner: SerialRunner[int] = SerialRunner(work.options.jobs)
    codes = []
    for code in outcomes.of(runner, work, log_set.paths, log_set.names):
        outcomes.add({}, code)
        codes.append(code)
    return codes
