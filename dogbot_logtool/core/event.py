"""Types of events, their order, how much each matters, and events in words."""

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.metrics import Event, Foot, WalkMetrics

if TYPE_CHECKING:
    from dogbot_logtool.core.contact.stances import FootTrack


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


WARNING: Final = 3
"""How much most events matter, as log panels filter them."""
LEVELS: Final[Mapping[str, int]] = {
    EventType.FALL: 4,
    EventType.GAIT_CHANGE: 2,
    **dict.fromkeys(STEPS, 1),
}
"""The same of the others: an error, information, and steps that are for looking closely only."""


def text_of(event: Event) -> str:
    """Return an event in words; log panels show its foot beside them."""
    code, is_change = event.code or "", event.type == EventType.GAIT_CHANGE
    parts = [
        event.type.replace("_", " "),
        code.replace(">", " to ") if is_change else "",
        "" if event.value is None else f"{event.value:.3g} {event.unit}",
        f"for {event.duration_s:.3f} s" if event.duration_s and event.unit != "s" else "",
        "" if is_change else code,
    ]
    return ", ".join(filter(None, parts))


def to_log_time(tracks: Sequence["FootTrack"], time: Ints, start: int, end: int) -> Ints:
    """Return when times on the clock that was measured on were recorded.

    As long after as the sample around it of the foot that has the most.

    Args:
        tracks: of all feet.
        time: (n,) ns, ascending.
        start: ns, log time of its first message.
        end: ns, of its last.

    Returns:
        (n,) ns, ascending, within the log.
    """
    track = max(tracks, key=lambda each: len(each.row), default=None)
    if track is not None and len(track.row):
        row = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
        time = time + (track.log_time - track.time)[row]
    recorded: Ints = np.maximum.accumulate(np.clip(time, start, end))
    return recorded
