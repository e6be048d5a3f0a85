"""The messages that we add, in terms of ROS 2; `encodings/` writes them as other messages, too.

Slots have the names of the columns that are drawn.
"""

from collections.abc import Mapping, Sequence
from math import nan
from typing import Final, NamedTuple

from dogbot_logtool.core.events import LEVELS, WARNING, text_of
from dogbot_logtool.core.metrics import Event, Gait
from dogbot_logtool.writer.template import Literal, Of, Slot

TF: Final = "tf2_msgs/msg/TFMessage"
MARKER: Final = "visualization_msgs/msg/Marker"
MARKERS: Final = "visualization_msgs/msg/MarkerArray"
LOG: Final = "rcl_interfaces/msg/Log"
STRING: Final = "std_msgs/msg/String"
LOAD: Final = "dogbot_logtool/msg/Load"
GAIT: Final = "dogbot_logtool/msg/Gait"
ROS_TYPES: Final = TF, MARKER, MARKERS, LOG, STRING, LOAD, GAIT
SPAN: Final = "foxglove/msg/Event"
"""An event from its begin to its end, which ROS has no message for."""
OWN_FIELDS: Final[Mapping[str, tuple[tuple[str, str, int], ...]]] = {
    LOAD: (
        ("in_contact", "bool", 2),  # as the sensor reports it
        ("state", "string", 5),  # stance, swing or unknown
        ("force", "float64", 3),  # N, magnitude; NaN when not known
        ("force_bw", "float64", 4),  # body weights; NaN when the robot's mass is not known
    ),
    GAIT: (
        ("gait", "string", 2),  # class, or unknown
        ("stride_frequency_hz", "float64", 3),  # NaN without strides
        ("duty_factor", "float64", 4),
        ("phases", "float64[]", 5),  # cycles, of each foot
    ),
}
"""Name, type and number in protobuf of the fields of our own messages, behind a stamp."""
LOAD_STATES: Final = ("stance", "swing", "unknown")
"""Values of a load's `state`, in the order of `LoadState`."""
STAMP: Final[Literal] = {name: Slot(f"stamp.{name}", of=Of.TIME) for name in ("sec", "nanosec")}
"""Slots of a message's time."""
_SOURCE: Final = "dogbot_logtool"
"""The program that log panels name."""


class Described(NamedTuple):
    """A message in terms of ROS 2."""

    name: str
    """Of its type."""
    literal: Literal
    entity: str = ""
    """The name in Foxglove's scenes of what markers draw."""
    lifetime_s: float = 0.0
    """Of that; 0: for ever."""


def slots(parts: str, name: str, *index: int, of: Of = Of.NUMBER) -> Literal:
    """Return slots of the parts of a vector, a quaternion or a colour, (..., parts) in a row."""
    return {part: Slot(name, (*index, number), of) for number, part in enumerate(parts)}


def time(nanoseconds: int) -> Literal:
    """Return a time, ns."""
    seconds, rest = divmod(nanoseconds, 1_000_000_000)
    return {"sec": seconds, "nanosec": rest}


def transforms(pairs: Sequence[tuple[str, str]]) -> Described:
    """Describe the transforms of some parents and children."""
    each = [
        {
            "header": {"stamp": STAMP, "frame_id": parent},
            "child_frame_id": child,
            "transform": {
                "translation": slots("xyz", "translation", index),
                "rotation": slots("xyzw", "rotation", index),
            },
        }
        for index, (parent, child) in enumerate(pairs)
    ]
    return Described(TF, {"transforms": each})


def load(state: str, in_contact: bool) -> Described:  # noqa: FBT001 - what differs
    """Describe a foot's load in one of `LOAD_STATES`."""
    values = {"force": Slot("force"), "force_bw": Slot("body_weights")}
    return Described(LOAD, {"stamp": STAMP, "state": state, "in_contact": in_contact, **values})


def text(data: str) -> Described:
    """Describe a text."""
    return Described(STRING, {"data": data})


def gait(since: int, now: Gait) -> Described:
    """Describe the gait from a time, ns, on; a number that is not known is NaN."""
    means = (phase.mean for phase in now.phase.values())
    rate, duty, *phases = (
        nan if each is None else each for each in (now.stride_frequency_hz, now.duty_factor, *means)
    )
    numbers = {"stride_frequency_hz": rate, "duty_factor": duty, "phases": tuple(phases)}
    return Described(GAIT, {"stamp": time(since), "gait": now.name or "unknown", **numbers})


def event(onset: int, happened: Event) -> Described:
    """Describe an event that begins at a time, ns, for log panels."""
    literal = {
        "stamp": time(onset),
        "level": 10 * LEVELS.get(happened.type, WARNING),
        "name": happened.foot or "robot",
        "msg": text_of(happened),
        "file": _SOURCE,
    }
    return Described(LOG, literal)


def span(onset: int, happened: Event) -> Described:
    """Describe an event from its begin, ns, to its end."""
    value = "" if happened.value is None else f"{happened.value:.9g}"
    texts = {"type": happened.type, "foot": happened.foot, "value": value}
    texts |= {"unit": happened.unit, "code": happened.code}
    details = [{"key": key, "value": text} for key, text in texts.items() if text]
    end = onset + round(happened.duration_s * 1e9)
    times = {"start_time": time(onset), "end_time": time(end)}
    return Described(SPAN, {**times, "metadata": details})
