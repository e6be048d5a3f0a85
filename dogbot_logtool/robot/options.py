"""Options of the commands, for the command line and the library."""

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from dogbot_logtool.core.scene.styles import DEFAULT_STYLE
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.storage import Location
from dogbot_logtool.writer.encodings.registry import DEFAULT_ENCODING

# `stats` does without the writer.
if TYPE_CHECKING:
    from dogbot_logtool.reader.foot import Foot
    from dogbot_logtool.writer.chunks import Compression

TfOption = Literal["auto", "always", "never"]
WrenchFrameOption = Literal["auto", "world", "link"]
"""The frame of the wrenches as a user gives it; auto: by evidence."""
TimeSourceOption = Literal["header", "log"]


@dataclass(frozen=True, slots=True)
class TopicOptions:
    """Options about the robot and the topics."""

    robot: str | None = None
    """Name or TOML file; None: the known robot whose topics the log has, else the generic one."""
    odometry_topic: str | None = None
    foot_topics: Mapping[str, str] | None = None
    """Topic by foot, and the field where one is named: ``/feet:data[3]``."""
    mass_kg: float | None = None
    offsets_n: Mapping[str, tuple[float, float, float]] | None = None
    """N, what unloaded sensors read, by foot; None: the robot's, else estimated from the log."""
    takes_offsets: bool = True
    """Whether offsets are estimated and taken off the forces of feet without a given one."""
    feet: "tuple[Foot, ...]" = ()
    """Feet that were found in the log; none: the robot's."""
    joined: tuple[Location, ...] = ()
    """Further files of the same recording, merged with the log by time."""
    urdf: Path | None = None
    """The robot's description; None: the log's own, if it has one."""


@dataclass(frozen=True, slots=True)
class ConvertOptions:
    """Options of `convert`."""

    topics: TopicOptions = field(default_factory=TopicOptions)
    style: str = DEFAULT_STYLE
    """One of `ARROW_STYLES`."""
    encoding: str = DEFAULT_ENCODING
    """One of `ENCODINGS`."""
    copy: bool = True
    """Whether the recorded messages go into the output too."""
    copied_topics: tuple[str, ...] = ()
    """Globs of the topics that are copied; none: all."""
    topics_left_out: tuple[str, ...] = ()
    """Globs of the topics that are not copied."""
    wrench_frame: WrenchFrameOption = "auto"
    tf: TfOption = "auto"
    tf_rate_hz: float = 50.0
    """0: every odometry message."""
    start_s: float | None = None
    """s since the log's start; messages recorded earlier are left out."""
    end_s: float | None = None
    compression: "Compression | None" = None
    """None: zstd, and the chunks of an MCAP input as they are."""
    jobs: int = 1
    overwrite: bool = False
    makes_folder: bool = False
    """Whether the output's directory is made if it is missing."""


@dataclass(frozen=True, slots=True)
class StatsOptions:
    """Options of `stats`. None stands for the robot's value."""

    topics: TopicOptions = field(default_factory=TopicOptions)
    wrench_frame: WrenchFrameOption = "auto"
    forward_axis: str | None = None
    contact_on_n: float | None = None
    contact_off_n: float | None = None
    debounce_s: float | None = None
    time_source: TimeSourceOption | None = None
    """None: header stamps, or log time where those cannot be used."""
    start_s: float | None = None
    """s since the log's start; also `end_s`."""
    end_s: float | None = None
    jobs: int = 1
    command_topic: str | None = None
    """Topic of velocity commands; None: found by type and name. Likewise `imu_topic`."""
    imu_topic: str | None = None


@dataclass(frozen=True, slots=True)
class CompareOptions:
    """Options of `compare`: allowed differences, and how many are printed."""

    atol: float | None = None
    """In each field's own unit; None: what the tolerance file says, else 0. Also `rtol`."""
    rtol: float | None = None
    tolerances: Path | None = None
    """A TOML file of quantities, see `load_rules`."""
    ignore: tuple[str, ...] = ()
    """Globs: ``TOPIC``, ``FIELD`` or ``TOPIC:FIELD``."""
    topics: tuple[str, ...] = ()
    """Globs of the topics to compare; none: all, and metadata and attachments too."""
    max_differences: int = 20


@dataclass(frozen=True, slots=True)
class PlotOptions:
    """Options of `stats --figure`."""

    target: Path
    overwrite: bool = False

    @property
    def form(self) -> str:
        """The format that the target's name tells: ``svg`` ..."""
        return self.target.suffix[1:].lower()
