"""Options that several commands share."""

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.selection import TopicOptions

_LONGEST_S: Final = 1e9


class Seconds(click.ParamType):
    """A finite number of seconds."""

    name = "seconds"

    def convert(
        self,
        value: Any,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> float:
        """See `click.ParamType.convert`."""
        try:
            seconds = float(value)
        except ValueError:
            seconds = math.nan
        if not abs(seconds) <= _LONGEST_S:
            self.fail(f"{value!r} is not a number of seconds", param, ctx)
        return seconds


class Positive(click.ParamType):
    """A number above 0 within reason, or 0 where that means something."""

    name = "number"

    def __init__(self, least: float, most: float, *, zero: bool = False) -> None:
        self._least, self._most, self._zero = least, most, zero

    def convert(
        self,
        value: Any,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> float:
        """See `click.ParamType.convert`."""
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not (self._least <= number <= self._most or (self._zero and number == 0)):
            zero = "0, or " if self._zero else ""
            wanted = f"{zero}a number from {self._least:g} to {self._most:g}"
            self.fail(f"{value!r} is not {wanted}", param, ctx)
        return number


Command = TypeVar("Command", bound=Callable[..., Any])

logs_argument: Final = click.argument(
    "logs", nargs=-1, required=True, metavar="LOG...", type=click.Path(path_type=Path)
)
json_option: Final = click.option(
    "--json", "as_json", is_flag=True, help="Print the result as JSON on stdout."
)
jobs_option: Final = click.option(
    "--jobs",
    type=click.IntRange(min=1, max=256),
    help="Threads; default: as many as there are cores. The result is the same.",
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
        type=Seconds(),
        metavar="S",
        help="From here on; s since the log's start.",
    )
    end = click.option(
        "--end", "end_s", type=Seconds(), metavar="S", help="Up to here; s since the log's start."
    )
    return start(end(command))


def topic_options(command: Command) -> Command:
    """Add --robot, --odom-topic, --foot and --mass."""
    robot = click.option(
        "--robot",
        metavar="NAME|FILE.toml",
        help="Known robot or a robot's file; default: told by the log's topics.",
    )
    odometry = click.option(
        "--odom-topic", metavar="TOPIC", help="Odometry topic, instead of the one found."
    )
    feet = click.option(
        "--foot",
        "feet",
        multiple=True,
        metavar="NAME=TOPIC",
        help="Contact topic of a foot; may be given several times.",
    )
    mass = click.option(
        "--mass", "mass_kg", type=Positive(1e-3, 1e6), metavar="KG", help="Mass of the robot."
    )
    return robot(odometry(feet(mass(command))))


def parse_topics(
    robot: str | None, odom_topic: str | None, feet: tuple[str, ...], mass_kg: float | None
) -> "TopicOptions":
    """Check the words of `topic_options`.

    Raises:
        CallError: naming the option and what it must be.
    """
    from dogbot_logtool.selection import TopicOptions  # noqa: PLC0415

    foot_topics: dict[str, str] = {}
    for foot in feet:
        name, equals, topic = foot.partition("=")
        if not (name and equals and topic):
            raise CallError(f"--foot {foot}: must be NAME=TOPIC, such as front_left=/fl/contacts")
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {foot}: a foot's name has letters, digits and _ only")
        foot_topics[name] = topic
    return TopicOptions(robot, odom_topic, foot_topics, mass_kg)


def threads(jobs: int | None) -> int:
    """Return how many threads to use: what was asked for, else the cores there are."""
    if jobs is not None:
        return jobs
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
