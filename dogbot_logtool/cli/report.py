"""The words of `report`."""

from pathlib import Path
from typing import Any

import click

from dogbot_logtool.cli.options import (
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


@click.command()
@logs_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="OUT",
    help="File, or a directory for several logs; default: <log>.report.html here.",
)
@topic_options
@wrench_frame_option
@measuring_options
@time_range
@jobs_option
@overwrite_option
@json_option
@quietness
def report(
    logs: tuple[Path, ...],
    output: Path | None,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    jobs: int | None,
    *,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Write a page that shows what happened: gait, loads, path, and what to doubt.

    One HTML file a log, which opens from disk and loads nothing. Several logs also give an
    index.html with a row each. Needs the extra: pip install 'dogbot-logtool[report]'.
    """
    from dogbot_logtool.report.page.libraries import require_libraries  # noqa: PLC0415

    require_libraries()
    from dogbot_logtool.page import Reports  # noqa: PLC0415
    from dogbot_logtool.report.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.report.page.told import page_json, print_page  # noqa: PLC0415
    from dogbot_logtool.report.progress import progress_bar  # noqa: PLC0415
    from dogbot_logtool.stats import StatsOptions  # noqa: PLC0415

    topics = parse_topics(robot, odom_topic, feet, mass_kg)
    chosen = StatsOptions(topics=topics, jobs=threads(jobs), **options)
    console = diagnostics()
    outcomes = Outcomes()
    reports = Reports(logs, output, chosen, overwrite=overwrite)
    for source in logs:
        with outcomes.of(source):
            with progress_bar(source.name, shown=not quiet) as progress:
                done = reports.write(source, progress)
            outcomes.add(page_json(done), done.exit_code)
            if not quiet:
                print_page(console, done, verbose=verbose)
    reports.finish()
    outcomes.finish(as_json=as_json)
