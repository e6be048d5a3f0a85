"""Options by the names of the command line, checked; the commands take theirs from here, too."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypedDict, TypeVar, cast, get_args

from dogbot_logtool.core.scene.styles import ARROW_STYLES, DEFAULT_STYLE
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import location
from dogbot_logtool.robot.options import (
    ConvertOptions,
    StatsOptions,
    TfOption,
    TimeSourceOption,
    TopicOptions,
    WrenchFrameOption,
)
from dogbot_logtool.writer.encodings.registry import DEFAULT_ENCODING, ENCODINGS

if TYPE_CHECKING:
    from dogbot_logtool.writer.chunks import Compression

PathOrName = str | os.PathLike[str]
"""A file, the directory of a ROS 2 bag, or a URL."""
ForwardAxis = Literal["+x", "-x", "+y", "-y"]
LONGEST_S: Final = 1e9
"""No log lasts longer."""


class RobotKeywords(TypedDict, total=False):
    """Which robot it is, and where its feet and its base are found."""

    robot: PathOrName
    """Name of a known robot, or a TOML file; default: guessed from the log's topics."""
    odom_topic: str
    """Topic of the base's poses."""
    foot: Mapping[str, str]
    """Topic by foot, and the field where one is named: ``/feet:data[3]``."""
    mass: float
    """kg."""
    tare: Mapping[str, tuple[float, float, float]] | Literal["none"]
    """N, what a foot's unloaded sensor reads; ``"none"``: offsets stay in; default: estimated."""
    urdf: PathOrName
    """The robot's description; default: the log's own, if it has one."""
    join: Sequence[PathOrName]
    """Further files of the same recording, merged with the log by time."""


class MeasureKeywords(RobotKeywords, total=False):
    """Options of `measure` and of all that measures."""

    wrench_frame: WrenchFrameOption
    forward_axis: ForwardAxis
    contact_on: float
    """N, also `contact_off`."""
    contact_off: float
    debounce: float
    """s."""
    time_source: TimeSourceOption
    command: str
    """Topic of the velocity commands; default: found by type and name. Likewise `imu`."""
    imu: str
    start: float
    """s since the log's start, also `end`."""
    end: float
    jobs: int
    """Batches that are worked on at once; default: 1."""


class ConvertKeywords(RobotKeywords, total=False):
    """Options of `convert`."""

    style: Literal["classic", "pressure", "force"]
    encoding: Literal["foxglove", "ros1", "ros2"]
    copy: bool
    topics: Sequence[str]
    """Globs of the recorded topics that are copied."""
    without: Sequence[str]
    """Globs of the recorded topics that are not."""
    wrench_frame: WrenchFrameOption
    tf: TfOption
    tf_rate: float
    """Hz; 0 writes every pose."""
    start: float
    """s since the log's start, also `end`."""
    end: float
    compression: "Compression"
    jobs: int
    overwrite: bool


@dataclass(frozen=True, slots=True)
class Range:
    """The numbers that an option may be."""

    least: float
    most: float
    or_zero: bool = False
    """Whether 0 means something."""
    is_whole: bool = False

    @property
    def kind(self) -> Callable[[Any], float]:
        """Makes one of Python's own numbers of any that it has."""
        return int if self.is_whole else float

    def has(self, value: object) -> bool:
        """Tell whether a value is one of them; NaN is none."""
        if isinstance(value, bool) or not isinstance(value, Integral if self.is_whole else Real):
            return False
        return self.least <= float(value) <= self.most or (self.or_zero and value == 0)

    def __str__(self) -> str:
        if self.most == LONGEST_S:
            return "a number of seconds"
        number = "a whole number" if self.is_whole else "a number"
        return f"{number} from {self.least:g} to {self.most:g}{', or 0' if self.or_zero else ''}"


_SECONDS: Final = Range(-LONGEST_S, LONGEST_S)
_FORCE: Final = Range(1e-6, 1e6)
OFFSET: Final = Range(-1e6, 1e6)
"""N, along one axis; no sensor reads more without load."""
_AXES: Final = 3
NUMBERS: Final[Mapping[str, Range]] = MappingProxyType(
    {
        "mass": Range(1e-3, 1e6),
        "contact_on": _FORCE,
        "contact_off": _FORCE,
        "debounce": Range(1e-9, 10.0, or_zero=True),
        "tf_rate": Range(1e-3, 1e6, or_zero=True),
        "start": _SECONDS,
        "end": _SECONDS,
        "jobs": Range(1, 256, is_whole=True),
        "atol": Range(0.0, 1e300),
        "rtol": Range(0.0, 1.0),
    }
)
"""The numbers that options may be."""
CHOICES: Final[Mapping[str, Sequence[str]]] = MappingProxyType(
    {
        "style": tuple(ARROW_STYLES),
        "encoding": tuple(ENCODINGS),
        "wrench_frame": get_args(WrenchFrameOption),
        "forward_axis": get_args(ForwardAxis),
        "time_source": get_args(TimeSourceOption),
        "tf": get_args(TfOption),
        "compression": ("zstd", "lz4", "none"),
    }
)
"""The words that options may be."""

