"""Options that several commands share."""

import math
import os
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import TopicOptions
    from dogbot_logtool.run.inputs import LogSet

LONGEST_S: Final = 1e9
"""No log lasts longer."""

_FEWEST_JOINED: Final = 2
_MEASURING: Final = (
    *("topics", "wrench_frame", "forward_axis", "contact_on_n", "contact_off_n", "debounce_s"),
    *("time_source", "start_s", "end_s", "command_topic", "imu_topic"),
)
"""What `stats_options` adds; fields of `StatsOptions`."""
_STRONGEST_N: Final = 1e6
"""N; no sensor reads more without load."""


def seconds(text: str) -> float:
    """Parse a number of seconds; NaN and what no log can last are refused."""
    return _number(text, -LONGEST_S, LONGEST_S, "a number of seconds")


def output_name(text: str) -> str:
    """Parse the name of what is to be written; no name and stdout are refused.

    Raises:
        CallError: it is one of them.
    """
    from dogbot_logtool.io.targets import refuse_no_name  # noqa: PLC0415

    refuse_no_name(text)
    return text


def output_file(text: str) -> Path:
    """Parse the name of a file to be written; a directory is refused, too.

    Raises:
        CallError: see `output_name`; or it is a directory's name.
    """
    from dogbot_logtool.io.targets import ends_in_slash  # noqa: PLC0415

    if ends_in_slash(output_name(text)):
        raise CallError(f"{text}: is a directory's name; name a file in it")
    return Path(text)


def number(least: float, most: float, *, or_zero: bool = False) -> Callable[[str], float]:
    """Return a parser of numbers in a range, or 0 where that means something."""
    wanted = f"a number from {least:g} to {most:g}" + (", or 0" if or_zero else "")

    def parse(text: str) -> float:
        return (
            0.0 if or_zero and text.strip() in {"0", "0.0"} else _number(text, least, most, wanted)
        )

    parse.__name__ = "number"  # what --help shows for it
    return parse


def _number(text: str, least: float, most: float, wanted: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not least <= value <= most:
        raise click.BadParameter(f"{text!r} is not {wanted}.")
    return value


Command = TypeVar("Command", bound=Callable[..., Any])

logs_argument: Final = click.argument("words", nargs=-1, required=True, metavar="LOG...", type=str)
join_option: Final = click.option(
    "--join",
    is_flag=True,
    help="The logs are files of one recording (a split series, one bag a sensor): merge them by "
    "time. What is made is named after the first.",
)
json_option: Final = click.option(
    "--json", "as_json", is_flag=True, help="Print the result as JSON on stdout."
)
jobs_option: Final = click.option(
    "--jobs",
    type=click.IntRange(min=1, max=256),
    metavar="N",
    help="Processes at work; default: as many as there are cores. The result is the same.",
)
scheduler_option: Final = click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Have the workers of dask.distributed do it; such as tcp://host:8786.",
)
junit_option: Final = click.option(
    "--junit", type=output_file, metavar="FILE", help="Write JUnit XML as well, to a new file."
)
junit_overwrite_option: Final = click.option(
    "--overwrite", is_flag=True, help="Replace the file of --junit if it exists already."
)
overwrite_option: Final = click.option(
    "--overwrite", is_flag=True, help="Replace the output if it exists."
)
wrench_frame_option: Final = click.option(
    "--wrench-frame",
    type=click.Choice(["auto", "world", "link"]),
    default="auto",
    show_default=True,
    help="Frame of the recorded wrenches; auto decides by evidence.",
)


def quietness(command: Command) -> Command:
    """Add --quiet and --verbose."""
    quiet = click.option("-q", "--quiet", is_flag=True, help="Print results and errors only.")
    verbose = click.option("-v", "--verbose", is_flag=True, help="Print more.")
    return quiet(verbose(command))


def time_range(command: Command) -> Command:
    """Add --start and --end."""
    start = click.option(
        "--start",
        "start_s",
        type=seconds,
        metavar="S",
        help="From here on; s since the log's start, not negative.",
    )
    end = click.option(
        "--end", "end_s", type=seconds, metavar="S", help="Up to here; s since the log's start."
    )
    return start(end(command))


def _measuring_options(command: Command) -> Command:
    """Add what decides the figures: --forward-axis, --contact-on and so on."""
    axis = click.option(
        "--forward-axis",
        type=click.Choice(["+x", "-x", "+y", "-y"]),
        help="Body axis that points forward; default: the robot's.",
    )
    contact_on = click.option(
        "--contact-on",
        "contact_on_n",
        type=number(1e-6, 1e6),
        metavar="N",
        help="Force from which a foot is in contact; default: a share of the weight.",
    )
    contact_off = click.option(
        "--contact-off",
        "contact_off_n",
        type=number(1e-6, 1e6),
        metavar="N",
        help="Force below which contact ends; default: a share of the weight.",
    )
    debounce = click.option(
        "--debounce",
        "debounce_s",
        type=number(1e-9, 10.0, or_zero=True),
        metavar="S",
        help="Shorter swings are filled, then shorter stances dropped; default: 0.020.",
    )
    clock = click.option(
        "--time-source",
        type=click.Choice(["header", "log"]),
        help="Clock to measure on; default: header stamps, log time where those cannot be used.",
    )
    twist = click.option(
        "--command",
        "command_topic",
        metavar="TOPIC",
        help="Topic of the velocity commands, instead of the one found.",
    )
    imu = click.option(
        "--imu",
        "imu_topic",
        metavar="TOPIC",
        help="Topic of the base's inertial unit, instead of the one found.",
    )
    return axis(contact_on(contact_off(debounce(clock(twist(imu(command)))))))


