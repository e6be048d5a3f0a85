"""The messages of `/events` and `/gait`, made of the figures of the whole log."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.events.messages import EventMessage, GaitState
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.message_records import MessageRecords, recorded

# The log is measured only where events are wanted.
if TYPE_CHECKING:
    from dogbot_logtool.core.statistics import Stats


@dataclass(frozen=True, slots=True)
class WalkEvents:
    """Messages of a log's events."""

    events: tuple[EventMessage, ...]
    event_log_time: Ints
    """(events,) ns."""
    gaits: tuple[GaitState, ...]
    gait_log_time: Ints
    """(gaits,) ns."""


def walk_events(stats: "Stats", start: int | None, end: int | None) -> WalkEvents:
    """Return the events of a log with their log times.

    Args:
        stats: figures of the log.
        start: ns, log time of its first message; None: not known.
        end: ns, of its last.
    """
    from dogbot_logtool.core.events.log_messages import (  # noqa: PLC0415
        event_messages,
        gait_states,
        to_log_time,
    )

    events, gaits = event_messages(stats), gait_states(stats)
    times = []
    for each in (events, gaits):
        time = to_log_time(stats, np.array([one.time for one in each], np.int64))
        times.append(time if start is None or end is None else np.clip(time, start, end))
    return WalkEvents(events, times[0], gaits, times[1])


def event_records(annotations: Annotations, walk: WalkEvents) -> list[MessageRecords]:
    """Return the messages of `/gait` and `/events`; nothing of what there is none."""
    encoding, channels = annotations.encoding, annotations.event_channels
    if channels is None:
        return []
    gaits = [encoding.gait(each) for each in walk.gaits]
    events = [encoding.event(each) for each in walk.events]
    parts = [
        (channels.gait, gaits, walk.gait_log_time),
        (channels.events, events, walk.event_log_time),
    ]
    if channels.spans is not None:
        # A viewer's timeline shows what calls for a look; steps are in the log panel.
        odd = [row for row, each in enumerate(walk.events) if not each.is_step]
        spans = [encoding.span(walk.events[row]) for row in odd]
        parts.append((channels.spans, spans, walk.event_log_time[odd]))
    return [_records(*part) for part in parts if part[1]]


def _records(channel: int, payloads: Sequence[bytes], log_time: Ints) -> MessageRecords:
    size = np.array([len(each) for each in payloads], np.int64)
    end = np.cumsum(size)
    count = len(payloads)
    return recorded(
        np.full(count, channel, np.int64),
        np.zeros(count, np.int64),
        log_time,
        log_time,
        np.frombuffer(b"".join(payloads), np.uint8),
        end - size,
        end,
    )
