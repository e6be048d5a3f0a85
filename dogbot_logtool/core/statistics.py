"""The figures of a log: what `evaluation.py` works out, and all that is reported is taken from."""

from dataclasses import field
from typing import TYPE_CHECKING

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.falls import Tipping
from dogbot_logtool.core.base.motion import BaseMotion
from dogbot_logtool.core.base.poses import BaseHistory, PoseJumps
from dogbot_logtool.core.consistency.worlds import Worlds
from dogbot_logtool.core.corrections.clock import (
    ClockDifference,
)
from dogbot_logtool.core.gait.foot_statistics import (
    FootStatistics,
)
from dogbot_logtool.core.gait.segments import (
    Segment,
)
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.load.load_figures import LoadFigures
from dogbot_logtool.core.planned import PlannedFoot
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.stability.stability import Stability
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.commands import CommandTrack
    from dogbot_logtool.core.consistency.heave import Delay
    from dogbot_logtool.core.imu import ImuComparison
    from dogbot_logtool.core.legs.leg_figures import LegFigures
    from dogbot_logtool.core.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class SegmentFigures:
    """All figures of a segment, like those of the log."""

    base: BaseMotion | None
    feet: tuple[FootStatistics, ...]
    support: Support | None
    loads: LoadFigures
    stability: Stability | None


@dataclass(frozen=True, slots=True)
class Stats:
    """All figures of one log."""

    settings: StatsSettings
    origin: int
    """ns on the clock used: the earliest time of any used message; what times are counted from."""
    end: int
    """ns, the latest."""
    feet: tuple[FootStatistics, ...]
    reference: int
    """The foot that phases are measured against: left fore, or the first that has strides."""
    corners: tuple[int, int, int, int] | None
    """Which foot is front left, front right, back left, back right; None: no quadruped, or
    not known."""
    base_history: BaseHistory
    """As recorded, jumps and all."""
    base: BaseMotion | None
    jumps: PoseJumps
    tipping: Tipping | None
    """The robot is tipping when the recording ends."""
    segments: tuple[Segment, ...]
    segment_figures: tuple[SegmentFigures, ...]
    """Figures of each segment."""
    transition_strides: int
    """Strides of the reference foot that belong to no segment."""
    main: Segment | None
    """The longest segment: its class is the log's."""
    support: Support | None
    loads: LoadFigures
    stability: Stability | None
    fallen: Ints
    """(f, 2) ns, spans in which the robot lies."""
    topics: tuple[TopicQuality, ...]
    overlap_s: float
    """s, time known to all feet that have messages and to the base."""
    contact_without_pose_s: tuple[float, ...]
    """s a foot, time in contact further than 0.1 s from every pose."""
    clocks: tuple[ClockDifference, ...] = ()
    """How far topics' clocks are from that of the feet; nothing on log time."""
    clocks_apart: frozenset[str] = frozenset()
    """Topics whose clocks are too far from the others' for figures of both."""
    base_delay: "Delay | None" = None
    """By how much the base comes after the forces that drive it; None: not known, or little."""
    push: float | None = None
    """Share of the weight by which the feet push the robot on over whole stances; None: not
    known."""
    rise_m: float = 0.0
    """m, how far the base rises steadily over the contact points while it walks."""
    swapped: tuple[tuple[int, int], ...] = ()
    """Left and right feet of the pairs that touch on the other side each; `pairs` of how many."""
    pairs: int = 0
    leaning_rad: float | None = None
    """rad, how far the base seems to lean while the robot walks: its poses are left out; None: it
    does not."""
    worlds: Worlds | None = None
    """Position of the base among the feet; None without contact points."""
    planned: tuple[PlannedFoot | None, ...] = ()
    """How each foot follows its plan; None without one; empty: the log has no plan beside."""
    all_silent: Ints = field(default_factory=timespans.no_spans)
    """(s, 2) ns, spans in which no foot's sensor sends anything, though the odometry does."""
    beside: "tuple[VectorHistory, ...]" = ()
    """Records of commands and accelerometer."""
    command_track: "CommandTrack | None" = None
    """Commanded and measured velocity; None without commands."""
    imu: "ImuComparison | None" = None
    """Comparison of the base's accelerometer with forces and poses; None without one."""

    legs: "LegFigures | None" = None
    """None where the log tells nothing of its legs."""

    @property
    def base_clock_is_apart(self) -> bool:
        """Whether the odometry's clock is too far from that of the feet."""
        return self.settings.odometry_topic in self.clocks_apart

    @property
    def feet_clocks_are_apart(self) -> bool:
        """Whether the clock of a foot is too far from that of the others."""
        return any(foot.topic in self.clocks_apart for foot in self.settings.feet)

    @property
    def worlds_differ(self) -> bool:
        """Whether contact points and base are not in one world."""
        return self.worlds is not None and not self.worlds.agree

    @property
    def loses_way(self) -> bool:
        """Whether the base drifts so far among the contact points that speeds are not known."""
        path_m = 0.0 if self.base is None else self.base.path_length_m or 0.0
        return self.worlds is not None and self.worlds.lose_way(path_m)

    def seconds(self, time: Ints) -> list[float]:
        """Return times as seconds since the origin, to the nanosecond."""
        return [each / 1e9 for each in (time - self.origin).tolist()]
