"""The words of `convert`."""

from pathlib import Path
from typing import Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    json_option,
    logs_argument,
    number,
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
    help="File, or a directory for several logs; default: <log>.annotated.mcap here.",
)
@click.option(
    "--style",
    type=click.Choice(["classic", "pressure", "force"]),
    default="pressure",
    show_default=True,
    help="Arrows: as arrows_rviz.py drew them, load straight up, or the force itself.",
)
@click.option(
    "--encoding",
    type=click.Choice(["foxglove", "ros1", "ros2"]),
    default="foxglove",
    show_default=True,
    help="Messages that are added: Foxglove's, or ROS markers and transforms.",
)
@click.option(
    "--copy/--no-copy", default=True, show_default=True, help="Copy the recorded messages too."
)
@topic_options
@wrench_frame_option
@click.option(
    "--tf",
    type=click.Choice(["auto", "always", "never"]),
    default="auto",
    show_default=True,
    help="Write /tf; auto does not if the log places the base otherwise.",
)
@click.option(
    "--tf-rate",
    "tf_rate_hz",
    type=number(1e-3, 1e6, or_zero=True),
    default="50",
    show_default=True,
    metavar="HZ",
    help="Transforms a second; 0 writes every odometry message.",
)
@click.option(
    "--scene/--no-scene",
    default=None,
    help="Draw what the robot stands on in /support; default: yes, but not in classic.",
)
@time_range
@click.option(
    "--compression",
    type=click.Choice(["zstd", "lz4", "none"]),
    help="Of the output; default: zstd, and chunks copied from an MCAP as they are.",
)
@jobs_option
@overwrite_option
@click.option("--strict", is_flag=True, help="Refuse damaged logs instead of salvaging them.")
@json_option
@quietness
def convert(
    logs: tuple[Path, ...],
    output: Path | None,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    jobs: int | None,
    *,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Write an annotated MCAP: /tf, arrows and loads of the feet, /support, and the log itself."""
    from dogbot_logtool.convert import convert as convert_log  # noqa: PLC0415
    from dogbot_logtool.plan import ConvertOptions  # noqa: PLC0415
    from dogbot_logtool.report.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.report.convert_report import (  # noqa: PLC0415
        conversion_json,
        print_conversion,
    )
    from dogbot_logtool.report.progress import progress_bar  # noqa: PLC0415
    from dogbot_logtool.writer.output import targets  # noqa: PLC0415

    topics = parse_topics(robot, odom_topic, feet, mass_kg)
    chosen = ConvertOptions(topics=topics, jobs=threads(jobs), **options)
    console = diagnostics()
    outcomes = Outcomes()
    for source, target in targets(logs, output, ".annotated.mcap"):
        with outcomes.of(source):
            with progress_bar(source.name, shown=not quiet) as progress:
                done = convert_log(source, target, chosen, progress)
            outcomes.add(conversion_json(done), done.exit_code)
            if not quiet:
                print_conversion(console, done, verbose=verbose)
    outcomes.finish(as_json=as_json)
