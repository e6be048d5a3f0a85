"""Events as sentences, and the gait as it changes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.events.event import STEPS, UNKNOWN, EventType, Level, with_steps
from dogbot_logtool.core.metrics import Event
from dogbot_logtool.core.walk import Walk

_LEVELS: Final[Mapping[str, Level]] = {
    EventType.FALL: Level.ERROR,
    EventType.GAIT_CHANGE: Level.INFO,
    **dict.fromkeys(STEPS, Level.DEBUG),
}
"""Levels of events that are no warnings."""


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


def event_messages(walk: Walk) -> tuple[EventMessage, ...]:
    """Return all events of a log in words, in the order of time."""
    return tuple(_message(each, walk.origin) for each in with_steps(walk.metrics))


def _message(event: Event, origin: int) -> EventMessage:
    code, is_change = event.code or "", event.type == EventType.GAIT_CHANGE
    # Log panels show the source beside the text.
    parts = [
        event.type.replace("_", " "),
        code.replace(">", " to ") if is_change else "",
        "" if event.value is None else f"{event.value:.3g} {event.unit}",
        f"for {event.duration_s:.3f} s" if event.duration_s and event.unit != "s" else "",
        "" if is_change else code,
    ]
    details = {
        "type": event.type,
        "foot": event.foot or "",
        "value": "" if event.value is None else f"{event.value:.9g}",
        "unit": event.unit or "",
        "code": code,
    }
    onset = origin + round(event.onset_s * 1e9)
    return EventMessage(
        onset,
        _LEVELS.get(event.type, Level.WARNING),
        event.foot or "robot",
        ", ".join(filter(None, parts)),
        end=onset + round(event.duration_s * 1e9),
        details={name: text for name, text in details.items() if text},
    )


def gait_states(walk: Walk) -> tuple[GaitState, ...]:
    """Return the gait where it begins, and that it is unknown where a segment ends."""
    states: list[GaitState] = []
    nan = float("nan")
    for segment, after in zip_longest(walk.segments, walk.segments[1:]):
        gait = segment.gait
        means = (phase.mean for phase in gait.phase.values())
        rate, duty, *phases = (
            nan if each is None else each
            for each in (gait.stride_frequency_hz, gait.duty_factor, *means)
        )
        state = GaitState(segment.start, gait.name or UNKNOWN, rate, duty, tuple(phases))
        states.append(state)
        if after is None or after.start > segment.end:
            states.append(GaitState(segment.end, UNKNOWN, nan, nan, (nan,) * len(walk.feet)))
    return tuple(states) if walk.feet else ()


def to_log_time(walk: Walk, time: Ints, start: int, end: int) -> Ints:
    """Return when times on the clock that was measured on were recorded.

    As long after as the sample around it of the foot that has the most.

    Args:
        walk: figures of the log.
        time: (n,) ns, ascending.
        start: ns, log time of its first message.
        end: ns, of its last.

    Returns:
        (n,) ns, ascending, within the log.
    """
    tracks = (foot.record.track for foot in walk.feet)
    track = max(tracks, key=lambda each: len(each.row), default=None)
    if track is not None and len(track.row):
        row = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
        time = time + (track.log_time - track.time)[row]
    recorded: Ints = np.maximum.accumulate(np.clip(time, start, end))
    return recorded
