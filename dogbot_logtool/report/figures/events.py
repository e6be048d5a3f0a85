"""Figures of every event: the rows of JSON, CSV and Parquet."""

from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import Figure, Kind


@dataclass(frozen=True, slots=True)
class EventSource:
    """The source of an event's figures."""

    event: Event
    origin: int
    """ns, what times are counted from."""
    foot: str | None
    """Name."""


def event_sources(stats: Stats) -> tuple[EventSource, ...]:
    """Return all events of a log, with the names of their feet."""
    names = [foot.name for foot in stats.feet]
    return tuple(
        EventSource(each, stats.origin, None if each.foot is None else names[each.foot])
        for each in find_events(stats)
    )


MEANINGS: Final[Mapping[EventType, str]] = {
    EventType.FALL: "descent from standing to lying, until the robot lies no more",
    EventType.TIPPING: "roll or pitch leaves its usual range and the recording ends",
    EventType.CARRIED: "no foot is down for longer than a leap takes, and the base is as high as "
    "it stands, or higher (value: by how much)",
    EventType.STUMBLE: "a foot in mid-swing touches something and swings on (value: part of the "
    "swing before it)",
    EventType.SLIP: "the contact point of a loaded foot goes three times as far as in the foot's "
    "other stances and 5 mm more, or three times as far as `settings.foot_rolling_m`; or, within "
    "60 ms and on a single contact point, twice as far as in those and 5 mm more (value: how much "
    "further)",
    EventType.EARLY_CONTACT: "a swing ends before 0.7 of the foot's usual swing and the foot stays "
    "down (value: how much too early)",
    EventType.MARGIN_BELOW_ZERO: "the base's projection leaves the support polygon by more than "
    "1 cm for at least 80 ms (value: least margin)",
    EventType.GAIT_CHANGE: "the class or the stride period changes for at least two strides, or a "
    "stand begins or ends (value: new stride frequency)",
    EventType.POSE_JUMP: "a step of the pose that the base's speed does not explain",
    EventType.SENSOR_FAULT: "what findings call stuck, dead, saturated or a lone spike",
    EventType.GAP: "silence of a foot's sensor or of the odometry that ends what is known",
    EventType.TOUCHDOWN: "a foot comes down",
    EventType.LIFT_OFF: "a foot leaves the ground",
}
"""Descriptions of events by type."""
EVENTS: Final[Sequence[Figure[EventSource]]] = (
    Figure(
        "onset_s",
        Kind.NUMBER,
        lambda source: (source.event.onset - source.origin) / 1e9,
        "when it begins, since the log's start",
    ),
    Figure(
        "duration_s",
        Kind.AMOUNT,
        lambda source: source.event.duration / 1e9,
        "how long it lasts; 0 for an instant",
    ),
    Figure(
        "type",
        Kind.TEXT,
        lambda source: source.event.type.value,
        "; ".join(f"`{kind}`: {words}" for kind, words in MEANINGS.items()),
        choices=tuple(each.value for each in EventType),
    ),
    Figure(
        "foot",
        Kind.TEXT,
        lambda source: source.foot,
        "name of the foot",
        null="it happened to the whole robot, or to the odometry",
    ),
    Figure(
        "value",
        Kind.NUMBER,
        lambda source: source.event.value,
        "how much, in the unit beside it",
        null="nothing is measured of it",
    ),
    Figure(
        "unit",
        Kind.TEXT,
        lambda source: source.event.unit or None,
        "unit of the value; `swing` is the share of a swing",
        null="there is no value",
    ),
    Figure(
        "code",
        Kind.TEXT,
        lambda source: source.event.code or None,
        "code of the finding about it; of a change of the gait both classes, `trot>walk`",
        null="no finding is about it",
    ),
)
"""Figures of an `EventSource`."""
EVENT_COLUMNS: Final = tuple(figure.key for figure in EVENTS)
