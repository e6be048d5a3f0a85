"""Settings of the figures: feet and where their legs are, thresholds, mass, frames, clock."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.contact.filtered import Filter
from dogbot_logtool.core.contact.foot_history import (
    ANY_FORCE_N,
    DEBOUNCE_S,
    ContactRule,
    Thresholds,
)
from dogbot_logtool.core.contact.sensor import Origin, SensorLevel
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame

FORWARD_ANGLES: Final = {"+x": 0.0, "+y": pi / 2.0, "-x": pi, "-y": -pi / 2.0}
"""rad from the body's x axis to the axis that points forward."""
GRAVITY_MPS2: Final = 9.81
"""Standard in simulators (Gazebo's default world has 9.8)."""


LegPosition = tuple[str, str]
"""("front" | "middle" | "back", "left" | "right" | "centre")."""


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
        """Whether the robot has feet beside these, so that nothing is known of all together.

        By how many these are, and by their names.
        """
        positions = [foot.leg_position for foot in self.feet]
        named = {each for each in positions if each and each[0] in _ENDS and each[1] in _SIDES}
        all_named = 0 < len(named) == len(positions)
        return len(positions) == 1 or (all_named and legs_in_order(positions) is None)

    @property
    def force_in_world(self) -> bool:
        """Whether recorded forces are in the world frame."""
        return self.wrench_frame is WrenchFrame.WORLD


# --- the positions of legs on the body ---


_ENDS: Final = ("front", "middle", "back")
_SIDES: Final = ("left", "right")


def legs_in_order(positions: Sequence[LegPosition | None]) -> tuple[int, ...] | None:
    """Return the feet from front to back, left before right: the order of a gait's phases.

    Two feet need no positions. None for robots whose gaits have no names (other than two, four
    or six feet), where the positions of four or six feet are not known, and for a pair of feet of
    a robot that has more.
    """
    if len(positions) == 2:
        if any(position and position[0] in {"front", "back"} for position in positions):
            return None
        swapped = [position[1] if position else "" for position in positions] == ["right", "left"]
        return (1, 0) if swapped else (0, 1)
    ends = {4: ("front", "back"), 6: _ENDS}.get(len(positions), ())
    wanted = [(end, side) for end in ends for side in _SIDES]
    if not wanted or sorted(each for each in positions if each) != sorted(wanted):
        return None
    return tuple(positions.index(each) for each in wanted)


def leg_names(points: Floats) -> tuple[str, ...]:
    """Name legs by where their feet are.

    Two feet are left and right; four and six are told by their order along x on each side. Any
    other number, or one with more feet on a side, is only counted: ``foot_1``.

    Args:
        points: (k, 3) m, in the base's frame; x is forward, y to the left.
    """
    numbered = tuple(f"foot_{number + 1}" for number in range(len(points)))
    left = points[:, 1] > median_of(points[:, 1]) if len(points) else np.zeros(0, np.bool_)
    ends = {1: ("",), 2: ("front", "back"), 3: _ENDS}.get(int(left.sum()), ())
    if 2 * len(ends) != len(points):
        return numbered
    names = list(numbered)
    for side, rows in (("left", np.flatnonzero(left)), ("right", np.flatnonzero(~left))):
        from_front = rows[np.argsort(-points[rows, 0], kind="stable")]
        for end, row in zip(ends, from_front.tolist(), strict=True):
            names[row] = f"{end}_{side}" if end else side
    return tuple(names)
