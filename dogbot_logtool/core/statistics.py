"""All that is measured of a walk: what checks read, and metrics and drawings are made of."""

from typing import TYPE_CHECKING

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.falls import Tipping
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.corrections.clock import ClockDifference
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.gait.support import Support
from dogbot_logtool.core.loads import WalkLoads
from dogbot_logtool.core.masked_walk import MaskedWalk
from dogbot_logtool.core.metrics import Stability
from dogbot_logtool.core.planned import PlannedFoot
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.stability import Unstable
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.commands import CommandTrack
    from dogbot_logtool.core.imu import ImuComparison
    from dogbot_logtool.core.legs.legs import LegFigures
    from dogbot_logtool.core.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class Stats(MaskedWalk):
    """All that is measured of one log, before anything is set to null."""

    origin: int
    """ns on the clock used: the earliest time of any used message; what times are counted from."""
    end: int
    """ns, the latest."""
    reference: int
    """The foot that phases are measured against: left fore, or the first that has strides."""
    corners: tuple[int, int, int, int] | None
    """Which foot is front left, front right, back left, back right; None: no quadruped, or
    not known."""
    swapped: tuple[tuple[int, int], ...]
    """Left and right feet of the pairs that touch on the other side each; `pairs` of how many."""
    pairs: int
    base_history: BaseHistory
    """As recorded, jumps and all."""
    leaning_rad: float | None
    """rad, how far the base seems to lean while the robot walks: its poses are left out; None: it
    does not."""
    tipping: Tipping | None
    """The robot is tipping when the recording ends."""
    segments: tuple[Segment, ...]
    main: Segment | None
    """The longest segment: its class is the log's."""
    support: Support | None
    loads: WalkLoads
    stability: Stability | None
    unstable: Unstable | None
    topics: tuple[TopicQuality, ...]
    overlap_s: float
    """s, time known to all feet that have messages and to the base."""
    contact_without_pose_s: tuple[float, ...]
    """s a foot, time in contact further than 0.1 s from every pose."""
    clocks: tuple[ClockDifference, ...]
    """How far topics' clocks are from that of the feet; nothing on log time."""
    all_silent: Ints
    """(s, 2) ns, spans in which no foot's sensor sends anything, though the odometry does."""
    beside: "tuple[VectorHistory, ...]"
    """Records of commands and accelerometer."""
    command_track: "CommandTrack | None"
    """Commanded and measured velocity; None without commands."""
    imu: "ImuComparison | None"
    """Comparison of the base's accelerometer with forces and poses; None without one."""
    legs: "LegFigures | None" = None
    """None where the log tells nothing of its legs."""
    planned: tuple[PlannedFoot | None, ...] = ()
    """How each foot follows its plan; None without one; empty: the log has no plan beside."""

    def seconds(self, time: Ints) -> list[float]:
        """Return times as seconds since the origin, to the nanosecond."""
        return [each / 1e9 for each in (time - self.origin).tolist()]
