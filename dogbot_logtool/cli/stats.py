"""The words of `stats`."""

from collections.abc import Sequence
from dataclasses import replace
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
    quietness,
    scheduler_option,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import printable

if TYPE_CHECKING:
    from dogbot_logtool.io.storage import Location
    from dogbot_logtool.results import Figures
    from dogbot_logtool.robot.options import PlotOptions, StatsOptions


@click.command()
@logs_argument
@join_option
@stats_options
@click.option(
    "--figure",
    type=output_file,
    metavar="FILE",
    help="Draw gait diagram and load curves as .pdf, .svg or .png, for a paper.",
)
@overwrite_option
@jobs_option
@scheduler_option
@json_option
@quietness
def stats(
    words: tuple[str, ...],
    measuring: "StatsOptions",
    figure: Path | None,
    jobs: int | None,
    scheduler: str | None,
    *,
    join: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Measure a walk: gait, loads, and whether to trust the log."""
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    log_set = find_logs(words, for_workers=scheduler is not None)
    log_set, topics = join_logs(log_set, measuring.topics, join=join)
    chosen = replace(measuring, topics=topics)
    if overwrite and figure is None:
        raise CallError("--overwrite goes with --figure")
    drawing = _drawing(figure, log_set.paths, overwrite=overwrite)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    runner = runner_for("stats", len(log_set.logs), jobs_or_cores(jobs), scheduler)
    measure = Measure(
        replace(chosen, jobs=runner.jobs),
        drawing,
        whole=len(log_set.logs) == 1,
        as_json=as_json,
        detail=verbose,
    )
    measured: list[Figures] = []
    for done in outcomes.of(runner, measure, log_set.paths, log_set.names):
        outcomes.add(done.json)
        if drawing is not None and done.drawn is not None and not quiet:
            _print_drawn(drawing.target, done.drawn)
        measured.append(done)
    if not as_json and measured:
        _print(measured, verbose=verbose)
    outcomes.finish(as_json=as_json)


def _drawing(
    target: Path | None, logs: "Sequence[Location]", *, overwrite: bool
) -> "PlotOptions | None":
    """Return what is asked of a figure, checked before any work is done."""
    if target is None:
        return None
    from dogbot_logtool.commands.plot import refuse_bad_plot  # noqa: PLC0415
    from dogbot_logtool.robot.options import PlotOptions  # noqa: PLC0415

    drawing = PlotOptions(target, overwrite=overwrite)
    refuse_bad_plot(drawing, logs)
    return drawing


def _print_drawn(target: Path, window: tuple[float, float]) -> None:
    """Print which time a figure shows."""
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    start, end = window
    print_sentence(diagnostics(), printable(f"{target}: {start:.2f} to {end:.2f} s"))


def _print(measured: "list[Figures]", *, verbose: bool) -> None:
    """Print the report of one log, or a summary of several."""
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.text.stats_text import print_report, print_summary  # noqa: PLC0415

    one = measured[0].whole
    if one is not None:
        print_report(results(), one, verbose=verbose)
    else:
        rows, damage = zip(*((done.summary, done.damage) for done in measured), strict=True)
        print_summary(results(), rows, damage)
