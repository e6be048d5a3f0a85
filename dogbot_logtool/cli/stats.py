"""The words of `stats`."""

import sys
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.api.keywords import LONGEST_S
from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    join_logs,
    join_option,
    json_option,
    logs_argument,
    output_file,
    output_name,
    overwrite_option,
    quietness,
    scheduler_option,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import printable

if TYPE_CHECKING:
    from dogbot_logtool.commands.tasks import Measure
    from dogbot_logtool.io.storage import Location
    from dogbot_logtool.pipeline.options import PlotOptions, StatsOptions
    from dogbot_logtool.results import Figures
    from dogbot_logtool.run.inputs import LogSet
    from dogbot_logtool.run.runner import Runner


@click.command()
@logs_argument
@join_option
@stats_options
@click.option(
    "--window",
    metavar="FROM:TO",
    help="Seconds since the log's start that the gait diagram and --plot show.",
)
@click.option(
    "--plot",
    type=output_file,
    metavar="FILE",
    help="Draw gait diagram and load curves as .pdf, .svg or .png, for a paper.",
)
@click.option(
    "--plot-size",
    metavar="WIDTH[xHEIGHT]",
    help="Size of the figure in mm; default: 85, and as high as the feet need.",
)
@overwrite_option
@click.option("--csv", "as_csv", is_flag=True, help="Print a row for each stride of each foot.")
@click.option(
    "--events",
    type=output_file,
    metavar="FILE",
    help="Write what happened there: .csv, .tsv (BIDS) a row for each event, .yaml (EUROBENCH) the "
    "steps of two feet.",
)
@click.option(
    "--parquet",
    type=output_name,
    metavar="DIR|URL",
    help="Keep the figures of all logs there, for SQL; logs that are there unchanged are skipped.",
)
@click.option(
    "--label",
    "labels",
    metavar="NAME=VALUE",
    multiple=True,
    help="With --parquet: a column of `logs` for the logs of this call, such as firmware=3.2; can "
    "be given several times.",
)
@click.option(
    "--prune",
    is_flag=True,
    help="With --parquet: remove logs from there that are gone from where they were.",
)
@jobs_option
@scheduler_option
@json_option
@quietness
def stats(
    words: tuple[str, ...],
    measuring: "StatsOptions",
    window: str | None,
    events: Path | None,
    parquet: str | None,
    labels: tuple[str, ...],
    plot: Path | None,
    plot_size: str | None,
    jobs: int | None,
    scheduler: str | None,
    *,
    prune: bool,
    join: bool,
    overwrite: bool,
    as_csv: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Measure a walk: gait, loads, and whether to trust the log."""
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415
    from dogbot_logtool.core.contact.curves import CurveDetail  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    _refuse_both(("--csv", as_csv), ("--json", as_json))
    _refuse_both(("--join", join), ("--parquet", parquet is not None))
    _refuse_without_parquet(parquet, labels, prune=prune)
    shown = _parse_window(window)
    log_set = find_logs(words, for_workers=scheduler is not None)
    log_set, topics = join_logs(log_set, measuring.topics, join=join)
    chosen = replace(measuring, topics=topics, curves=CurveDetail() if plot else None)
    drawing = _plot_options(plot, plot_size, shown, log_set.paths, overwrite=overwrite)
    if overwrite and plot is None and events is None:
        raise CallError("--overwrite goes with --plot and --events")
    _refuse_bad_events_file(events, log_set.paths, parquet, overwrite=overwrite)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    call = None
    if parquet is not None:
        from dogbot_logtool.cli.dataset import DatasetCall  # noqa: PLC0415 - loads pyarrow

        call = DatasetCall(parquet, chosen, labels, log_set, prune=prune)
        outcomes.add_unchanged(call.pending.unchanged)
        log_set = call.pending.log_set
    runner = runner_for("stats", len(log_set.logs), jobs_or_cores(jobs), scheduler)
    whole = len(log_set.logs) == 1 and call is None
    measure = Measure(replace(chosen, jobs=runner.jobs), drawing, whole=whole, window=shown)
    wanted = as_json or as_csv or drawing is not None
    measured: list[Figures] = []
    with closing(
        _measure(outcomes, runner, measure, log_set)
        if call is None
        else call.measure(outcomes, runner, measure, keeps_figures=wanted)
    ) as all_figures:
        for done in all_figures:
            if drawing is not None and done.drawn is not None and not quiet:
                _print_drawn(drawing.target, done.drawn)
            _write_events(events, done, overwrite=overwrite)
            measured.append(done)
    if as_csv:
        from dogbot_logtool.report.files.stats_csv import write_strides  # noqa: PLC0415

        write_strides(sys.stdout, [(done.json["log"]["path"], done.strides) for done in measured])
    elif not as_json and measured and call is None:
        _print(measured, window=shown, verbose=verbose)
    if call is not None and not quiet:
        call.print_done(len(outcomes.failures))
    outcomes.finish(as_json=as_json)


def _measure(
    outcomes: Outcomes, runner: "Runner[Any]", measure: "Measure", log_set: "LogSet"
) -> "Generator[Figures, None, None]":
    """Measure all logs; yield their figures."""
    for done in outcomes.of(runner, measure, log_set.paths, log_set.names):
        outcomes.add(done.json, done.exit_code)
        yield done


def _refuse_both(one: tuple[str, bool], other: tuple[str, bool]) -> None:
    if one[1] and other[1]:
        raise CallError(f"{one[0]} and {other[0]}: choose one")


def _plot_options(
    plot: Path | None,
    plot_size: str | None,
    window: tuple[float, float] | None,
    logs: "Sequence[Location]",
    *,
    overwrite: bool,
) -> "PlotOptions | None":
    """Return what is asked of a figure, checked before any work is done."""
    size = _parse_size(plot_size)
    if plot is None:
        if plot_size:
            raise CallError("--plot-size goes with --plot")
        return None
    from dogbot_logtool.commands.plot import refuse_bad_plot  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import PlotOptions  # noqa: PLC0415

    drawing = PlotOptions(plot, size, window, overwrite=overwrite)
    refuse_bad_plot(drawing, logs)
    return drawing


def _refuse_without_parquet(parquet: str | None, labels: tuple[str, ...], *, prune: bool) -> None:
    if parquet is None and (labels or prune):
        raise CallError("--label and --prune go with --parquet")


def _refuse_bad_events_file(
    target: Path | None, logs: "Sequence[Location]", parquet: str | None, *, overwrite: bool
) -> None:
    """Check the file of --events, if it is wanted, before any work is done."""
    if target is None:
        return
    from dogbot_logtool.commands.events_file import refuse_bad_events_file  # noqa: PLC0415

    if parquet is not None:
        raise CallError("--events and --parquet: choose one; the dataset has the events, too")
    refuse_bad_events_file(target, logs, overwrite=overwrite)


def _write_events(target: Path | None, done: "Figures", *, overwrite: bool) -> None:
    """Write the file of --events, if it is wanted."""
    if target is not None:
        from dogbot_logtool.commands.events_file import write_events_file  # noqa: PLC0415

        write_events_file(target, done.json, overwrite=overwrite)


def _print_drawn(target: Path, window: tuple[float, float]) -> None:
    """Print which time a figure shows."""
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    start, end = window
    print_sentence(diagnostics(), printable(f"{target}: {start:.2f} to {end:.2f} s"))


def _print(measured: "list[Figures]", *, window: tuple[float, float] | None, verbose: bool) -> None:
    """Print the report of one log, or a summary of several."""
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.text.stats_text import print_report, print_summary  # noqa: PLC0415

    one = measured[0].whole
    if one is not None:
        print_report(results(), one.stats, one.facts, window=window, verbose=verbose)
    else:
        print_summary(results(), [done.summary for done in measured])


def _parse_window(window: str | None) -> tuple[float, float] | None:
    if window is None:
        return None
    start, _, end = window.partition(":")
    try:
        limits = float(start), float(end)
    except ValueError:
        limits = 0.0, 0.0
    if not -LONGEST_S <= limits[0] < limits[1] <= LONGEST_S:
        raise CallError(f"--window {window}: must be FROM:TO in seconds, such as 2:4.5")
    return limits


def _parse_size(size: str | None) -> tuple[float, float | None] | None:
    if size is None:
        return None
    width, times, height = size.partition("x")
    try:
        sides = [float(each) for each in ([width, height] if times else [width])]
    except ValueError:
        sides = []
    if not sides or not all(10.0 <= side <= 1000.0 for side in sides):
        raise CallError(f"--plot-size {size}: must be WIDTH or WIDTHxHEIGHT in mm, such as 85x60")
    return sides[0], sides[1] if times else None
