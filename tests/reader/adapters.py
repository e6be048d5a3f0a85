"""Every adapter of the reader, with messages that it can be given."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Final

import numpy as np
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.reader.containers.log import Batch, Channel, Messages, Schema
from dogbot_logtool.reader.decode.paths import MOST_ELEMENTS
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.bases import Base
from dogbot_logtool.reader.messages.contacts import read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels, feet_in
from dogbot_logtool.reader.messages.messages import malformed_in
from dogbot_logtool.reader.messages.others import TRANSFORM_TYPES, read_transforms
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from tests.oracles import base_walks, state_walks, walks

SAME_AS: Final = {
    "go2_interfaces/LowState": "unitree_go/msg/LowState",
    "ros2_unitree_legged_msgs/LowState": "unitree_go/msg/LowState",
    "ros2_unitree_legged_msgs/HighState": "unitree_go/msg/SportModeState",
    "tf/tfMessage": "tf2_msgs/msg/TFMessage",
}
"""Types of other drivers, with a type that has the same fields."""
FOXGLOVE: Final = ("foxglove.FrameTransforms", "foxglove.FrameTransform")
VARIANTS: Final = (
    "old_xpp/RobotStateCartesian",
    "old_whole_body/WholeBodyState",
    "old_dwl/WholeBodyState",
)
"""Earlier definitions of types, by the packages that the tests give them."""
FOOT_TYPES: Final = types_of("feet")
BASES: Final = tuple(
    name
    for name in types_of("base")
    if name not in FOOT_TYPES and name not in TRANSFORM_TYPES and not name.startswith("foxglove")
)
"""Types of base poses; their elements are those of `base_walks`."""
DECODED: Final = (*BASES, *sorted(TRANSFORM_TYPES), *FOOT_TYPES, *VARIANTS)
"""Types whose definitions stand in the log."""
POSES: Final = ("foxglove.Odometry", "foxglove.PoseInFrame")
ALL: Final = (*DECODED, *FOXGLOVE, *POSES)
STEP_NS: Final = 10_000_000


@dataclass(frozen=True)
class Outcome:
    """What an adapter made of a batch."""

    log_time: Ints
    """(m,) ns, of the rows; an adapter that tells of several feet has a row for each."""
    malformed: dict[int, int]


@cache
def walk() -> state_walks.StateWalk:
    return state_walks.StateWalk(2)


def definition(type_name: str) -> str:
    """Return the definition of a type, with all that it depends on."""
    if type_name in BASES:
        return base_walks.definition(type_name)
    return walk().definition(_known(type_name))


def _known(type_name: str) -> str:
    package, _, name = type_name.partition("/")
    return SAME_AS.get(type_name, f"{package}/msg/{name}")


@cache
def payloads(type_name: str, count: int) -> tuple[bytes, ...]:
    """Return sound messages; feet are in contact in some of them."""
    if type_name in FOXGLOVE:
        return tuple(_foxglove(type_name, number) for number in range(count))
    kind = _known(type_name)
    samples = range(20, 20 + count)
    if type_name in (*BASES, *POSES):
        return tuple(base_walks.message(type_name, sample) for sample in samples)
    if type_name in TRANSFORM_TYPES:
        return tuple(walk().bytes_of(kind, transforms(sample)) for sample in samples)
    return tuple(
        walk().bytes_of(kind, next(iter(walk().contacts(kind, sample)))[1]) for sample in samples
    )


def empty_payload(type_name: str) -> bytes:
    """Return a sound message whose arrays are empty."""
    made, kind = walk(), _known(type_name)
    fields = dict(made.store.fielddefs[kind][1])
    frames = {"header": made.header(0, "world")} if "header" in fields else {}
    return made.bytes_of(kind, made.make(kind, **frames))


def transforms(sample: int) -> Any:
    """Return a message of two transforms."""
    made = walk()
    stamped = [
        {
            "header": made.header(sample, "base"),
            "child_frame_id": f"leg_{leg}",
            "transform": [(0.1 * sample, 0.0, 0.0)],
        }
        for leg in range(2)
    ]
    return made.make("tf2_msgs/TFMessage", transforms=stamped)


def _foxglove(type_name: str, number: int) -> bytes:
    one = FrameTransform(parent_frame_id="base", child_frame_id="leg")
    one.timestamp.nanos = number
    if type_name == FOXGLOVE[1]:
        return one.SerializeToString()
    return FrameTransforms(transforms=[one]).SerializeToString()


def channel(type_name: str, text: str | None = None, topic: str = "/topic/joint_foot") -> Channel:
    """Return a channel of a type; the text is its definition, if not the usual one."""
    if type_name in (*FOXGLOVE, *POSES):
        return Channel(1, topic, "protobuf", Schema(1, type_name, "protobuf", b""), {})
    data = (definition(type_name) if text is None else text).encode()
    return Channel(1, topic, "cdr", Schema(1, type_name, "ros2msg", data), {})


def batch(messages: Sequence[bytes]) -> Batch:
    """Return a batch of one channel's messages, recorded every 10 ms."""
    sizes = np.array([len(data) for data in messages], np.int64)
    end = np.cumsum(sizes)
    count = len(messages)
    log_time = walks.START + np.arange(count) * STEP_NS
    columns = Messages(np.ones(count, np.int64), log_time, log_time, end, end - sizes, end)
    return Batch(np.frombuffer(b"".join(messages), np.uint8), columns, ())


