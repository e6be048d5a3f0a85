"""The words of `convert`."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    json_option,
    logs_argument,
    number,
    overwrite_option,
    parse_topics,
    quietness,
    scheduler_option,
    time_range,
    topic_options,
    wrench_frame_option,
)
from dogbot_logtool.cli.outcomes import Outcomes

if TYPE_CHECKING:
    from dogbot_logtool.results import Conversion


@click.command()
@logs_argument
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="File, or a directory (ends in /, or several logs) or URL; default: "
    "<log>.annotated.mcap here.",
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
@scheduler_option
@overwrite_option
@click.option("--strict", is_flag=True, help="Refuse damaged logs instead of salvaging them.")
@json_option
@quietness
def convert(
    words: tuple[str, ...],
    output: str | None,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    jobs: int | None,
    scheduler: str | None,
    *,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Write an annotated MCAP: /tf, arrows and loads of the feet, /support, and the log itself."""
    from dogbot_logtool.commands.tasks import Convert, orders  # noqa: PLC0415
    from dogbot_logtool.io.storage import from_root  # noqa: PLC0415
    from dogbot_logtool.io.targets import may_be_several, output_at, targets  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import ConvertOptions  # noqa: PLC0415
    from dogbot_logtool.report.convert_json import conversion_json  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    topics = parse_topics(robot, odom_topic, feet, mass_kg)
    fleet = find_logs(words, for_workers=scheduler is not None)
    several = may_be_several(words, fleet.places)
    where = output_at(output, ".annotated.mcap", several=several)
    if scheduler is not None:
        where = replace(where, place=from_root(where.place))
    pairs = targets(fleet.places, where, ".annotated.mcap", fleet.below)
    runner = runner_for(len(pairs), jobs_or_cores(jobs), scheduler)
    chosen = ConvertOptions(
        topics=topics, jobs=runner.jobs, makes_folder=where.is_folder, **options
    )
    work = orders(pairs, may_repeat=runner.may_repeat)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(fleet)
    for done in outcomes.of(runner, Convert(chosen), work, fleet.names):
        outcomes.add(conversion_json(done), done.exit_code)
        if not quiet:
            _print(done, verbose=verbose)
    outcomes.finish(as_json=as_json)


def _print(done: "Conversion", *, verbose: bool) -> None:
    """Print the summary of one log."""
    from dogbot_logtool.report.console import diagnostics  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.convert_text import print_conversion  # noqa: PLC0415

    print_conversion(diagnostics(), done, verbose=verbose)
