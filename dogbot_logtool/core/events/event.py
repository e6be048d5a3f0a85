"""Types of events, their order, and how much each matters."""

from collections.abc import Iterable
from enum import IntEnum, StrEnum
from typing import Final

from dogbot_logtool.core.metrics import Event, Foot, WalkMetrics


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
    5 mm more, or three times as far as `settings.foot_rolling_m` (value: how much further)"""
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
_RANK: Final = {kind.value: rank for rank, kind in enumerate(EventType)}


def in_order(events: Iterable[Event], feet: Iterable[str]) -> tuple[Event, ...]:
    """Return events in the order of time, then of types, then of feet."""
    order = {None: -1} | {name: row for row, name in enumerate(feet)}
    return tuple(
        sorted(events, key=lambda each: (each.onset_s, _RANK[each.type], order[each.foot]))
    )


def with_steps(metrics: WalkMetrics) -> tuple[Event, ...]:
    """Return all events of a walk: those of its metrics, and touchdowns and lift-offs."""
    steps = [each for name, foot in metrics.feet.items() for each in _steps(name, foot)]
    return in_order([*metrics.events, *steps], metrics.feet)


def _steps(name: str, foot: Foot) -> Iterable[Event]:
    columns = (EventType.TOUCHDOWN, foot.touchdown_s), (EventType.LIFT_OFF, foot.lift_off_s)
    for kind, times in columns:
        yield from (Event(time, 0.0, kind.value, name, None, None, None) for time in times or ())


UNKNOWN: Final = "unknown"
"""The gait between segments."""


class Level(IntEnum):
    """How much an event matters, as log panels filter it; `DEBUG`: touchdowns and lift-offs."""

    DEBUG = 1
    INFO = 2
    WARNING = 3
    ERROR = 4
