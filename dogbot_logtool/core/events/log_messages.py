"""Events as sentences, and the gait as it changes."""

from itertools import zip_longest
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.events.event import (
    STEPS,
    UNKNOWN,
    Event,
    EventMessage,
    EventType,
    GaitState,
    Level,
)
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.statistics import Stats

_LEVELS: Final = {
    EventType.FALL: Level.ERROR,
    EventType.GAIT_CHANGE: Level.INFO,
    **dict.fromkeys(STEPS, Level.DEBUG),
}
"""Levels of events that are no warnings."""


def event_messages(stats: Stats) -> tuple[EventMessage, ...]:
    """Return all events of a log in words, in the order of time."""
    names = [foot.name for foot in stats.feet]
    return tuple(_message(each, names) for each in find_events(stats))


def _message(event: Event, names: list[str]) -> EventMessage:
    source = "robot" if event.foot is None else names[event.foot]
    # Log panels show the source beside the text.
    parts = [event.type.replace("_", " ")]
    if event.type is EventType.GAIT_CHANGE:
        parts.append(event.code.replace(">", " to "))
    if event.value is not None:
        parts.append(f"{event.value:.3g} {event.unit}")
    if event.duration and event.unit != "s":
        parts.append(f"for {event.duration / 1e9:.3f} s")
    if event.code and event.type is not EventType.GAIT_CHANGE:
        parts.append(event.code)
    level = _LEVELS.get(event.type, Level.WARNING)
    details = {
        "type": str(event.type),
        "foot": "" if event.foot is None else source,
        "value": "" if event.value is None else f"{event.value:.9g}",
        "unit": event.unit,
        "code": event.code,
    }
    return EventMessage(
        event.onset,
        level,
        source,
        ", ".join(filter(None, parts)),
        end=event.onset + event.duration,
        is_step=event.type in STEPS,
        details={name: text for name, text in details.items() if text},
    )


def gait_states(stats: Stats) -> tuple[GaitState, ...]:
    """Return the gait where it begins, and that it is unknown where a segment ends."""
    states: list[GaitState] = []
    nothing = (float("nan"),) * len(stats.feet)
    for segment, after in zip_longest(stats.segments, stats.segments[1:]):
        states.append(_state(segment))
        if after is None or after.start > segment.end:
            states.append(GaitState(segment.end, UNKNOWN, nothing[0], nothing[0], nothing))
    return tuple(states) if stats.feet else ()


def _state(segment: Segment) -> GaitState:
    return GaitState(
        segment.start,
        segment.gait.name or UNKNOWN,
        _or_nan(segment.stride_frequency_hz),
        _or_nan(segment.duty_factor),
        tuple(_or_nan(None if phase is None else phase.mean) for phase in segment.phases),
    )


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else value


def to_log_time(stats: Stats, time: Ints, start: int, end: int) -> Ints:
    """Return when times on the clock that was measured on were recorded.

    As long after as the sample around it of the foot that has the most.

    Args:
        stats: figures of the log.
        time: (n,) ns, ascending.
        start: ns, log time of its first message.
        end: ns, of its last.

    Returns:
        (n,) ns, ascending, within the log.
    """
    tracks = (foot.record.track for foot in stats.feet)
    track = max(tracks, key=lambda each: len(each.row), default=None)
    if track is not None and len(track.row):
        row = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
        time = time + (track.log_time - track.time)[row]
    recorded: Ints = np.maximum.accumulate(np.clip(time, start, end))
    return recorded
