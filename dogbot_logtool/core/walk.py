"""All that is known of a walk: what it is measured by, its metrics, and what is found of it."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.ground import MovingGround
from dogbot_logtool.core.base.motion import BaseTrack, Tipping
from dogbot_logtool.core.base.poses import BaseHistory, PoseJumps
from dogbot_logtool.core.base.witness import POINTS, Witness
from dogbot_logtool.core.consistency import MOST_OF_PATH, Delay, Worlds
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrected import Corrected
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.gait.strides import Standing, Support, typical_period_s
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.loads import WalkLoads, loads_of
from dogbot_logtool.core.metrics import Base, Stability, WalkMetrics
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.records import unknown
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.stability import Instants, stability
from dogbot_logtool.finding import Finding

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joints import LegFigures
    from dogbot_logtool.core.vectors import CommandTrack, ImuComparison, PlannedFoot


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Walk:
    """All that is known of the walk in one log; nothing but `metrics` has what findings void.

    Masks come first: what was measured with them follows.
    """

    corrected: Corrected
    """The columns, before time is masked."""
    settings: WalkSettings
    """With what the masks tell of the base."""
    base_history: BaseHistory
    """As recorded, jumps and all, but for time that is masked."""
    records: tuple[FootHistory, ...]
    """Of each foot, without what its sensor cannot have measured."""
    poses: BaseHistory
    """Poses without jumps."""
    jumps: PoseJumps
    frozen: Ints
    """(s, 2) ns, time in which one pose is repeated although the robot walks on; masked."""
    base_by_feet: bool
    """Whether the feet's motion stands in for poses of which none can be used."""
    witness: Witness | None
    """The base's motion by its feet; None: their places are not known."""
    ground: MovingGround | None
    """How the ground moves; None: it rests."""
    placed_poses: BaseHistory
    """Poses among the contact points: with jumps, if they have placed these in the world."""
    track: BaseTrack
    base: Base | None
    """Motion of the base in the whole log."""
    fallen: Ints
    """(f, 2) ns, spans in which the robot lies."""
    standing: Standing
    feet: tuple[FootSteps, ...]
    """Steps of each foot."""
    clocks_apart: frozenset[str]
    """Topics whose clocks are too far from the others' for figures of both."""
    base_delay: Delay | None
    """By how much the base comes after the forces that drive it; None: not known, or little."""
    worlds: Worlds | None
    """Position of the base among the feet; None without contact points."""
    loads: WalkLoads
    """Of all feet over whole strides."""

    reference: int = 0
    """The foot that phases are measured against: left fore, or the first that has strides."""
    tipping: Tipping | None = None
    """The robot is tipping when the recording ends."""
    segments: tuple[Segment, ...] = ()
    main: Segment | None = None
    """The longest segment: its class is the log's."""
    support: Support | None = None
    stability: Stability | None = None
    instants: Instants | None = None
    """Where base and feet are; None where contacts are not known, or not on one clock with the
    base and in one world."""
    command_track: "CommandTrack | None" = None
    """Commanded and measured velocity; None without commands."""
    imu: "ImuComparison | None" = None
    """Comparison of the base's accelerometer with forces and poses; None without one."""
    legs: "LegFigures | None" = None
    """None where the log tells nothing of its legs."""
    plan_apart: str = ""
    """Topic of a plan that is on another clock than the feet, and not compared; empty: none is."""
    planned: "tuple[PlannedFoot | None, ...]" = ()
    """How each foot follows its plan; None without one; empty: the log has no plan beside."""
    findings: tuple[Finding, ...] = ()
    """About the log, the walk and its metrics, the worst first."""
    metrics: WalkMetrics = field(default_factory=lambda: unknown(WalkMetrics))
    """Those that findings void are null."""

    @property
    def origin(self) -> int:
        """Earliest time of any used message, ns on the clock used: what times are counted from."""
        starts = [foot.start for foot in self.records if foot.start is not None]
        return min([*starts, *self.poses.time[:1].tolist()], default=0)

    @property
    def end(self) -> int:
        """The latest, ns."""
        ends = [foot.end for foot in self.records if foot.end is not None]
        return max([*ends, *self.poses.time[-1:].tolist()], default=0)

    @property
    def vertical_known(self) -> bool:
        """Whether loads are vertical forces, and not their magnitudes."""
        return self.loads.share_of == "vertical_impulse"

    @property
    def recording(self) -> Recording:
        """The columns as they are measured."""
        return self.corrected.recording

    @property
    def frames(self) -> KnownFrames:
        """What the log tells of its frames."""
        return self.corrected.frames

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
    def base_is_apart(self) -> bool:
        """Whether the base is on another clock than the feet, or in another world."""
        return self.base_clock_is_apart or self.worlds_differ

    @property
    def loses_track(self) -> bool:
        """Whether the base drifts so far among the contact points that speeds are not known."""
        worlds, path_m = self.worlds, (self.base and self.base.path_length_m) or 0.0
        if worlds is None or worlds.agree or self.settings.base_from_legs:
            return False
        return worlds.drifts and worlds.shift_m > MOST_OF_PATH * path_m

    @property
    def feet_on_poses(self) -> tuple[str, ...]:
        """Names of the feet whose lengths rest on the base's poses."""
        own = self.witness is not None and self.witness.by == POINTS
        return tuple(foot.name for foot in self.feet if not (own and foot.length_from == "points"))

    @property
    def period_s(self) -> float | None:
        """The usual stride, s; None: there are none."""
        return typical_period_s([each.stances for each in self.records])

    @property
    def contacts_known(self) -> bool:
        """Whether the contacts of all feet are known, on one clock."""
        known = all(foot.contact_known or foot.record.start is None for foot in self.feet)
        return known and not (self.feet_clocks_are_apart or self.settings.lacks_feet)

    def paired(self, foot: int, other: int) -> bool:
        """Tell whether two feet are at the same end of the robot; both of a biped are."""
        one, two = self.feet[foot].leg_position, self.feet[other].leg_position
        return len(self.feet) == 2 or bool(one and two and one[0] == two[0])

    def seconds(self, time: Ints) -> list[float]:
        """Return times as seconds since the origin, to the nanosecond."""
        return [each / 1e9 for each in (time - self.origin).tolist()]

    def stability_in(self, within: Ints = timespans.ALWAYS) -> Stability | None:
        """Return the stability, where base and feet are on one clock and in one world."""
        if self.instants is None:
            return None
        height_known = bool(np.isfinite(self.track.height_m).any())
        vertical_known = self.vertical_known
        return stability(
            self.instants, within, vertical_known=vertical_known, height_known=height_known
        )

    @property
    def strides(self) -> Ints:
        """(s, 2) ns, the strides of the first foot that has any."""
        spans = [foot.strides.spans for foot in self.feet]
        return next(filter(len, spans), timespans.no_spans())

    def loads_in(self, within: Ints = timespans.ALWAYS) -> WalkLoads:
        """Return the loads of all feet over whole strides of the first foot that has any."""
        strides = self.strides[timespans.covers(within, self.strides.sum(axis=1) // 2)]
        return loads_of(self.records, self.settings, strides, within)
