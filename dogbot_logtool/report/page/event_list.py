"""Events on the page: a list whose rows lead to the figures over time, and marks in these."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from dogbot_logtool.core.events.event import STEPS, EventType
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.events import EventSource, event_sources
from dogbot_logtool.report.page.drawing import BAD, NEUTRAL, translucent

MOST_SHOWN: Final = 200
"""Events in the list, and marks in each figure."""
_MINOR: Final = frozenset({EventType.GAIT_CHANGE, EventType.GAP, EventType.EARLY_CONTACT})
"""Types that are no fault of the walk."""


@dataclass(frozen=True, slots=True)
class EventRow:
    """One event of the list."""

    start_s: float
    end_s: float
    what: str
    foot: str
    size: str
    """Its value with unit; empty: there is none."""
    code: str
    is_minor: bool


@dataclass(frozen=True, slots=True)
class EventList:
    """The events that call for a look."""

    rows: Sequence[EventRow]
    left_out: int
    """How many more there are."""


def event_list(stats: Stats) -> EventList:
    """Return the events but for touchdowns and lift-offs, in the order of time."""
    found = [each for each in event_sources(stats) if each.event.type not in STEPS]
    return EventList([_row(each) for each in found[:MOST_SHOWN]], len(found[MOST_SHOWN:]))


def _row(source: EventSource) -> EventRow:
    event = source.event
    start = (event.onset - source.origin) / 1e9
    size = "" if event.value is None else f"{event.value:.3g} {event.unit}"
    return EventRow(
        start,
        start + event.duration / 1e9,
        event.type.replace("_", " "),
        source.foot or "",
        size,
        event.code,
        event.type in _MINOR,
    )


def marks(events: EventList) -> list[dict[str, Any]]:
    """Return what shows the events in a figure over time: bands, or lines for instants."""
    return [
        {
            "type": "rect",
            "xref": "x",
            "yref": "paper",
            "x0": row.start_s,
            "x1": row.end_s,
            "y0": 0,
            "y1": 1,
            "fillcolor": translucent(NEUTRAL if row.is_minor else BAD, 0.12),
            "line": {"width": 1, "color": translucent(NEUTRAL if row.is_minor else BAD, 0.6)},
            "layer": "below",
        }
        for row in events.rows
    ]
