"""The words of `convert`."""

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import click

from dogbot_logtool.api.keywords import CHOICES, ConvertKeywords, convert_options
from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    join_logs,
    join_option,
    json_option,
    logs_argument,
    number,
    overwrite_option,
    quietness,
    scheduler_option,
    tared_topic_options,
    time_range,
    wrench_frame_option,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.core.scene.styles import ARROW_STYLES, DEFAULT_STYLE, ArrowStyle
from dogbot_logtool.writer.encodings.registry import DEFAULT_ENCODING, ENCODINGS, OutputEncoding

if TYPE_CHECKING:
    from dogbot_logtool.results import Conversion
    from dogbot_logtool.robot.options import TopicOptions


def _summaries(entries: Iterable[ArrowStyle | OutputEncoding]) -> str:
    """Return the names of a registry and what they mean."""
    return ", ".join(f"{each.name} ({each.summary})" for each in entries)


@click.command()
@logs_argument
@join_option
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="File, or a directory (ends in /, or several logs) or URL; default: "
    "<log>.annotated.mcap here.",
)
@click.option(
    "--style",
    type=click.Choice(CHOICES["style"]),
    default=DEFAULT_STYLE,
    show_default=True,
    help=f"Arrows: {_summaries(ARROW_STYLES.values())}.",
)
@click.option(
    "--encoding",
    type=click.Choice(CHOICES["encoding"]),
    default=DEFAULT_ENCODING,
    show_default=True,
    help=f"Messages that are added: {_summaries(ENCODINGS.values())}.",
)
@click.option(
    "--copy/--no-copy", default=True, show_default=True, help="Copy the recorded messages too."
)
@tared_topic_options
@wrench_frame_option
@click.option(
    "--topics",
    "copied_topics",
    multiple=True,
    metavar="GLOB",
    help="Copy only these recorded topics; may be given several times. Annotations stay.",
)
@click.option(
    "--without",
    multiple=True,
    metavar="GLOB",
    help="Do not copy these recorded topics, such as '/camera/*'; may be given several times.",
)
@click.option(
    "--tf",
    type=click.Choice(CHOICES["tf"]),
    default="auto",
    show_default=True,
    help="Write /tf; auto does not if the log places the base otherwise.",
)
@click.option(
    "--tf-rate",
    type=number("tf_rate"),
    default="50",
    show_default=True,
    metavar="HZ",
    help="Transforms a second; 0 writes every odometry message.",
)
@time_range
@click.option(
    "--compression",
    type=click.Choice(CHOICES["compression"]),
    help="Of the output; default: zstd, and chunks copied from an MCAP as they are.",
)
@jobs_option
@scheduler_option
@overwrite_option
@json_option
@quietness
def convert(
    words: tuple[str, ...],
    output: str | None,
    topics: "TopicOptions",
    jobs: int | None,
    scheduler: str | None,
    copied_topics: tuple[str, ...],
    *,
    join: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words are the keywords
) -> None:
    """Write an annotated MCAP: the log, arrows, loads and events.

    The topics that are added: /tf, an arrow, a label and /load for each foot, /support, /legs,
    /events, /gait and /robot_description.
    """
    from dogbot_logtool.commands.tasks import Convert, conversion_tasks  # noqa: PLC0415
    from dogbot_logtool.io.storage import from_root  # noqa: PLC0415
    from dogbot_logtool.io.targets import may_be_several, output_at, targets  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    log_set = find_logs(words, for_workers=scheduler is not None)
    log_set, topics = join_logs(log_set, topics, join=join)
    several = not join and may_be_several(words, log_set.paths)
    where = output_at(output, ".annotated.mcap", several=several)
    if scheduler is not None:
        where = replace(where, path=from_root(where.path))
    pairs = targets(log_set.paths, where, ".annotated.mcap", log_set.below)
    runner = runner_for("convert", len(pairs), jobs_or_cores(jobs), scheduler)
    given = cast("ConvertKeywords", {**options, "topics": copied_topics, "jobs": runner.jobs})
    chosen = replace(convert_options(given), topics=topics, makes_folder=where.is_folder)
    work = conversion_tasks(pairs, may_repeat=runner.may_repeat)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    for done in outcomes.of(runner, Convert(chosen), work, log_set.names):
        outcomes.add(_as_json(done) if as_json else {})
        if not quiet:
            _print(done, verbose=verbose)
    outcomes.finish(as_json=as_json)


def _as_json(done: "Conversion") -> dict[str, Any]:
    from dogbot_logtool.report.documents import conversion_json  # noqa: PLC0415

    return conversion_json(done)


def _print(done: "Conversion", *, verbose: bool) -> None:
    """Print the summary of one log."""
    from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.text.conversion_text import print_conversion  # noqa: PLC0415

    print_conversion(diagnostics(), done, verbose=verbose)