def feet(type_name: str) -> FootChannels:
    """Return four feet that channel 1 tells of."""
    one = [
        replace(Foot(leg, "/topic"), element=row, newtons_per_count=1.0)
        for row, leg in enumerate(walks.LEGS)
    ]
    labelled = [replace(foot, label=_labels(type_name).get(foot.name, "")) for foot in one]
    return FootChannels(labelled, {1: (0, 1, 2, 3)})


def _labels(type_name: str) -> Mapping[str, str]:
    """Return what messages of a type call the feet."""
    if type_name.startswith("syropod"):
        return state_walks.TIPS
    return state_walks.SENSORS if type_name.startswith("hrpsys") else state_walks.LABELS


def source(of: Channel) -> Source | None:
    """Return how a channel is read."""
    bases = (*BASES, *POSES, *TRANSFORM_TYPES, *FOXGLOVE)
    return source_of(of, "base" if of.type_name in bases else "feet")


def read(of: Channel, given: Batch) -> Outcome:
    """Decode a batch, and make all that the adapter can make of it."""
    if of.type_name in (*FOXGLOVE, *TRANSFORM_TYPES):
        read = list(read_transforms(given, [of], static=False))
        lost = {number: count for *_, malformed in read for number, count in malformed.items()}
        return Outcome(_times([own.log_time for each, *_ in read for own in each.values()]), lost)
    how = source(of)
    if of.type_name in (*BASES, *POSES):
        assert how is not None
        base = Base(how, base_walks.ELEMENTS.get(of.type_name, ""))
        parts = base.read(given, [of])
        malformed = {number: lost for part in parts for number, lost in part.malformed.items()}
        return Outcome(_times([part.poses.log_time for part in parts]), malformed)
    found = read_contacts(given, [of], feet(of.type_name))
    for each in found:
        assert each.links is not None
        assert each.source.row.pairs or len(feet_in(each.source, each.messages)) <= MOST_ELEMENTS
        if each.source.has_header:
            each.messages.table.nanoseconds("header.stamp")
    times = _times([each.samples.log_time for each in found])
    return Outcome(times, malformed_in(each.messages for each in found))


def _times(parts: Sequence[Ints]) -> Ints:
    return np.concatenate([np.empty(0, np.int64), *parts])


Damage = Callable[[bytes], bytes]
DAMAGES: Final[dict[str, Damage]] = {
    "empty": lambda _: b"",
    "cut": lambda data: data[: len(data) // 2],
    "garbage": lambda data: b"\xff" * len(data),
    "too long": lambda data: data + b"\x07" * 9,
}
