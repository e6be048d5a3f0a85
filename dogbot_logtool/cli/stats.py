"""The words of `stats`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    json_option,
    logs_argument,
    number,
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
@click.option(
    "--forward-axis",
    type=click.Choice(["+x", "-x", "+y", "-y"]),
    help="Body axis that points forward; default: the robot's.",
)
@click.option(
    "--contact-on",
    "contact_on_n",
    type=number(1e-6, 1e6),
    metavar="N",
    help="Force from which a foot is in contact; default: 10 N or 5 % of the body weight.",
)
@click.option(
    "--contact-off",
    "contact_off_n",
    type=number(1e-6, 1e6),
    metavar="N",
    help="Force below which contact ends; default: when the sensor reports no contact.",
)
@click.option(
    "--debounce",
    "debounce_s",
    type=number(1e-9, 10.0, or_zero=True),
    metavar="S",
    help="Shorter swings are filled, then shorter stances dropped; default: 0.020.",
)
@click.option(
    "--time-source",
    type=click.Choice(["header", "log"]),
    help="Clock to measure on; default: header stamps, log time where those cannot be used.",
)
@time_range
@click.option(
    "--window",
    metavar="FROM:TO",
    help="Seconds since the log's start that the gait diagram shows.",
)
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
    jobs: int | None,
    *,
    as_csv: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Measure a walk: which gait, how loaded, and can the recording be trusted."""
    from dogbot_logtool.report.progress import progress_bar  # noqa: PLC0415
    from dogbot_logtool.report.stats_csv import write_strides  # noqa: PLC0415
    from dogbot_logtool.report.stats_json import stats_json  # noqa: PLC0415
    from dogbot_logtool.stats import Measurement, StatsOptions, measure  # noqa: PLC0415

    if as_csv and as_json:
        raise CallError("--csv and --json: choose one")
    shown = _parse_window(window)
    topics = parse_topics(robot, odom_topic, feet, mass_kg)
    chosen = StatsOptions(topics=topics, jobs=threads(jobs), **options)
    outcomes = Outcomes()
    measured: list[Measurement] = []
    for source in logs:
        with outcomes.of(source):
            with progress_bar(source.name, shown=not quiet) as progress:
                done = measure(source, chosen, progress)
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
    if not limits[0] < limits[1]:
        raise CallError(f"--window {window}: must be FROM:TO in seconds, such as 2:4.5")
    return limits
