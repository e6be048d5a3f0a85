"""What decides the figures: thresholds, mass, frames, clock."""

from dataclasses import dataclass

from dogbot_logtool.core.contact.footfall import ContactRule, contact_rule
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.core.load.loads import body_weight_n


@dataclass(frozen=True, slots=True)
class FootPlace:
    """One foot, in the order in which `Samples.foot` counts them."""

    name: str
    topic: str
    place: LegPosition | None = None
    has_force: bool = True
    """Whether its sensor tells a force, not only whether the foot touches."""
    silent_in_swing: bool = False
    """Whether its sensor sends no messages while the foot is in the air."""


@dataclass(frozen=True, slots=True)
class StatsSettings:
    """Settings of the figures; all of them are echoed beside the numbers."""

    feet: tuple[FootPlace, ...]
    """The first is the reference for phases."""
    mass_kg: float | None = None
    forward_axis: str = "+x"
    foot_rolling_m: float = 0.0
    contact_on_n: float | None = None
    contact_off_n: float | None = None
    contact_on_counts: float | None = None
    """Of raw sensors without a scale; the reader has applied it."""
    debounce_s: float = 0.020
    wrench_frame: WrenchFrame = WrenchFrame.UNKNOWN
    """Frame of the forces in `Samples`; samples that are `in_world` are in the world anyway."""
    time_source: TimeSource | None = None
    """None: header stamps, and `UnusableStamps` when they turn out to be unusable."""
    time_source_reason: str = ""
    """Why `time_source` is what it is, when nobody asked for it."""
    odometry_topic: str = ""

    @property
    def clock(self) -> TimeSource:
        """The clock that is measured on."""
        return self.time_source or TimeSource.HEADER

    @property
    def body_weight_n(self) -> float | None:
        """N; None when the mass is not known."""
        return body_weight_n(self.mass_kg)

    @property
    def rule(self) -> ContactRule:
        """What counts as contact."""
        return contact_rule(
            self.contact_on_n, self.contact_off_n, self.debounce_s, self.body_weight_n
        )

    @property
    def force_in_world(self) -> bool:
        """Whether recorded forces are in the world frame."""
        return self.wrench_frame is WrenchFrame.WORLD
