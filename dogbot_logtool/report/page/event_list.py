"""Events on the page: a list whose rows lead to the figures over time, and marks in these."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from dogbot_logtool.core.events.event import STEPS, Event, EventType
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.charts.drawing import BAD, NEUTRAL, Drawing, translucent

MOST_SHOWN: Final = 200
"""Events in the list, and marks in each figure."""
_LABELLED: Final = 12
"""Most bands that are named in the gait diagram."""
_MINOR: Final = frozenset({EventType.GAIT_CHANGE, EventType.GAP, EventType.EARLY_CONTACT})
"""Types that are no fault of the walk."""


_FALLS: Final = frozenset({EventType.FALL.value, EventType.TIPPING.value})


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
    foot_number: int | None = None
    """Index of the foot; None: it happened to the robot or to the base's poses."""


@dataclass(frozen=True, slots=True)
class EventList:
    """The events that call for a look."""

    rows: Sequence[EventRow]
    left_out: int
    """How many more there are."""


def event_list(stats: Walk) -> EventList:
    """Return the events but for touchdowns and lift-offs, in the order of time."""
    found = [each for each in find_events(stats) if each.type not in STEPS]
    rows = [_row(stats, each) for each in found[:MOST_SHOWN]]
    return EventList(rows, len(found[MOST_SHOWN:]))


def _row(stats: Walk, event: Event) -> EventRow:
    start = (event.onset - stats.origin) / 1e9
    size = "" if event.value is None else f"{event.value:.3g} {event.unit}"
    return EventRow(
        start,
        start + event.duration / 1e9,
        event.type.replace("_", " "),
        "" if event.foot is None else stats.feet[event.foot].name,
        size,
        event.code,
        event.type in _MINOR,
        event.foot,
    )


def marks(events: EventList, drawing: Drawing) -> list[dict[str, Any]]:
    """Return what shows the events in a figure over time: bands, or lines for instants.

    A fall is darkest; what only the recording does is grey. Events of one foot stand in its row;
    in figures without rows they have no more than an outline.
    """
    return [_mark(row, drawing) for row in events.rows]


def _mark(row: EventRow, drawing: Drawing) -> dict[str, Any]:
    low, high, filled = 0.0, 1.0, 0.28 if row.what in _FALLS else 0.12
    if row.foot_number is not None:
        low, high = drawing.feet[row.foot_number] if drawing.feet else (low, high)
        filled = filled if drawing.feet else 0.0
    return {
        "type": "rect",
        "xref": "x",
        "yref": "paper",
        "x0": row.start_s,
        "x1": row.end_s,
        "y0": low,
        "y1": high,
        "fillcolor": translucent(_colour(row), filled),
        "line": {"width": 1, "color": _colour(row)},
        "layer": "below",
    }


def band_labels(events: EventList) -> list[dict[str, Any]]:
    """Return the names of the bands: the first of each kind, and every fall."""
    seen: set[str] = set()
    found = []
    for row in events.rows:
        if row.what in _FALLS or (row.what not in seen and not row.is_minor):
            found.append(row)
        seen.add(row.what)
    return [
        {
            "text": row.what,
            "x": row.start_s,
            "xref": "x",
            "xanchor": "left",
            "y": 1,
            "yref": "paper",
            "yanchor": "bottom",
            "showarrow": False,
            "font": {"size": 11},
        }
        for row in found[:_LABELLED]
    ]


def _colour(row: EventRow) -> str:
    return NEUTRAL if row.is_minor else BAD
