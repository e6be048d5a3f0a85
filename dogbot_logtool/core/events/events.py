"""The table of all events of a log."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.events.recording_events import gaps, sensor_faults
from dogbot_logtool.core.events.robot_events import (
    carried,
    falls,
    gait_changes,
    margins_below_zero,
    pose_jumps,
    tipping,
)
from dogbot_logtool.core.events.slips import slips
from dogbot_logtool.core.events.steps import early_touchdowns, step_events
from dogbot_logtool.core.statistics import Stats

_RANK: Final = {kind: rank for rank, kind in enumerate(EventType)}


def find_events(stats: Stats) -> tuple[Event, ...]:
    """Return all events of a log, in the order of time."""
    found = [
        *falls(stats),
        *tipping(stats),
        *carried(stats),
        *gait_changes(stats.segments),
        *margins_below_zero(stats),
        *pose_jumps(stats),
        *gaps(stats),
        *sensor_faults(stats),
        *step_events(stats.feet),
        *_odd_steps(stats),
    ]
    return tuple(sorted(found, key=_order))


def _odd_steps(stats: Stats) -> Iterator[Event]:
    """Yield stumbles, early contacts and slips."""
    walks = [segment for segment in stats.segments if segment.strides]
    for row, foot in enumerate(stats.feet):
        early = list(early_touchdowns(row, foot, walks))
        stumbles = frozenset(each.onset for each in early if each.type is EventType.STUMBLE)
        yield from early
        yield from slips(row, foot, walks, stats.settings.foot_rolling_m, stumbles)


def _order(event: Event) -> tuple[int, int, int]:
    foot = -1 if event.foot is None else event.foot
    return event.onset, _RANK[event.type], foot
