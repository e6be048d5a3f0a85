"""Options that several commands share."""

import math
import os
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar, cast

import click

from dogbot_logtool.api import keywords
from dogbot_logtool.api.keywords import CHOICES, NUMBERS, MeasureKeywords, RobotKeywords
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import TopicOptions
    from dogbot_logtool.run.inputs import LogSet

_FEWEST_JOINED: Final = 2
_MEASURING: Final = MeasureKeywords.__optional_keys__ - RobotKeywords.__optional_keys__ - {"jobs"}
"""Options that `stats_options` adds, beside those of the robot."""


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


def number(option: str) -> Callable[[str], float]:
    """Return a parser of the numbers that an option may be."""
    wanted = NUMBERS[option]

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not wanted.has(value):
            raise click.BadParameter(f"{text!r} is not {wanted}.")
        return value

    parse.__name__ = "number"  # what --help shows for it
    return parse


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
    type=click.IntRange(1, 256),
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
    type=click.Choice(CHOICES["wrench_frame"]),
    default="auto",
    show_default=True,
    help="Frame of the recorded wrenches; auto decides by evidence.",
)


def together(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Return what adds several options, in this order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def number_option(name: str, metavar: str, words: str) -> Callable[[Command], Command]:
    """Return an option whose keyword is a number; see `number`."""
    keyword = name.removeprefix("--").replace("-", "_")
    return click.option(name, type=number(keyword), metavar=metavar, help=words)


quiet_option: Final = click.option(
    "-q", "--quiet", is_flag=True, help="Print results and errors only."
)
quietness: Final = together(
    quiet_option,
    click.option("-v", "--verbose", is_flag=True, help="Print more."),
)
time_range: Final = together(
    number_option("--start", "S", "From here on; s since the log's start, not negative."),
    number_option("--end", "S", "Up to here; s since the log's start."),
)
_measuring_options: Final = together(
    click.option(
        "--forward-axis",
        type=click.Choice(CHOICES["forward_axis"]),
        help="Body axis that points forward; default: the robot's.",
    ),
    number_option(
        "--contact-on",
        "N",
        "Force from which a foot is in contact; default: a share of the weight.",
    ),
    number_option(
        "--contact-off", "N", "Force below which contact ends; default: a share of the weight."
    ),
    number_option(
        "--debounce",
        "S",
        "Shorter swings are filled, then shorter stances dropped; default: 0.020 or 1.5 of the "
        "foot's sampling intervals, whichever is longer, and for swings also 1/16 of the foot's "
        "usual one.",
    ),
    click.option(
        "--time-source",
        type=click.Choice(CHOICES["time_source"]),
        help="Clock to measure on; default: header stamps, log time where those cannot be used.",
    ),
    click.option(
        "--command",
        metavar="TOPIC",
        help="Topic of the velocity commands, instead of the one found.",
    ),
    click.option(
        "--imu",
        metavar="TOPIC",
        help="Topic of the base's inertial unit, instead of the one found.",
    ),
)
"""What decides the figures."""


def topic_options(command: Command) -> Command:
    """Add what tells of robot and topics; the command gets `TopicOptions` as `topics`."""
    options = together(
        click.option(
            "--robot",
            metavar="NAME|FILE.toml",
            help="Known robot or a robot's file; default: guessed from the log's topics.",
        ),
        click.option(
            "--odom-topic",
            metavar="TOPIC[:WHICH]",
            help="Topic of the base's poses, instead of the one found: odometry, poses, robot "
            "states; also /tf:odom/base_link, /gazebo/model_states:MODEL, or TOPIC:FIELD.",
        ),
        click.option(
            "--foot",
            multiple=True,
            metavar="NAME=TOPIC[:FIELD]",
            help="Contact topic of a foot, or a field of any message (/feet:data[3]); may be given "
            "several times.",
        ),
        number_option("--mass", "KG", "Mass of the robot."),
        click.option(
            "--urdf",
            type=click.Path(path_type=Path),
            metavar="FILE",
            help="Description of the robot, of its legs above all; default: the log's own.",
        ),
    )
    return options(_with_topics(command))


def tared_topic_options(command: Command) -> Command:
    """Add `topic_options` and --tare."""
    tare = click.option(
        "--tare",
        multiple=True,
        metavar="FOOT=FX,FY,FZ",
        help="Force in N that an unloaded sensor reads; may be given several times; none: "
        "offsets stay in. Default: the robot's, else estimated from the log.",
    )
    return topic_options(tare(command))


def _with_topics(command: Command) -> Command:
    """Hand a command `TopicOptions` instead of the words about the robot."""

    @wraps(command)
    def with_topics(
        foot: tuple[str, ...],
        tare: tuple[str, ...] = (),
        **words: Any,  # noqa: ANN401 - click's words
    ) -> object:
        given: RobotKeywords = {"foot": _parse_feet(foot)}
        if tare:
            given["tare"] = _parse_tares(tare)
        for name in ("robot", "odom_topic", "mass", "urdf"):
            given[name] = words.pop(name)
        given = keywords.checked(given, RobotKeywords)
        return command(topics=keywords.topic_options(given), **words)

    return cast("Command", with_topics)


def stats_options(command: Command) -> Command:
    """Add all that decides the figures; the command gets `StatsOptions` as `measuring`."""

    @wraps(command)
    def with_options(topics: "TopicOptions", **words: Any) -> object:  # noqa: ANN401 - click's words
        names = words.keys() & _MEASURING
        given = cast("MeasureKeywords", {name: words.pop(name) for name in names})
        return command(measuring=replace(keywords.stats_options(given), topics=topics), **words)

    deciding = _measuring_options(time_range(cast("Command", with_options)))
    return tared_topic_options(wrench_frame_option(deciding))


def join_logs(
    log_set: "LogSet", topics: "TopicOptions", *, join: bool
) -> "tuple[LogSet, TopicOptions]":
    """Make one log of all that were named, if that is wanted."""
    if not join or len(log_set.logs) < _FEWEST_JOINED:
        return log_set, topics
    first, *others = log_set.logs
    joined = tuple(other.path for other in others)
    return replace(log_set, logs=(first,)), replace(topics, joined=joined)


def _parse_feet(feet: tuple[str, ...]) -> dict[str, str]:
    """Return the topics of feet.

    Raises:
        CallError: words are no NAME=TOPIC, or name a foot twice.
    """
    topics: dict[str, str] = {}
    for foot in feet:
        name, equals, topic = foot.partition("=")
        if not (name and equals and topic):
            raise CallError(f"--foot {foot}: must be NAME=TOPIC, such as front_left=/fl/contacts")
        if name in topics:
            raise CallError(f"--foot {name}: is given twice; a foot has one topic")
        topics[name] = topic
    return topics


def _parse_tares(
    tares: tuple[str, ...],
) -> "dict[str, tuple[float, float, float]] | Literal['none']":
    """Return what unloaded sensors read, by foot.

    Raises:
        CallError: words are no FOOT=FX,FY,FZ, or ``none`` stands beside others.
    """
    if "none" not in tares:
        return dict(map(_parse_tare, tares))
    if set(tares) != {"none"}:
        raise CallError("--tare none: goes with no other --tare")
    return "none"


def _parse_tare(tare: str) -> tuple[str, tuple[float, float, float]]:
    foot, _, numbers = tare.partition("=")
    try:
        x, y, z = map(float, numbers.split(","))
    except ValueError:
        x = y = z = math.nan
    if not foot or not all(keywords.OFFSET.has(part) for part in (x, y, z)):
        raise CallError(f"--tare {tare}: must be FOOT=FX,FY,FZ in newtons, such as left=3,-2,-60")
    return foot, (x, y, z)


def jobs_or_cores(jobs: int | None) -> int:
    """Return how much to do at once: what was asked for, else as much as there are cores."""
    if jobs is not None:
        return jobs
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
