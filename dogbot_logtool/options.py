"""The options of all commands, declared once: a field is an option, the string below it its help.

A command's record inherits the groups that it shares with others; its docstring is the text of its
``--help``. Fields without `As` are no options: commands set them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

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

# Groups


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
class BaselineOptions(MeasureOptions):
    """Options of `check` beside its limits."""

    baseline: Annotated[Path | None, As("FILE.json")] = None
    """`stats --json` of the run that rules with `baseline` compare with."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class InfoOptions(JobOptions, JoinOptions, RobotOptions):
    """Options of `info`."""

    frames: Flag = False
    """Read every transform: rate, gaps and senders of each frame, and what breaks the tree."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ConvertOptions(MeasureOptions):
    """Options of `convert`."""

    style: Annotated[str, As(choices=("pressure", "force", "classic"))] = "pressure"
    """Arrows: the load straight up, the force itself, or as arrows_rviz.py drew them."""
    encoding: Annotated[str, As(choices=("foxglove", "ros1", "ros2"))] = "foxglove"
    """Messages that are added: protobuf for Foxglove and Lichtblick, ROS 1 (RViz), or CDR."""
    copy: Flag = True
    """Copy the recorded messages too."""
    topics: Globs = ()
    """Copy only these recorded topics, or all but '!/camera/*'; repeatable. Annotations stay."""
    tf: Annotated[Literal["auto", "always", "never"], As()] = "auto"
    """Write /tf; auto: unless the log places the base otherwise."""
    tf_rate: Annotated[float, As("HZ", range=Range(1e-3, 1e6, or_zero=True))] = 50.0
    """Transforms a second; 0: every pose."""
    compression: Annotated[Literal["zstd", "lz4", "none"] | None, As()] = None
    """Of the output; default: zstd, and chunks copied from an MCAP as they are."""
    overwrite: Flag = False
    """Replace the output if it exists."""
    makes_folder: bool = False
    """Whether the output's directory is made if it is missing."""

    @property
    def copied_topics(self) -> tuple[str, ...]:
        """Globs of the topics that are copied; none: all."""
        return tuple(glob for glob in self.topics if not glob.startswith("!"))

    @property
    def topics_left_out(self) -> tuple[str, ...]:
        """Globs of the topics that are not copied."""
        return tuple(glob[1:] for glob in self.topics if glob.startswith("!"))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CompareOptions:
    """Options of `compare` without --gait."""

    atol: Annotated[float | None, As("NUMBER", range=Range(0.0, 1e300))] = None
    """Absolute tolerance, in each field's own unit; default: 0."""
    rtol: Annotated[float | None, As("NUMBER", range=Range(0.0, 1.0))] = None
    """Relative tolerance; default: 0."""
    tolerances: Annotated[Path | None, As("FILE.toml")] = None
    """Tolerances by quantity: metres, radians, newtons ..."""
    ignore: Annotated[Sequence[str], As("TOPIC|FIELD")] = ()
    """Glob of what may differ: topics, fields, TOPIC:FIELD, metadata:NAME, attachment:NAME."""
    topics: Annotated[Sequence[str], As("TOPIC")] = ()
    """Glob of the topics to compare; of JSON, of the keys at its top (gait, feet)."""
    max_differences: Annotated[int, As("N", range=Range(0, 1e9, is_whole=True))] = 20
    """Differences that are printed one by one."""


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


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JunitOptions:
    """A report for CI."""

    junit: Target = None
    """Write JUnit XML as well, to a new file."""
    overwrite: Flag = False
    """Replace the file of --junit if it exists."""


