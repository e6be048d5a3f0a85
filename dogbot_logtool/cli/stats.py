"""The words of `stats`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.cli.options import (
    LONGEST_S,
    jobs_option,
    json_option,
    logs_argument,
    measuring_options,
    overwrite_option,
    parse_topics,
    quietness,
    threads,
    time_range,
    topic_options,
    wrench_frame_option,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.core.walk_stats import Stats
    from dogbot_logtool.report.stats_json import LogFacts


@click.command()
@logs_argument
@topic_options
@wrench_frame_option
@measuring_options
@time_range
@click.option(
    "--window",
    metavar="FROM:TO",
    help="Seconds since the log's start that the gait diagram and --plot show.",
)
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
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
@jobs_option
@json_option
@quietness
def stats(
    logs: tuple[Path, ...],
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    window: str | None,
    plot: Path | None,
    plot_size: str | None,
    jobs: int | None,
    *,
    overwrite: bool,
    as_csv: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Measure a walk: which gait, how loaded, and can the recording be trusted."""
    from dogbot_logtool.core.curves import CurveDetail  # noqa: PLC0415
    from dogbot_logtool.plot import PlotOptions, refuse_bad_plot, write_plot  # noqa: PLC0415
    from dogbot_logtool.report.progress import progress_bar  # noqa: PLC0415
    from dogbot_logtool.report.stats_csv import write_strides  # noqa: PLC0415
    from dogbot_logtool.report.stats_json import stats_json  # noqa: PLC0415
    from dogbot_logtool.stats import Measurement, StatsOptions, measure  # noqa: PLC0415

    if as_csv and as_json:
        raise CallError("--csv and --json: choose one")
    shown = _parse_window(window)
    topics = parse_topics(robot, odom_topic, feet, mass_kg)
    chosen = StatsOptions(
        topics=topics, jobs=threads(jobs), curves=CurveDetail() if plot else None, **options
    )
    size = _parse_size(plot_size)
    drawing = PlotOptions(plot, size, shown, overwrite=overwrite) if plot else None
    if drawing is not None:
        refuse_bad_plot(drawing, logs)
    elif plot_size or overwrite:
        raise CallError("--plot-size and --overwrite go with --plot")
    outcomes = Outcomes()
    measured: list[Measurement] = []
    for source in logs:
        with outcomes.of(source):
            with progress_bar(source.name, shown=not quiet) as progress:
                done = measure(source, chosen, progress)
                if drawing is not None:
                    start, end = write_plot(source, chosen, done, drawing, progress)
            if drawing is not None and not quiet:
                click.echo(f"{drawing.target}: {start:.2f} to {end:.2f} s", err=True)
            measured.append(done)
            outcomes.add(stats_json(done.stats, done.facts), done.exit_code)
    pairs = [(done.stats, done.facts) for done in measured]
    if as_csv:
        write_strides(sys.stdout, pairs)
    elif not as_json and pairs:
        _print(pairs, window=shown, verbose=verbose)
    outcomes.finish(as_json=as_json)


def _print(
    measured: "list[tuple[Stats, LogFacts]]", *, window: tuple[float, float] | None, verbose: bool
) -> None:
    """Print the report of one log, or a summary of several."""
    from dogbot_logtool.report.console import results  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.stats_text import print_report, print_summary  # noqa: PLC0415

    if len(measured) == 1:
        print_report(results(), *measured[0], window=window, verbose=verbose)
    else:
        print_summary(results(), measured)


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
