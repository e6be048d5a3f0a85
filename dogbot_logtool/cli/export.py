"""The words of `export`."""

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    logs_argument,
    output_name,
    overwrite_option,
    quietness,
    scheduler_option,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.api.export import Export
    from dogbot_logtool.results import Measurement
    from dogbot_logtool.robot.options import StatsOptions
    from dogbot_logtool.run.inputs import LogSet

_STDOUT = "-"


@click.command()
@logs_argument
@click.option(
    "--table",
    type=click.Choice(["strides", "stances", "joints", "events", "base", "commands", "samples"]),
    help="What to write, a row each; samples are all messages of all feet; default: strides.",
)
@click.option(
    "-o",
    "--output",
    default=_STDOUT,
    metavar="FILE",
    help="File that ends in .csv, .parquet, .arrow or .feather. Default: CSV on stdout.",
)
@click.option(
    "--dataset",
    type=output_name,
    metavar="DIR|URL",
    help="Keep the metrics of many logs there, for SQL; logs that are there unchanged are skipped.",
)
@click.option(
    "--label",
    "labels",
    metavar="NAME=VALUE",
    multiple=True,
    help="With --dataset: a label for the logs of this call, such as firmware=3.2; can be given "
    "several times.",
)
@click.option(
    "--prune",
    is_flag=True,
    help="With --dataset: remove logs from there that are gone from where they were.",
)
@stats_options
@jobs_option
@scheduler_option
@overwrite_option
@quietness
def export(
    words: tuple[str, ...],
    table: str | None,
    output: str,
    dataset: str | None,
    labels: tuple[str, ...],
    measuring: "StatsOptions",
    jobs: int | None,
    scheduler: str | None,
    *,
    prune: bool,
    overwrite: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Write a table of strides, stances, events, poses or samples.

    The tables are those of a walk in Python, behind a column with the log's name. Several logs
    make one table. A dataset has tables of the metrics of many logs, to which later calls add.

    \b
    dogbot-logtool export walk.bag > strides.csv
    dogbot-logtool export walk.bag --table samples -o samples.parquet
    dogbot-logtool export recordings/ --dataset walks
    """  # noqa: D301 - click's own mark
    from dogbot_logtool.api.export import Export  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.report.table_file import table_file  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    del verbose
    chosen = replace(measuring, jobs=jobs_or_cores(jobs))
    _refuse_others(
        dataset,
        with_table={"--table": table, "-o": output != _STDOUT, "--overwrite": overwrite},
        with_dataset={"--label": labels, "--prune": prune, "--scheduler": scheduler},
    )
    if dataset is not None:
        from dogbot_logtool.cli.dataset import export_dataset  # noqa: PLC0415 - loads pyarrow

        export_dataset(words, dataset, chosen, labels, scheduler, prune=prune, quiet=quiet)
    table = table or "strides"
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
    with whole_file(target, overwrite=overwrite, is_wanted=lambda: outcomes.has_results) as file:
        work = Export(chosen, table, table_file(target.name, file))
        _run(work, log_set, outcomes)
        work.finish()
    outcomes.finish(as_json=False)


def _refuse_others(
    dataset: str | None, *, with_table: Mapping[str, object], with_dataset: Mapping[str, object]
) -> None:
    """Refuse options of a table with a dataset, and the other way round.

    Raises:
        CallError: one is given.
    """
    others = with_dataset if dataset is None else with_table
    for option in (name for name, given in others.items() if given):
        why = "goes with --dataset" if dataset is None else "goes without --dataset"
        raise CallError(f"{option} {why}")


def _run(work: "Export", log_set: "LogSet", outcomes: Outcomes) -> None:
    """Export all logs, one after the other."""
    from dogbot_logtool.run.runner import SerialRunner  # noqa: PLC0415

    runner: SerialRunner[Measurement] = SerialRunner(work.options.jobs)
    for _ in outcomes.of(runner, work, log_set.paths, log_set.names):
        outcomes.add({})