# Commands


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Info(LogOptions, ClusterOptions, InfoOptions, CommonOptions):
    """Show what is in a log, what is used of it, and what is wrong.

    Example: dogbot-logtool info walk.bag
    """


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Convert(LogOptions, ClusterOptions, OutputOptions, ConvertOptions, CommonOptions):
    """Write an annotated MCAP: the log, arrows, loads and events.

    The topics that are added: /tf, an arrow, a label and /load for each foot, /support, /legs,
    /events, /gait and /robot_description.

    Examples:
      dogbot-logtool convert walk.bag -o walk.mcap
      dogbot-logtool convert logs/*.bag -o annotated/
      dogbot-logtool convert walk.bag --topics '!/camera/*'
    """


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Stats(LogOptions, ClusterOptions, MeasureOptions, CommonOptions):
    """Measure a walk: gait, loads, and whether to trust the log.

    Examples:
      dogbot-logtool stats walk.bag
      dogbot-logtool stats logs/*.bag              a row each
      dogbot-logtool stats walk.bag --figure walk.pdf
      dogbot-logtool stats walk.bag --set contact_on_n=20
    """

    figure: Target = None
    """Draw gait diagram and load curves as .pdf, .svg or .png, for a paper."""
    overwrite: Flag = False
    """Replace the figure if it exists."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Report(LogOptions, OutputOptions, MeasureOptions, CommonOptions):
    """Write a page: the walk in 3D, gait, loads, and what to doubt.

    One HTML file a log, which opens from disk and loads nothing; several logs also give an
    index.html. With --against, one page says whether two runs, or two groups of runs, can be
    compared, and which metrics differ. Needs the extra `report`.

    Examples:
      dogbot-logtool report walk.bag
      dogbot-logtool report walk.bag --against yesterday.bag
    """

    against: Annotated[tuple[str, ...], As("LOG")] = ()
    """Other logs (directory, glob, @LIST): one page shows both sides and what differs."""
    replay: Flag = True
    """Show the walk in 3D, which takes up to a megabyte."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Check(LogOptions, ClusterOptions, JunitOptions, BaselineOptions, CommonOptions):
    """Judge logs by rules: each is GOOD, WARN, FAIL or UNKNOWN.

    A rule names a metric of `stats --json`, a finding or an event, by a pattern, and what is
    demanded of it.

    Exit code 0: all rules are kept; 1: one is broken, or a metric is unknown where its rule does
    not allow that; 2: the call or the limits are wrong; 3: kept, but a log is damaged.

    Examples:
      dogbot-logtool check good/*.bag --suggest > limits.toml
      dogbot-logtool check walk.bag --limits limits.toml
    """

    limits: Annotated[Path | None, As("FILE.toml")] = None
    """Rules on metrics, findings and events."""
    suggest: Flag = False
    """Print limits that these runs pass, as a file to edit."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Export(LogOptions, ClusterOptions, OutputOptions, MeasureOptions):
    """Write a table of strides, stances, events, poses or samples.

    The tables are those of a walk in Python, behind a column with the log's name. Several logs
    make one table. A dataset has tables of the metrics of many logs, to which later calls add.

    Examples:
      dogbot-logtool export walk.bag > strides.csv
      dogbot-logtool export walk.bag --table samples -o samples.parquet
      dogbot-logtool export recordings/ --dataset walks
    """

    table: Annotated[
        Literal["strides", "stances", "joints", "events", "base", "commands", "samples"] | None,
        As(),
    ] = None
    """What a row is; samples are all messages of all feet; default: strides."""
    output: Annotated[str | None, As("FILE", "-o")] = None
    """File that ends in .csv, .parquet, .arrow or .feather; default: CSV on stdout."""
    dataset: Annotated[str | None, As("DIR|URL")] = None
    """Keep the metrics of many logs there, for SQL; logs that are there unchanged are skipped."""
    label: Annotated[tuple[str, ...], As("NAME=VALUE")] = ()
    """With --dataset: a label for the logs of this call, such as firmware=3.2; repeatable."""
    prune: Flag = False
    """With --dataset: remove logs from there that are gone from where they were."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Compare(JunitOptions, JobOptions, RobotOptions, CompareOptions, CommonOptions):
    """Compare two logs, or two `stats --json` files, with tolerances.

    A field is named by its path without positions: pose.position.x, feet.front_left.slip_m. A
    glob's * stands for dots and slashes, too. Integers are
    exact unless a tolerance names them. That nothing is left to compare is a wrong call.

    With --gait, either side is a log, a directory, a glob or @LIST; its strides are compared metric
    by metric, with intervals. Exit code 0: the same; 1: different, not comparable, or a file
    cannot be read; 2: the call is wrong; 3: the same as far as can be read, but a file is damaged.

    Examples:
      dogbot-logtool compare expected.mcap actual.mcap --atol 1e-6
      dogbot-logtool compare --gait yesterday.bag today.bag
    """

    expected: Annotated[str, As("EXPECTED", is_argument=True, is_required=True)] = ""
    actual: Annotated[str, As("ACTUAL", is_argument=True, is_required=True)] = ""
    gait: Flag = False
    """Compare how the robot walks in two logs, or groups of logs: which metrics differ?"""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Layout(OutputOptions, RobotOptions, QuietOptions):
    """Print a viewer's layout: the robot, its loads, its gait diagram.

    The feet are those of the robot (default: dogbot), or those found in LOG.

    Example: dogbot-logtool layout walk.bag -o walk.json
    """

    log: Annotated[str | None, As("[LOG]", is_argument=True)] = None
    viewer: Annotated[str, As(choices=("foxglove", "rviz"))] = "foxglove"
    """foxglove: Foxglove and Lichtblick; rviz: for logs converted with --encoding ros1."""
    output: Annotated[str | None, As("FILE", "-o")] = None
    """The file to write; default: stdout."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Robots(OutputOptions, JoinOptions, RobotOptions, CommonOptions):
    """List the known robots, or print one's file to copy and edit.

    `robots new LOG` writes a robot's file from a log, with the evidence as comments. Feet are
    looked for in messages of any type.

    Examples:
      dogbot-logtool robots dogbot > mine.toml
      dogbot-logtool robots new walk.bag -o mine.toml
    """

    words: Annotated[tuple[str, ...], As("[NAME | new LOG...]", is_argument=True)] = ()
    output: Annotated[str | None, As("FILE.toml", "-o")] = None
    """Of new; default: stdout."""


COMMANDS: "tuple[type, ...]" = (
    Info,
    Convert,
    Stats,
    Report,
    Check,
    Export,
    Compare,
    Layout,
    Robots,
)
"""The commands, in the order of the work."""
