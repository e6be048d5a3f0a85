"""One event: something that happened at a time."""

from enum import StrEnum
from typing import NamedTuple


class EventType(StrEnum):
    """Type of an event; of events at one time the first of these comes first."""

    FALL = "fall"
    TIPPING = "tipping"
    CARRIED = "carried"
    STUMBLE = "stumble"
    SLIP = "slip"
    EARLY_CONTACT = "early_contact"
    MARGIN_BELOW_ZERO = "margin_below_zero"
    GAIT_CHANGE = "gait_change"
    POSE_JUMP = "pose_jump"
    SENSOR_FAULT = "sensor_fault"
    GAP = "gap"
    TOUCHDOWN = "touchdown"
    LIFT_OFF = "lift_off"


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
