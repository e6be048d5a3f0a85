"""Events in the figures over time: bands, lines for instants, and the names of some."""

from collections.abc import Iterable, Sequence
from typing import Any, Final

from dogbot_logtool.core.events.event import STEPS, EventType
from dogbot_logtool.core.metrics import Event, WalkMetrics
from dogbot_logtool.report.page.chart import BAD, NEUTRAL, Drawing, note, translucent

MOST_SHOWN: Final = 200
"""Events in the list, and marks in each figure."""
_LABELLED: Final = 12
"""Most bands that are named in the gait diagram."""
MINOR: Final = frozenset({EventType.GAIT_CHANGE, EventType.GAP, EventType.EARLY_CONTACT})
"""Types that are no fault of the walk."""
_FALLS: Final = frozenset({EventType.FALL, EventType.TIPPING})


def listed_events(walk: WalkMetrics) -> Sequence[Event]:
    """Return the events that call for a look: all but touchdowns and lift-offs."""
    return [each for each in walk.events if each.type not in STEPS]


def mark_events(events: Sequence[Event], drawings: Iterable[Drawing], feet: Sequence[str]) -> None:
    """Mark events in all figures over time, and name them in that with the rows of the feet.

    A fall is darkest; what only the recording does is grey. Events of one foot stand in its row;
    in figures without rows they have no more than an outline.
    """
    shown = events[:MOST_SHOWN]
    for drawing in drawings:
        if drawing.over_time:
            drawing.layout["shapes"] = [_mark(each, drawing, feet) for each in shown]
        if drawing.name == "gait":
            drawing.layout["annotations"] = _names(shown)


def _mark(event: Event, drawing: Drawing, feet: Sequence[str]) -> dict[str, Any]:
    colour = NEUTRAL if event.type in MINOR else BAD
    filled = 0.28 if event.type in _FALLS else 0.12
    edges = {"yref": "paper", "y0": 0.0, "y1": 1.0}
    if event.foot is not None and drawing.feet:
        edges = dict(drawing.feet[feet.index(event.foot)])
    elif event.foot is not None:
        filled = 0.0
    return {
        "type": "rect",
        "xref": "x",
        "x0": event.onset_s,
        "x1": event.onset_s + event.duration_s,
        **edges,
        "fillcolor": translucent(colour, filled),
        "line": {"width": 1, "color": colour},
        "layer": "below",
    }


def _names(events: Sequence[Event]) -> list[dict[str, Any]]:
    """Name the first event of each kind, and every fall."""
    first: dict[str, Event] = {}
    for each in events:
        first.setdefault(each.type, each)
    named = [
        each
        for each in events
        if each.type in _FALLS or (each.type not in MINOR and first[each.type] is each)
    ]
    return [
        note(each.type.replace("_", " "), x=each.onset_s, xref="x", xanchor="left")
        for each in named[:_LABELLED]
    ]
