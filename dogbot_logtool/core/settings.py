"""Settings of the figures: thresholds, mass, frames, clock."""

from dataclasses import dataclass, field
from math import pi
from typing import Final, NamedTuple

from dogbot_logtool.core.contact.filtered import Filter
from dogbot_logtool.core.contact.foot_history import (
    ANY_FORCE_N,
    DEBOUNCE_S,
    ContactRule,
    Thresholds,
)
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.corrections.sensor import Origin, SensorLevel
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.leg_position import LegPosition, are_some_of

FORWARD_ANGLES: Final = {"+x": 0.0, "+y": pi / 2.0, "-x": pi, "-y": -pi / 2.0}
"""rad from the body's x axis to the axis that points forward."""
GRAVITY_MPS2: Final = 9.81
"""Standard in simulators (Gazebo's default world has 9.8)."""


class FootSettings(NamedTuple):
    """One foot, in the order in which `Samples.foot` counts them."""

    name: str
    topic: str
    leg_position: LegPosition | None = None
    has_force: bool = True
    """Whether its sensor tells a force, not only whether the foot touches."""
    has_flags: bool = False
    """Whether contact flags of its messages decide contact, whatever the force."""
    lists_contacts: bool = False
    """Whether its messages say what touches, so that no force ends a contact."""
    only_presses: bool = False
    """Whether its sensor has one axis, along which a foot can only press."""
    in_base: bool = False
    """Whether its positions are in the base's frame."""
    silent_in_swing: bool = False
    """Whether its sensor sends no messages while the foot is in the air."""
    offset_n: tuple[float, float, float] | None = None
    """N, what its sensor reads without load; None: not given. Also where it is from."""
    offset_from: Origin = "option"
    low_pass: Filter | None = None
    """The filter that its forces went through; None: none."""
    level: SensorLevel = SensorLevel(zero_in_swing=True)
    """How its sensor reads without load and under it, once that is learnt from its samples."""
    rule: ContactRule = ContactRule(ANY_FORCE_N, 0.0, DEBOUNCE_S)
    """What counts as contact of it, likewise."""


@dataclass(frozen=True, slots=True)
class WalkSettings:
    """Settings of the figures; all of them are echoed beside the numbers."""

    feet: tuple[FootSettings, ...]
    """The first is the reference for phases."""
    mass_kg: float | None = None
    estimated_weight_n: float | None = None
    """N, what contact thresholds rest on where no mass is given."""
    mass_is_assumed: bool = False
    """Whether the mass is that of a robot that was only guessed from the topics."""
    forward_axis: str = "+x"
    forward_axis_is_assumed: bool = False
    """Whether it is that of a robot that was only guessed; then evidence may correct it."""
    forward_axis_reason: str = ""
    """Why it is not that of the robot, when evidence corrected it."""
    com_offset_m: tuple[float, float, float] | None = None
    """m, the centre of mass from the base's frame, in its axes; None: taken to be there."""
    foot_rolling_m: float | None = None
    """m, way of the contact point in a stance without slip; None: not known."""
    thresholds: Thresholds = field(default_factory=Thresholds)
    takes_offsets: bool = True
    """Whether offsets that are not given are estimated from the samples."""
    world_frame: str | None = None
    """The robot's; None: the odometry's. Also `base_frame`."""
    base_frame: str | None = None
    promised_frame: WrenchFrame | None = None
    """Frame of the forces by the types of the messages; None: these do not tell."""
    wrench_frame: WrenchFrame = WrenchFrame.UNKNOWN
    """Frame of the forces in `Samples`; samples that are `in_world` are in the world anyway.
    Unknown in what `analyse` is given: the promised one, else by evidence."""
    wrench_frame_is_inferred: bool = False
    """Whether that is the world's only since the recorded forces may be in it."""
    time_source: TimeSource | None = None
    """None: header stamps, or log time where they cannot be used."""
    time_source_reason: str = ""
    """Why `time_source` is what it is, where no option chose it."""
    contact_from: str = ""
    """What contacts are estimated from, ``joint_torques`` or ``kinematics``; empty: sensors."""
    base_from_legs: bool = False
    """Whether poses are worked out from the legs."""
    odometry_topic: str = ""
    command_topic: str = ""
    """Topic of velocity commands; empty: there are none. Likewise `imu_topic`."""
    imu_topic: str = ""
    silent_from: int | None = None
    """ns, log time from which silence of sensors that are silent in swing counts; None: from the
    first contact. Also `silent_until`; None: to the last contact."""
    silent_until: int | None = None
    robot: str = ""
    """Name of the robot's file."""
    robot_is_guessed: bool = False
    """Whether it was guessed from the topics."""
    imu_mounting: tuple[float, float, float, float] | None = None
    """x, y, z, w: the accelerometer's frame in the base's, from recorded transforms; None: not
    recorded, and taken to be the base's."""

    @property
    def clock(self) -> TimeSource:
        """The clock that is measured on."""
        return self.time_source or TimeSource.HEADER

    @property
    def forward_rad(self) -> float:
        """From the body's x axis to the axis that points forward."""
        return FORWARD_ANGLES[self.forward_axis]

    @property
    def body_weight_n(self) -> float | None:
        """N; None when the mass is not known."""
        return None if self.mass_kg is None else self.mass_kg * GRAVITY_MPS2

    @property
    def lacks_feet(self) -> bool:
        """Whether the robot has feet beside these, so that nothing is known of all together."""
        return are_some_of([foot.leg_position for foot in self.feet])

    @property
    def force_in_world(self) -> bool:
        """Whether recorded forces are in the world frame."""
        return self.wrench_frame is WrenchFrame.WORLD