def topic_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --robot, --odom-topic, --foot and --mass; the command gets `TopicOptions` as `topics`."""
    robot = click.option(
        "--robot",
        metavar="NAME|FILE.toml",
        help="Known robot or a robot's file; default: guessed from the log's topics.",
    )
    odometry = click.option(
        "--odom-topic",
        metavar="TOPIC[:WHICH]",
        help="Topic of the base's poses, instead of the one found: odometry, poses, robot states; "
        "also /tf:odom/base_link, /gazebo/model_states:MODEL, or TOPIC:FIELD.",
    )
    feet = click.option(
        "--foot",
        "feet",
        multiple=True,
        metavar="NAME=TOPIC[:FIELD]",
        help="Contact topic of a foot, or a field of any message (/feet:data[3]); may be given "
        "several times.",
    )
    mass = click.option(
        "--mass", "mass_kg", type=number(1e-3, 1e6), metavar="KG", help="Mass of the robot."
    )

    @wraps(command)
    def with_topics(
        robot: str | None,
        odom_topic: str | None,
        feet: tuple[str, ...],
        mass_kg: float | None,
        **others: Any,  # noqa: ANN401 - click's words
    ) -> object:
        return command(topics=_parse_topics(robot, odom_topic, feet, mass_kg), **others)

    return robot(odometry(feet(mass(with_topics))))


def tared_topic_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `topic_options` and --tare."""
    tare = click.option(
        "--tare",
        "tares",
        multiple=True,
        metavar="FOOT=FX,FY,FZ",
        help="Force in N that an unloaded sensor reads; may be given several times; none: "
        "offsets stay in. Default: the robot's, else estimated from the log.",
    )

    @wraps(command)
    def with_tares(
        topics: "TopicOptions",
        tares: tuple[str, ...],
        **others: Any,  # noqa: ANN401 - click's words
    ) -> object:
        return command(topics=_with_tares(topics, tares), **others)

    return topic_options(tare(with_tares))


def stats_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add all that decides the figures; the command gets `StatsOptions` as `measuring`."""

    @wraps(command)
    def with_options(**words: Any) -> object:  # noqa: ANN401 - click's words
        from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415

        measuring = StatsOptions(**{name: words.pop(name) for name in _MEASURING})
        return command(measuring=measuring, **words)

    return tared_topic_options(wrench_frame_option(_measuring_options(time_range(with_options))))


def join_logs(
    log_set: "LogSet", topics: "TopicOptions", *, join: bool
) -> "tuple[LogSet, TopicOptions]":
    """Make one log of all that were named, if that is wanted."""
    if not join or len(log_set.logs) < _FEWEST_JOINED:
        return log_set, topics
    first, *others = log_set.logs
    joined = tuple(other.path for other in others)
    return replace(log_set, logs=(first,)), replace(topics, joined=joined)


def _parse_topics(
    robot: str | None, odom_topic: str | None, feet: tuple[str, ...], mass_kg: float | None
) -> "TopicOptions":
    """Check the words of `topic_options`.

    Raises:
        CallError: naming the option and what it must be.
    """
    from dogbot_logtool.pipeline.options import TopicOptions  # noqa: PLC0415

    foot_topics: dict[str, str] = {}
    for foot in feet:
        name, equals, topic = foot.partition("=")
        if not (name and equals and topic):
            raise CallError(f"--foot {foot}: must be NAME=TOPIC, such as front_left=/fl/contacts")
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {foot}: a foot's name has letters, digits and _ only")
        if foot_topics.setdefault(name, topic) != topic or feet.count(foot) > 1:
            raise CallError(f"--foot {name}: is given twice; a foot has one topic")
    return TopicOptions(robot, odom_topic, foot_topics or None, mass_kg)


def _with_tares(topics: "TopicOptions", tares: tuple[str, ...]) -> "TopicOptions":
    """Add the words of --tare.

    Raises:
        CallError: they are no FOOT=FX,FY,FZ, or ``none`` stands beside others.
    """
    if not tares:
        return topics
    given = tuple(tare for tare in tares if tare != "none")
    if given and len(given) < len(tares):
        raise CallError("--tare none: goes with no other --tare")
    offsets_n = dict(_parse_tare(tare) for tare in given)
    return replace(topics, offsets_n=offsets_n, takes_offsets="none" not in tares)


def _parse_tare(tare: str) -> tuple[str, tuple[float, float, float]]:
    """Return a foot and what its unloaded sensor reads.

    Raises:
        CallError: the words are no FOOT=FX,FY,FZ.
    """
    foot, _, numbers = tare.partition("=")
    try:
        x, y, z = map(float, numbers.split(","))
    except ValueError:
        x = y = z = math.nan
    if not foot or not all(abs(part) <= _STRONGEST_N for part in (x, y, z)):
        raise CallError(f"--tare {tare}: must be FOOT=FX,FY,FZ in newtons, such as left=3,-2,-60")
    return foot, (x, y, z)


def jobs_or_cores(jobs: int | None) -> int:
    """Return how much to do at once: what was asked for, else as much as there are cores."""
    if jobs is not None:
        return jobs
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
