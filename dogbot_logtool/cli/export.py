"""The words of `export`."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    logs_argument,
    output_name,
    overwrite_option,
    quietness,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.api.export import Export, ExportLabels
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.run.inputs import LogSet

_STDOUT = "-"


@click.command()
@logs_argument
@click.option(
    "--table",
    type=click.Choice(["strides", "stances", "joints", "events", "base", "commands", "samples"]),
    default="strides",
    show_default=True,
    help="What to write, a row each; samples are all messages of all feet.",
)
@click.option(
    "-o",
    "--output",
    default=_STDOUT,
    metavar="FILE",
    help="File that ends in .csv, .parquet, .arrow or .feather; for the events of one log also "
    ".tsv (BIDS) or .yaml (EUROBENCH). Default: CSV on stdout.",
)
@stats_options
@jobs_option
@overwrite_option
@quietness
def export(
    words: tuple[str, ...],
    table: str,
    output: str,
    measuring: "StatsOptions",
    jobs: int | None,
    *,
    overwrite: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    r"""Write a table of strides, stances, events, poses or samples.

    The tables are those of a walk in Python, behind a column with the log's name. Several logs
    make one table.

    \b
    dogbot-logtool export walk.bag > strides.csv
    dogbot-logtool export walk.bag --table samples -o samples.parquet
    """
    from dogbot_logtool.api.export import Export  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.report.files.table_file import table_file  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    del verbose
    chosen = replace(measuring, jobs=jobs_or_cores(jobs))
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
        work = _work(chosen, table, target, file, log_set)
        written.extend(_run(work, log_set, outcomes))
        work.finish()
    outcomes.finish(as_json=False)


def _work(
    options: "StatsOptions", table: str, target: Path, file: BinaryIO, log_set: "LogSet"
) -> "Export | ExportLabels":
    """Return what writes the table of each log in the format that the file's name tells.

    Raises:
        CallError: the name tells none, or one that cannot hold what is asked for.
    """
    from dogbot_logtool.api.export import Export, ExportLabels  # noqa: PLC0415
    from dogbot_logtool.report.files.event_files import LABELLED  # noqa: PLC0415
    from dogbot_logtool.report.files.table_file import table_file  # noqa: PLC0415

    suffix = target.suffix.lower()
    if suffix not in LABELLED:
        return Export(options, table, table_file(target.name, file))
    if table != "events":
        raise CallError(f"{target}: {suffix} holds events only: --table events")
    if (count := len(log_set.paths)) != 1:
        raise CallError(
            f"{target}: {suffix} holds the events of one log, and there are {count}: "
            "export them one by one, or all to .csv"
        )
    return ExportLabels(options, suffix, file)


def _run(work: "Export | ExportLabels", log_set: "LogSet", outcomes: Outcomes) -> list[int]:
    """Export all logs, one after the other; return the exit codes of those that were measured."""
    from dogbot_logtool.run.runner import SerialRunner  # noqa: PLC0415

    runner: SerialRunner[int] = SerialRunner(work.options.jobs)
    codes = []
    for code in outcomes.of(runner, work, log_set.paths, log_set.names):
        outcomes.add({}, code)
        codes.append(code)
    return codes
