"""What is measured of a log, as commands return it and reports print it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from dogbot_logtool.reader.containers.loss import SOUND, Damage

# A command needs not load what only other commands' records are made of.
if TYPE_CHECKING:
    from collections import Counter

    from dogbot_logtool.core.arrays import Floats
    from dogbot_logtool.core.metrics import WalkMetrics
    from dogbot_logtool.core.walk import Walk
    from dogbot_logtool.finding import Finding
    from dogbot_logtool.io.storage import Location
    from dogbot_logtool.robot.frames import Frames
    from dogbot_logtool.robot.robot import Robot


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Measurement:
    """The walk of a log, and what was lost of the log."""

    walk: "Walk"
    damage: Damage = SOUND
    """What could not be read of the log."""

    @property
    def findings(self) -> "tuple[Finding, ...]":
        """On the log and its metrics, the worst first."""
        return self.walk.findings

    @property
    def metrics(self) -> "WalkMetrics":
        """Those of the walk; what findings void is null."""
        return self.walk.metrics


class StrideTable(NamedTuple):
    """Strides foot by foot, each foot's in order."""

    foot: tuple[str, ...]
    """(n,) names."""
    columns: "Mapping[str, Floats]"
    """(n,) by name, the unit at its end; NaN where not known. `start_s` counts from the log's
    first message of use."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Figures:
    """The metrics of one log, small enough to send and store."""

    summary: tuple[str, ...]
    """Its row among several logs."""
    json: dict[str, Any]
    """Its `stats --json`; empty where that was not asked for."""
    strides: "StrideTable"
    interval_s: float
    """s, the longest sampling interval of its feet: no time is known more finely."""
    damage: Damage
    whole: "Measurement | None" = None
    """All there is, if it was asked for."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TopicInfo:
    """One topic as one type and encoding."""

    topic: str
    type_name: str
    encoding: str
    messages: int
    rate_hz: float | None
    """Messages a second over the log's duration; None where there are too few of them, or the log
    is too short, for a rate."""
    senders: int
    use: str
    """Its use: ``odometry``, ``foot front_left``, ``frames``, ``joints``, or nothing.
    ``annotation``: `convert` added it."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LogInfo:
    """The contents of a log."""

    path: "Location"
    size: int
    """Bytes."""
    container: str
    profile: str
    compressions: tuple[str, ...]
    start_time: int | None
    """ns, log time of the first message; None for an empty log."""
    duration_s: float | None
    messages: int
    chunks: int
    topics: tuple[TopicInfo, ...]
    robot: str
    parents: Mapping[str, frozenset[str]]
    """Parents of each frame, by the log's own transforms, in the chunks that were looked at unless
    all `frames` were asked for."""
    added_transform: tuple[str, str] | None
    """Parent and child of the transform that `convert` adds."""
    chunks_seen: int
    """Chunks that were looked at for frames and stamps; the rest was not read."""
    frames: "Frames | None"
    """All transforms of the log, if they were asked for."""
    findings: "tuple[Finding, ...]"
    damage: Damage


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Conversion:
    """The result of `convert`."""

    source: "Location"
    target: "Location"
    container: str
    robot: "Robot"
    style: str
    encoding: str
    odometry_topics: tuple[str, ...]
    world_frame: str
    base_frame: str
    messages: int
    """Recorded messages that were read."""
    copied: int
    """Recorded messages in the output."""
    annotations: Mapping[str, int]
    """Messages that were added, by topic."""
    counts: "Counter[str]"
    """Annotations that lack something, by what; see `conversion/annotate.py`. And ``bad_poses``:
    odometry messages with a zero quaternion or a number that is not finite."""
    findings: "tuple[Finding, ...]"
    damage: Damage


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Page:
    """A page that was written."""

    source: "Location"
    target: "Location"
    size: int
    """bytes."""
    measured: Measurement

    @property
    def damage(self) -> Damage:
        """What could not be read of the log."""
        return self.measured.damage