Keywords = TypeVar("Keywords", bound=RobotKeywords)


def checked(options: Keywords, known: type[Keywords]) -> Keywords:
    """Return the options that are given: None stands for one that is not.

    Raises:
        TypeError: there is no such option.
        CallError: one is not what it must be.
    """
    names: frozenset[str] = known.__optional_keys__  # type: ignore[attr-defined] # of TypedDict
    if others := options.keys() - names:
        raise TypeError(f"no option {min(others)!r}; there are {listed(sorted(names))}")
    given = {name: value for name, value in options.items() if value is not None}
    refuse_bad_values(given)
    for name in given.keys() & NUMBERS.keys():
        given[name] = NUMBERS[name].kind(given[name])
    return cast("Keywords", given)


def refuse_bad_values(given: Mapping[str, object]) -> None:
    """Check numbers and choices.

    Raises:
        CallError: an option is none of those that it may be.
    """
    for name, value in given.items():
        if name in NUMBERS and not NUMBERS[name].has(value):
            raise CallError(f"{name}={value!r}: must be {NUMBERS[name]}")
        if name in CHOICES and value not in CHOICES[name]:
            raise CallError(f"{name}={value!r}: must be one of {', '.join(CHOICES[name])}")


def topic_options(options: RobotKeywords) -> TopicOptions:
    """Return the options about robot and topics, of those that are `checked`.

    Raises:
        CallError: a foot's name or an offset is none.
    """
    robot, tare, urdf = options.get("robot"), options.get("tare"), options.get("urdf")
    feet = dict(options.get("foot", {}))
    for name in feet:
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {name}: a foot's name has letters, digits and _ only")
    offsets_n = None if isinstance(tare, str) or tare is None else dict(tare)
    for name, offset in (offsets_n or {}).items():
        if len(offset) != _AXES or not all(OFFSET.has(part) for part in offset):
            raise CallError(f"--tare {name}: must be three numbers in newtons, such as 3,-2,-60")
    if isinstance(tare, str) and tare != "none":
        raise CallError(f"tare={tare!r}: must be the force by foot, or 'none'")
    return TopicOptions(
        robot=None if robot is None else os.fspath(robot),
        odometry_topic=options.get("odom_topic"),
        foot_topics=feet or None,
        mass_kg=options.get("mass"),
        offsets_n=offsets_n,
        takes_offsets=tare != "none",
        urdf=None if urdf is None else Path(urdf),
        joined=tuple(location(os.fspath(path)) for path in several(options.get("join", ()))),
    )


def stats_options(options: MeasureKeywords) -> StatsOptions:
    """Return the options of measuring.

    Raises:
        TypeError: there is no such option.
        CallError: one is not what it must be.
    """
    given = checked(options, MeasureKeywords)
    return StatsOptions(
        topics=topic_options(given),
        wrench_frame=given.get("wrench_frame", "auto"),
        forward_axis=given.get("forward_axis"),
        contact_on_n=given.get("contact_on"),
        contact_off_n=given.get("contact_off"),
        debounce_s=given.get("debounce"),
        time_source=given.get("time_source"),
        command_topic=given.get("command"),
        imu_topic=given.get("imu"),
        start_s=given.get("start"),
        end_s=given.get("end"),
        jobs=given.get("jobs", 1),
    )


def convert_options(options: ConvertKeywords) -> ConvertOptions:
    """Return the options of `convert`; see `stats_options`."""
    given = checked(options, ConvertKeywords)
    return ConvertOptions(
        topics=topic_options(given),
        style=given.get("style", DEFAULT_STYLE),
        encoding=given.get("encoding", DEFAULT_ENCODING),
        copy=given.get("copy", True),
        copied_topics=tuple(several(given.get("topics", ()))),
        topics_left_out=tuple(several(given.get("without", ()))),
        wrench_frame=given.get("wrench_frame", "auto"),
        tf=given.get("tf", "auto"),
        tf_rate_hz=given.get("tf_rate", 50.0),
        start_s=given.get("start"),
        end_s=given.get("end"),
        compression=given.get("compression"),
        jobs=given.get("jobs", 1),
        overwrite=given.get("overwrite", False),
    )


Word = TypeVar("Word", bound=PathOrName)


def several(words: Iterable[Word] | Word) -> Iterable[Word]:
    """Return words; a text is one word, not as many as it has letters."""
    return [words] if isinstance(words, str | os.PathLike) else words
