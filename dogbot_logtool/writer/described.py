"""The messages that we add, in terms of ROS 2; `encodings/` writes them as other messages, too.

Beside each message stand the columns of its slots.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Float32s, Floats
from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.writer.template import Columns, Literal, Of, Slot

TF: Final = "tf2_msgs/msg/TFMessage"
MARKER: Final = "visualization_msgs/msg/Marker"
MARKERS: Final = "visualization_msgs/msg/MarkerArray"
LOG: Final = "rcl_interfaces/msg/Log"
STRING: Final = "std_msgs/msg/String"
LOAD: Final = "dogbot_logtool/msg/Load"
GAIT: Final = "dogbot_logtool/msg/Gait"
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
STAMP: Final[Literal] = {name: Slot(f"stamp.{name}", Of.TIME) for name in ("sec", "nanosec")}
"""Slots of a message's time."""
_SOURCE: Final = "dogbot_logtool"
"""The program that log panels name."""


@dataclass(frozen=True, slots=True)
class Described:
    """A message in terms of ROS 2."""

    name: str
    """Of its type."""
    literal: Literal
    entity: str = ""
    """The name in Foxglove's scenes of what markers draw."""
    lifetime_s: float = 0.0
    """Of that; 0: for ever."""


def slots(names: str, prefix: str = "", of: Of = Of.NUMBER) -> Literal:
    """Return slots of the parts of a vector, a quaternion or a colour."""
    return {name: Slot(f"{prefix}{name}", of) for name in names}


def parts(names: str, values: Floats | Float32s, prefix: str = "") -> Columns:
    """Return the parts of vectors, quaternions or colours, (n, parts), as columns of `slots`."""
    return {f"{prefix}{name}": column for name, column in zip(names, values.T, strict=True)}


def parts_of_each(names: str, values: Floats, prefix: str) -> Columns:
    """Return the parts of k vectors a message, (n, k, parts), numbered behind the prefix."""
    columns: dict[str, NDArray[Any]] = {}
    for index in range(values.shape[1]):
        columns |= parts(names, values[:, index], f"{prefix}{index}.")
    return columns


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
                "translation": slots("xyz", f"t{index}."),
                "rotation": slots("xyzw", f"q{index}."),
            },
        }
        for index, (parent, child) in enumerate(pairs)
    ]
    return Described(TF, {"transforms": each})


def transform_columns(translation: Floats, rotation: Floats) -> Columns:
    """Return the columns of k transforms, (n, k, 3) m and (n, k, 4) quaternions x y z w."""
    return {**parts_of_each("xyz", translation, "t"), **parts_of_each("xyzw", rotation, "q")}


def load(state: str, in_contact: bool) -> Described:  # noqa: FBT001 - what differs
    """Describe a foot's load in one of `LOAD_STATES`: slots ``force`` and ``force_bw``."""
    values = {name: Slot(name) for name in ("force", "force_bw")}
    return Described(LOAD, {"stamp": STAMP, "state": state, "in_contact": in_contact, **values})


def text(data: str) -> Described:
    """Describe a text."""
    return Described(STRING, {"data": data})


def gait(state: GaitState) -> Described:
    """Describe the gait from a time on."""
    names = "gait", "stride_frequency_hz", "duty_factor", "phases"
    values = {name: getattr(state, name) for name in names}
    return Described(GAIT, {"stamp": time(state.time), **values})


def event(happened: EventMessage) -> Described:
    """Describe an event for log panels."""
    literal = {
        "stamp": time(happened.time),
        "level": 10 * happened.level,
        "name": happened.source,
        "msg": happened.text,
        "file": _SOURCE,
    }
    return Described(LOG, literal)


def span(happened: EventMessage) -> Described:
    """Describe an event from its begin to its end."""
    details = [{"key": key, "value": value} for key, value in happened.details.items()]
    times = {"start_time": time(happened.time), "end_time": time(happened.end)}
    return Described(SPAN, {**times, "metadata": details})
