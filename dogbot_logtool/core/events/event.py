"""One event, and what annotated logs say of events and gaits."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import Final, NamedTuple


class EventType(StrEnum):
    """Type of an event; of events at one time the first of these comes first."""

    FALL = "fall"
    """descent from standing to lying, until the robot lies no more"""
    TIPPING = "tipping"
    """roll or pitch leaves its usual range and the recording ends"""
    CARRIED = "carried"
    """no foot is down for longer than a leap takes, and the base is as high as it stands, or higher
    (value: by how much)"""
    STUMBLE = "stumble"
    """a foot in mid-swing touches something and swings on (value: part of the swing before it)"""
    SLIP = "slip"
    """the contact point of a loaded foot goes three times as far as in the foot's other stances and
    5 mm more, or three times as far as `settings.foot_rolling_m`; or, within 60 ms and on a single
    contact point, twice as far as in those and 5 mm more (value: how much further)"""
    EARLY_CONTACT = "early_contact"
    """a swing ends before 0.7 of the foot's usual swing and the foot stays down (value: how much
    too early)"""
    MARGIN_BELOW_ZERO = "margin_below_zero"
    """the base's projection leaves the support polygon by more than 1 cm for at least 80 ms (value:
    least margin)"""
    GAIT_CHANGE = "gait_change"
    """the class or the stride period changes for at least two strides, or a stand begins or ends
    (value: new stride frequency)"""
    POSE_JUMP = "pose_jump"
    """a step of the pose that the base's speed does not explain"""
    SENSOR_FAULT = "sensor_fault"
    """what findings call stuck, dead, saturated or a lone spike"""
    GAP = "gap"
    """silence of a foot's sensor or of the odometry that ends what is known"""
    TOUCHDOWN = "touchdown"
    """a foot comes down"""
    LIFT_OFF = "lift_off"
    """a foot leaves the ground"""


STEPS = frozenset({EventType.TOUCHDOWN, EventType.LIFT_OFF})
"""Events of every stride, which call for no look."""


class Event(NamedTuple):
    """Something that happened, to one foot or to the robot."""

    onset: int
    """ns."""
    duration: int
    """ns; 0 for an instant."""
    type: EventType
    foot: int | None = None
    """Index of the foot; None: of the whole robot."""
    value: float | None = None
    """How much, in `unit`; None: nothing is measured of it."""
    unit: str = ""
    code: str = ""
    """Code of the finding about it; for a change of the gait both classes, ``trot>walk``."""


UNKNOWN: Final = "unknown"
"""The gait between segments."""


class Level(IntEnum):
    """How much an event matters, as log panels filter it."""

    DEBUG = 1
    INFO = 2
    WARNING = 3
    ERROR = 4


@dataclass(frozen=True, slots=True)
class EventMessage:
    """An event for a log panel."""

    time: int
    """ns, its onset."""
    level: Level
    source: str
    """Name of the foot, or ``robot``."""
    text: str
    end: int = 0
    """ns."""
    is_step: bool = False
    """Whether it is a touchdown or a lift-off."""
    details: Mapping[str, str] = field(default_factory=dict)
    """Its details by name: ``type``, ``foot``, ``value``, ``unit``, ``code``."""


@dataclass(frozen=True, slots=True)
class GaitState:
    """The gait from a time on."""

    time: int
    """ns."""
    gait: str
    """Class, or `UNKNOWN`."""
    stride_frequency_hz: float
    """NaN where there are no strides; also the rest."""
    duty_factor: float
    phases: tuple[float, ...]
    """Cycles, of each foot."""
