"""The options of all commands, declared once: a field is an option, the string below it its help.

A command's record inherits the groups that it shares with others; its docstring is the text of its
``--help``. Fields without `As` are no options: commands set them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from dogbot_logtool.option import LONGEST_S, As, Range

if TYPE_CHECKING:
    from dogbot_logtool.io.storage import Location
    from dogbot_logtool.reader.foot import Foot

Flag = Annotated[bool, As()]
File = Annotated[Path | None, As("FILE")]
Target = Annotated[str | None, As("FILE")]
"""A file to write."""
Globs = Annotated[Sequence[str], As("GLOB")]
Seconds = Annotated[float | None, As("S", range=Range(-LONGEST_S, LONGEST_S))]
Pairs = Mapping[str, Any] | None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RobotOptions:
    """Which robot it is, and where its feet and its base are found."""

    robot: Annotated[str | None, As("NAME|FILE.toml")] = None
    """Known robot or a robot's file; default: guessed from the topics."""
    mass: Annotated[float | None, As("KG", range=Range(1e-3, 1e6))] = None
    """Mass of the robot."""
    urdf: File = None
    """Description of the robot, of its legs above all; default: the log's own."""
    foot: Annotated[Pairs, As("NAME=TOPIC[:FIELD]")] = None
    """Contact topic of a foot, or a field of any message (/feet:data[3]); repeatable."""
    odom_topic: Annotated[str | None, As("TOPIC[:WHICH]")] = None
    """Poses of the base: odometry, poses, /tf:odom/base_link, /gazebo/model_states:MODEL,
    TOPIC:FIELD."""
    set: Annotated[Pairs, As("FIELD=VALUE")] = None
    """A field of the robot's file for this call: contact_on_n=20, wrench_frame=link,
    tare.front_left=0,0,-12; repeatable."""
    feet: "tuple[Foot, ...]" = ()
    """Feet that were found in the log; none: the robot's."""
    joined: "tuple[Location, ...]" = ()
    """Further files of the same recording, merged with the log by time."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JoinOptions:
    """Files of one recording."""

    join: Flag = False
    """The logs are files of one recording (a split series, one bag a sensor): merge them by
    time."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SpanOptions:
    """A part of the log."""

    start: Seconds = None
    """From here on, s since the log's start."""
    end: Seconds = None
    """Up to here, s since the log's start."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JobOptions:
    """How much is done at once."""

    jobs: Annotated[int, As("N", range=Range(1, 256, is_whole=True))] = 1
    """Processes at work; default: all cores, in Python 1. The result is the same."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class MeasureOptions(JobOptions, SpanOptions, JoinOptions, RobotOptions):
    """Options of all that measures."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class QuietOptions:
    """How much is printed."""

    quiet: Annotated[bool, As(short="-q")] = False
    """Print results and errors only."""
    verbose: Annotated[bool, As(short="-v")] = False
    """Print notes, causes of nulls and lists too."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CommonOptions(QuietOptions):
    """What all commands with a result have."""

    json: Flag = False
    """Print the result as JSON on stdout."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LogOptions(QuietOptions):
    """The logs of a call."""

    logs: Annotated[tuple[str, ...], As("LOG...", is_argument=True, is_required=True)] = ()
    """Files, directories, globs, @LIST or URLs."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ClusterOptions:
    """Work on other machines."""

    scheduler: Annotated[str | None, As("ADDRESS")] = None
    """Use the workers of dask.distributed, such as tcp://host:8786."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class OutputOptions:
    """What is written."""

    output: Annotated[str | None, As("OUT", "-o")] = None
    """File, or a directory (ends in /, or several logs); default: named after the log, here."""
    overwrite: Flag = False
    """Replace the output if it exists."""


COMMANDS: Final = (
    *("info", "convert", "stats", "report", "check", "export", "compare", "layout", "robots"),
)
"""The commands, in the order of the work."""


def record_of(command: str) -> type:
    """Return the record of a command's options, whose module is loaded now."""
    module = import_module(f"{__name__}.{command}")
    record: type = getattr(module, command.capitalize())
    return record
