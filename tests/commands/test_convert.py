"""Conversion against an oracle that takes one message at a time.

The logs are read with the containers' own libraries and decoded by rosbags with the definitions
that are recorded in them. What should be written is computed in plain Python, a message at a time,
by the formulas of the README; what was written is read and decoded by the mcap library and its
decoders, checksums and all. Nothing of the product takes part in either.
"""

import json
import math
import multiprocessing
import re
import threading
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import pytest
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders
from pymcap_cli.cli import app as pymcap_cli
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.pipeline.options import ConvertOptions, EncodingName, Style, TopicOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from tests.frames_oracle import Frames, frames_of
from tests.paths import SAMPLE_LOGS

TROT, WALK, TROUBLED = (
    SAMPLE_LOGS / f"dogbot_{name}" for name in ("trot.bag", "walk.mcap", "troubled.bag")
)
LOGS = (TROT, WALK, TROUBLED)
IN_WORLD = {TROT: False, WALK: True, TROUBLED: False}
"""Whether wrenches are in the world frame, as the logs' truths say."""
FEET = ("front_left", "front_right", "back_left", "back_right")
ODOMETRY = "/dogbot/odom"
BODY_WEIGHT_N = 21.261 * 9.81
TICK_NS = 20_000_000
S = 1_000_000_000

ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
CONTACTS_TYPE = "gazebo_msgs/msg/ContactsState"
TF_TYPE = "tf2_msgs/msg/TFMessage"
TEXT_TYPE = "std_msgs/msg/String"
ENCODINGS: tuple[EncodingName, ...] = get_args(EncodingName)
STYLES: tuple[Style, ...] = get_args(Style)
COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)
CLASSIC_TILT = (0.0, math.sin(-0.785), 0.0, math.cos(-0.785))
STRAIGHT_UP = (0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5))


def contact_topic(foot: str) -> str:
    return f"/dogbot/{foot}_contactsensor_state"


def arrow_topic(foot: str) -> str:
    return f"/marker_basic_{foot}_foot"


def load_topic(foot: str) -> str:
    return f"/load/{foot}"


# --- Reading logs ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Recorded:
    """A message as its container's own library reads it."""

    topic: str
    type_name: str
    definition: str
    log_time: int
    publish_time: int
    sequence: int
    data: bytes


def read_bag(path: Path) -> list[Recorded]:
    with BagReader(path) as reader:
        return [
            Recorded(c.topic, c.msgtype, c.msgdef.data, log_time, log_time, 0, data)
            for c, log_time, data in reader.messages()
        ]


def read_mcap(path: Path) -> list[Recorded]:
    with path.open("rb") as stream:
        return [
            Recorded(
                channel.topic,
                schema.name if schema else "",
                schema.data.decode("utf-8", "replace") if schema else "",
                message.log_time,
                message.publish_time,
                message.sequence,
                message.data,
            )
            for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages()
        ]


@cache
def read_log(path: Path) -> list[Recorded]:
    """Return a log's messages in the order of their log times."""
    return read_bag(path) if path.suffix == ".bag" else read_mcap(path)


@dataclass(frozen=True, slots=True)
class Decoded:
    log_time: int
    message: Any


@cache
def decoded_log(path: Path) -> dict[str, list[Decoded]]:
    """Decode a log's messages by topic; those of ROS 1 in the order in which they were sent."""
    store = get_typestore(Stores.EMPTY)
    topics: dict[str, list[Decoded]] = defaultdict(list)
    ros1 = path.suffix == ".bag"
    decode = store.deserialize_ros1 if ros1 else store.deserialize_cdr
    known: set[str] = set()
    for recorded in read_log(path):
        if recorded.type_name not in known:
            known.add(recorded.type_name)
            types = get_types_from_msg(recorded.definition, recorded.type_name)
            store.register({k: v for k, v in types.items() if k not in store.fielddefs})
        message = decode(recorded.data, recorded.type_name)
        topics[recorded.topic].append(Decoded(recorded.log_time, message))
    if ros1:
        for topic, messages in topics.items():
            if topic in {ODOMETRY, *map(contact_topic, FEET)}:
                messages.sort(key=lambda one: one.message.header.seq)
    return dict(topics)


# --- What should be written, a message at a time --------------------------------------------------


def light(wavelength: float) -> tuple[float, float, float]:
    """Return the colour of light, as the live script computed it."""
    gamma = 0.8
    red = green = blue = 0.0
    if 380 <= wavelength <= 440:
        attenuation = 0.3 + 0.7 * (wavelength - 380) / (440 - 380)
        red = ((-(wavelength - 440) / (440 - 380)) * attenuation) ** gamma
        blue = (1.0 * attenuation) ** gamma
    elif 440 <= wavelength <= 490:
        green = ((wavelength - 440) / (490 - 440)) ** gamma
        blue = 1.0
    elif 490 <= wavelength <= 510:
        green = 1.0
        blue = (-(wavelength - 510) / (510 - 490)) ** gamma
    elif 510 <= wavelength <= 580:
        red = ((wavelength - 510) / (580 - 510)) ** gamma
        green = 1.0
    elif 580 <= wavelength <= 645:
        red = 1.0
        green = (-(wavelength - 645) / (645 - 580)) ** gamma
    elif 645 <= wavelength <= 750:
        attenuation = 0.3 + 0.7 * (750 - wavelength) / (750 - 645)
        red = (1.0 * attenuation) ** gamma
    return red, green, blue


def clamped_light(share: float) -> tuple[float, float, float]:
    return light(min(max(380.0 + share * 370.0, 380.0), 750.0))


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow that is drawn, or removed where it has no place."""

    log_time: int
    stamp: int
    position: tuple[float, ...] = ()
    orientation: tuple[float, ...] = ()
    length: float = 0.0
    colour: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Load:
    log_time: int
    stamp: int
    in_contact: bool
    force: float
    body_weights: float


@dataclass(frozen=True, slots=True)
class Sample:
    """A contact message reduced by hand."""

    in_contact: bool
    force: tuple[float, float, float]
    in_world: bool
    position: tuple[float, float, float] | None
    normal: tuple[float, float, float] | None


def xyz(vector: Any) -> tuple[float, float, float]:
    return float(vector.x), float(vector.y), float(vector.z)


def norm(vector: Iterable[float]) -> float:
    x, y, z = vector
    return math.sqrt(x * x + y * y + z * z)


def added(vectors: Iterable[Sequence[float]]) -> tuple[float, float, float]:
    x = y = z = 0.0
    for vector in vectors:
        x, y, z = x + vector[0], y + vector[1], z + vector[2]
    return x, y, z


def scaled(vector: Iterable[float], by: float) -> tuple[float, float, float]:
    x, y, z = vector
    return x * by, y * by, z * by


def stamp_of(decoded: Decoded) -> int:
    stamp = decoded.message.header.stamp
    return (int(stamp.sec) * S + int(stamp.nanosec)) or decoded.log_time


def step_of(state: Any) -> int:
    match = re.search(r"time:(?: \[)?(\d+)\.(\d+)", state.info)
    assert match is not None
    return int(match[1]) * S + int(match[2])


def sample_of(message: Any, foot: str) -> Sample:
    """Take the newest physics step, add its states up, and weigh its points by their forces."""
    newest = [s for s in message.states if step_of(s) == step_of(message.states[-1])]
    signs: list[float] = []
    states: list[Any] = []
    for state in newest:
        names = state.collision1_name, state.collision2_name
        first, second = (f"{foot}_foot" in name for name in names)
        if first != second:
            states.append(state)
            signs.append(1.0 if first else -1.0)
    points: list[tuple[tuple[float, float, float], float]] = []
    for state in states:
        count = len(state.contact_positions)
        paired = count == len(state.wrenches)
        for index, point in enumerate(state.contact_positions):
            force = state.wrenches[index].force if paired else state.total_wrench.force
            points.append((xyz(point), norm(xyz(force)) / (1 if paired else count)))
    if points and sum(weight for _, weight in points) == 0:
        points = [(point, 1.0) for point, _ in points]
    position = None
    if points:
        total = sum(weight for _, weight in points)
        position = scaled(added(scaled(point, weight) for point, weight in points), 1 / total)
    normals = [
        scaled(xyz(normal), sign)
        for state, sign in zip(states, signs, strict=True)
        for normal in state.contact_normals
    ]
    mean = added(normals)
    return Sample(
        in_contact=bool(states),
        force=added(
            scaled(xyz(state.total_wrench.force), sign)
            for state, sign in zip(states, signs, strict=True)
        ),
        in_world=bool(states) and all(sign < 0 for sign in signs),
        position=position,
        normal=scaled(mean, 1 / norm(mean)) if normals else None,
    )


def turn_x_to(direction: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the rotation about the axis x cross d by the angle between them."""
    x, y, z = direction
    angle = math.atan2(math.hypot(y, z), x)
    across = math.hypot(y, z)
    axis = (0.0, -z / across, y / across) if across else (0.0, 0.0, 1.0)
    half = math.sin(angle / 2)
    return axis[0] * half, axis[1] * half, axis[2] * half, math.cos(angle / 2)


@cache
def frames_in(path: Path) -> Frames:
    """Return the frames of a sample log: those of the other two are not in need."""
    topics = decoded_log(path)
    return frames_of(topics[ODOMETRY], topics["/tf"], log_time=path == TROUBLED)


def expected_arrow(
    decoded: Decoded, foot: str, style: Style, *, in_world: bool, frames: Frames | None = None
) -> Arrow | None:
    """Return what a message draws; None: nothing is written."""
    stamp = stamp_of(decoded)
    if style == "classic":
        return classic_arrow(decoded, stamp)
    sample = sample_of(decoded.message, foot)
    removed = Arrow(decoded.log_time, stamp)
    magnitude = norm(sample.force)
    if not sample.in_contact or sample.position is None or not magnitude > 0:
        return removed
    if not all(map(math.isfinite, (magnitude, *sample.position))):
        return removed
    orientation: tuple[float, ...] = STRAIGHT_UP
    share = magnitude / 200.0
    if style == "force":
        known = in_world or sample.in_world
        direction = scaled(sample.force, 1 / magnitude) if known else sample.normal
        pose = frames.in_world(f"{foot}_lowerleg", stamp, "world") if frames else None
        if pose and not known:
            direction = scaled(pose[1] @ np.array(sample.force), 1 / magnitude)
        if direction is None:
            return removed
        orientation = turn_x_to(direction)
        share = magnitude / (1.5 * BODY_WEIGHT_N)
    colour = (*clamped_light(share), 1.0)
    return Arrow(decoded.log_time, stamp, sample.position, orientation, magnitude / 100.0, colour)


def classic_arrow(decoded: Decoded, stamp: int) -> Arrow | None:
    """Transcribe `arrows_rviz.py`; where it raised nothing is written."""
    states = decoded.message.states
    if not states or not states[0].contact_positions:
        return None
    force = xyz(states[0].total_wrench.force)
    if any(math.isfinite(part) and math.isinf(part * part) for part in force):
        return None
    p = norm(force) / 100.0
    wavelength = 380 + ((p - 0.0) / (2.0 - 0.0)) * (750 - 380)
    position = xyz(states[0].contact_positions[0])
    return Arrow(decoded.log_time, stamp, position, CLASSIC_TILT, p, (*light(wavelength), 1.0))


def expected_arrows(path: Path, foot: str, style: Style, *, in_world: bool) -> list[Arrow]:
    turned = style == "force" and path in LOGS and not in_world
    frames = frames_in(path) if turned else None
    arrows = (
        expected_arrow(one, foot, style, in_world=in_world, frames=frames)
        for one in decoded_log(path).get(contact_topic(foot), ())
    )
    return sorted((a for a in arrows if a is not None), key=lambda arrow: arrow.log_time)


def expected_loads(path: Path, foot: str) -> list[Load]:
    loads: list[Load] = []
    for one in decoded_log(path).get(contact_topic(foot), ()):
        sample = sample_of(one.message, foot)
        force = norm(sample.force)
        loads.append(
            Load(one.log_time, stamp_of(one), sample.in_contact, force, force / BODY_WEIGHT_N)
        )
    return sorted(loads, key=lambda load: load.log_time)


@dataclass(frozen=True, slots=True)
class Pose:
    log_time: int
    stamp: int
    numbers: tuple[float, ...]
    """x, y, z and the quaternion's x, y, z, w."""


def expected_poses(path: Path, *, at_ticks: bool) -> list[Pose]:
    """Return the usable poses; at ticks, the first at or after each 20 ms."""
    poses: list[Pose] = []
    for one in decoded_log(path)[ODOMETRY]:
        pose = one.message.pose.pose
        q = pose.orientation
        rotation = float(q.x), float(q.y), float(q.z), float(q.w)
        numbers = (*xyz(pose.position), *rotation)
        if all(map(math.isfinite, numbers)) and any(rotation):
            poses.append(Pose(one.log_time, stamp_of(one), numbers))
    if not at_ticks:
        return poses
    times = [pose.stamp for pose in poses]
    ticks = range(times[0] // TICK_NS * TICK_NS, times[-1] + 1, TICK_NS)
    return [poses[place] for place in sorted({bisect_left(times, tick) for tick in ticks})]


# --- What was written -----------------------------------------------------------------------------


@dataclass(slots=True)
class Written:
    """A file that was written, as the mcap library reads it from front to back."""

    profile: str = ""
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    channels: dict[int, records.Channel] = field(default_factory=dict)
    messages: list[records.Message] = field(default_factory=list)
    attachments: list[records.Attachment] = field(default_factory=list)
    metadata: list[records.Metadata] = field(default_factory=list)
    statistics: records.Statistics | None = None
    chunk_compressions: list[str] = field(default_factory=list)
    decoders: Mapping[str, Any] = field(
        default_factory=lambda: {
            "protobuf": ProtobufDecoders(),
            "ros1": Ros1Decoders(),
            "cdr": Ros2Decoders(),
        }
    )
    """The libraries' decoders; they remember schemas by id, so every file needs its own."""

    def decode(self, schema: records.Schema, message: records.Message, encoding: str) -> Any:
        decoder = self.decoders[encoding].decoder_for(encoding, schema)
        assert decoder is not None
        return decoder(message.data)

    def encodings(self, topic: str) -> set[str]:
        return {c.message_encoding for c in self.channels.values() if c.topic == topic}

    def of(self, topic: str, encoding: str) -> list[tuple[records.Schema, records.Message]]:
        """Return a topic's messages of one encoding, in the order of their log times."""
        found = [
            (self.schemas[channel.schema_id], message)
            for message in self.messages
            if (channel := self.channels[message.channel_id]).topic == topic
            and channel.message_encoding == encoding
        ]
        return sorted(found, key=lambda one: one[1].log_time)


def read_written(path: Path) -> Written:
    """Read a file and let the library check its checksums, those of the chunks included."""
    written = Written()
    with path.open("rb") as stream:
        for record in StreamReader(stream, validate_crcs=True).records:
            match record:
                case records.Header():
                    written.profile = record.profile
                case records.Schema():
                    written.schemas[record.id] = record
                case records.Channel():
                    written.channels[record.id] = record
                case records.Message():
                    written.messages.append(record)
                case records.Attachment():
                    written.attachments.append(record)
                case records.Metadata():
                    written.metadata.append(record)
                case records.Statistics():
                    written.statistics = record
                case records.ChunkIndex():
                    written.chunk_compressions.append(record.compression)
                case _:
                    pass
    assert written.statistics is not None
    assert written.statistics.message_count == len(written.messages)
    counts = Counter(message.channel_id for message in written.messages)
    assert written.statistics.channel_message_counts == counts
    return written


def of_encoding(encoding: EncodingName) -> str:
    return {"foxglove": "protobuf", "ros1": "ros1", "ros2": "cdr"}[encoding]


def annotations(
    written: Written, topic: str, encoding: EncodingName, type_name: str
) -> Iterator[tuple[records.Message, Any]]:
    """Decode the annotations of a topic."""
    for schema, message in written.of(topic, of_encoding(encoding)):
        assert schema.name.replace("/msg/", "/") == type_name
        assert ("/msg/" in schema.name) == (encoding == "ros2")
        assert message.publish_time == message.log_time
        yield message, written.decode(schema, message, of_encoding(encoding))


def protobuf_time(stamp: Any) -> int:
    return int(stamp.seconds) * S + int(stamp.nanos)


def ros_time(stamp: Any) -> int:
    if hasattr(stamp, "nanosec"):
        return int(stamp.sec) * S + int(stamp.nanosec)
    return int(stamp.secs) * S + int(stamp.nsecs)


def numbers_of(place: Any, turn: Any) -> tuple[float, ...]:
    return (*xyz(place), float(turn.x), float(turn.y), float(turn.z), float(turn.w))


def written_poses(written: Written, topic: str, encoding: EncodingName) -> list[Pose]:
    poses: list[Pose] = []
    if encoding == "foxglove":
        for message, decoded in annotations(written, topic, encoding, "foxglove.FrameTransforms"):
            (one,) = decoded.transforms
            assert (one.parent_frame_id, one.child_frame_id) == ("world", "base_link")
            numbers = numbers_of(one.translation, one.rotation)
            poses.append(Pose(message.log_time, protobuf_time(one.timestamp), numbers))
        return poses
    for message, decoded in annotations(written, topic, encoding, "tf2_msgs/TFMessage"):
        (one,) = decoded.transforms[:1]
        if one.child_frame_id == "base_link":
            assert len(decoded.transforms) == 1
            assert one.header.frame_id == "world"
            numbers = numbers_of(one.transform.translation, one.transform.rotation)
            poses.append(Pose(message.log_time, ros_time(one.header.stamp), numbers))
    return poses


def written_arrows(
    written: Written, foot: str, encoding: EncodingName, style: Style
) -> list[Arrow]:
    if encoding == "foxglove":
        return foxglove_arrows(written, foot, style)
    return marker_arrows(written, foot, encoding, style)


def foxglove_arrows(written: Written, foot: str, style: Style) -> list[Arrow]:
    diameter = 0.1 if style == "classic" else 0.04
    arrows: list[Arrow] = []
    topic = arrow_topic(foot)
    for message, decoded in annotations(written, topic, "foxglove", "foxglove.SceneUpdate"):
        assert len(decoded.entities) + len(decoded.deletions) == 1
        for deletion in decoded.deletions:
            assert (deletion.id, deletion.type) == (foot, 0)
            arrows.append(Arrow(message.log_time, protobuf_time(deletion.timestamp)))
        for entity in decoded.entities:
            assert (entity.id, entity.frame_id) == (foot, "world")
            lifetime = entity.lifetime
            assert (lifetime.seconds, lifetime.nanos) == (0, 0 if style == "classic" else S // 2)
            (one,) = entity.arrows
            assert (one.shaft_diameter, one.head_diameter) == (diameter, 2 * diameter)
            length = one.shaft_length + one.head_length
            np.testing.assert_allclose(one.shaft_length, 0.77 * length, rtol=1e-14)
            arrows.append(
                Arrow(
                    message.log_time,
                    protobuf_time(entity.timestamp),
                    xyz(one.pose.position),
                    numbers_of(one.pose.position, one.pose.orientation)[3:],
                    length,
                    (one.color.r, one.color.g, one.color.b, one.color.a),
                )
            )
    return arrows


def marker_arrows(written: Written, foot: str, encoding: EncodingName, style: Style) -> list[Arrow]:
    diameter = 0.1 if style == "classic" else 0.04
    arrows: list[Arrow] = []
    topic = arrow_topic(foot)
    for message, one in annotations(written, topic, encoding, "visualization_msgs/Marker"):
        assert (one.ns, one.id, one.header.frame_id) == ("dogbot", 0, "world")
        stamp = ros_time(one.header.stamp)
        if one.action == 2:
            arrows.append(Arrow(message.log_time, stamp))
            continue
        assert (one.type, one.action, one.frame_locked) == (0, 0, False)
        assert (one.scale.y, one.scale.z) == (diameter, diameter)
        assert ros_time(one.lifetime) == (0 if style == "classic" else S // 2)
        arrows.append(
            Arrow(
                message.log_time,
                stamp,
                xyz(one.pose.position),
                numbers_of(one.pose.position, one.pose.orientation)[3:],
                one.scale.x,
                (one.color.r, one.color.g, one.color.b, one.color.a),
            )
        )
    return arrows


def written_loads(written: Written, foot: str, encoding: EncodingName) -> list[Load]:
    loads: list[Load] = []
    type_name = "dogbot_logtool.Load" if encoding == "foxglove" else "dogbot_logtool/Load"
    for message, one in annotations(written, load_topic(foot), encoding, type_name):
        if encoding == "foxglove":
            stamp = protobuf_time(one.timestamp)
            assert one.HasField("in_contact")
        else:
            stamp = ros_time(one.stamp)
        loads.append(Load(message.log_time, stamp, bool(one.in_contact), one.force, one.force_bw))
    return loads


def assert_same_arrows(actual: list[Arrow], expected: list[Arrow], *, exactly: bool) -> None:
    rows = [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in actual]
    assert rows == [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in expected]
    for name in ("position", "orientation", "length"):
        told = [getattr(arrow, name) for arrow in actual if arrow.position]
        wanted = [getattr(arrow, name) for arrow in expected if arrow.position]
        if exactly and name != "length":
            np.testing.assert_array_equal(told, wanted)
        else:
            # A length is written as shaft and head, which round; anything else is a sum's order,
            # or the way in which rotations are computed.
            np.testing.assert_allclose(told, wanted, rtol=1e-13, atol=1e-12)
    colours = np.array([arrow.colour for arrow in actual if arrow.position])
    wanted_colours = np.array([arrow.colour for arrow in expected if arrow.position], np.float32)
    if exactly:
        np.testing.assert_array_equal(colours.astype(np.float32), wanted_colours)
    else:
        np.testing.assert_allclose(colours, wanted_colours, rtol=2e-7, atol=1e-7)


def assert_same_loads(actual: list[Load], expected: list[Load]) -> None:
    assert [(one.log_time, one.stamp, one.in_contact) for one in actual] == [
        (one.log_time, one.stamp, one.in_contact) for one in expected
    ]
    for name in ("force", "body_weights"):
        told = [getattr(one, name) for one in actual]
        wanted = [getattr(one, name) for one in expected]
        np.testing.assert_allclose(told, wanted, rtol=1e-13, atol=1e-14)


# --- Converting -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Done:
    conversion: Conversion
    path: Path
    written: Written


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("converted")


_DONE: dict[tuple[Path, str], Done] = {}


def converted(folder: Path, log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = folder / f"{len(_DONE)}.mcap"
        conversion = convert(log, target, ConvertOptions(**options))
        _DONE[key] = Done(conversion, target, read_written(target))
    return _DONE[key]


def codes(conversion: Conversion) -> set[str]:
    return {finding.code for finding in conversion.findings}


MATRIX = [
    *((TROUBLED, style, encoding) for style in STYLES for encoding in ENCODINGS),
    (TROT, "pressure", "foxglove"),
    (TROT, "classic", "ros1"),
    (TROT, "force", "foxglove"),
    (WALK, "force", "foxglove"),
]


@pytest.mark.parametrize(
    ("log", "style", "encoding"), MATRIX, ids=[f"{p.stem}-{s}-{e}" for p, s, e in MATRIX]
)
def test_annotations_are_what_message_by_message_conversion_gives(
    folder: Path, log: Path, style: Style, encoding: EncodingName
) -> None:
    done = converted(folder, log, style=style, encoding=encoding)
    assert done.conversion.exit_code == 0
    for foot in FEET:
        arrows = expected_arrows(log, foot, style, in_world=IN_WORLD[log])
        assert_same_arrows(
            written_arrows(done.written, foot, encoding, style),
            arrows,
            exactly=style == "classic",
        )
        assert_same_loads(written_loads(done.written, foot, encoding), expected_loads(log, foot))
        assert done.conversion.annotations[arrow_topic(foot)] == len(arrows)
    # The logs have a /tf of their own; only transforms of its own ROS fit on it.
    joined = encoding == ("ros2" if log == WALK else "ros1")
    topic = "/tf" if joined else "/dogbot_logtool/tf"
    assert written_poses(done.written, topic, encoding) == expected_poses(log, at_ticks=True)
    assert ("N_TOPIC_MOVED" in codes(done.conversion)) != joined


def test_lengths_of_classic_markers_are_exact(folder: Path) -> None:
    done = converted(folder, TROUBLED, style="classic", encoding="ros1")
    for foot in FEET:
        told = [a.length for a in written_arrows(done.written, foot, "ros1", "classic")]
        wanted = [a.length for a in expected_arrows(TROUBLED, foot, "classic", in_world=False)]
        np.testing.assert_array_equal(told, wanted)


@pytest.mark.parametrize("log", LOGS, ids=lambda log: log.stem)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_tf_rate_0_writes_every_pose(folder: Path, log: Path, encoding: EncodingName) -> None:
    done = converted(folder, log, tf_rate_hz=0.0, encoding=encoding, copy=False)
    assert written_poses(done.written, "/tf", encoding) == expected_poses(log, at_ticks=False)


def test_tf_has_fifty_poses_a_second(folder: Path) -> None:
    poses = written_poses(converted(folder, TROT, copy=False).written, "/tf", "foxglove")
    assert len(poses) == 401
    assert {after.stamp - before.stamp for before, after in pairwise(poses)} == {TICK_NS}


def test_counts_of_what_cannot_be_drawn_are_told(folder: Path) -> None:
    damage = json.loads(TROUBLED.with_suffix(".truth.json").read_text(encoding="utf-8"))["damage"]
    not_finite = sum(
        len(numbers)
        for kind in ("nan_force", "infinite_position")
        for numbers in damage[kind].values()
    )
    counts = converted(folder, TROUBLED).conversion.counts
    assert counts.arrows.not_finite == not_finite
    assert counts.bad_poses == len(damage["zero_quaternion"])
    assert codes(converted(folder, TROUBLED).conversion) >= {"W_NOT_FINITE", "W_BAD_POSES"}


def test_zero_stamps_are_replaced_by_log_times_and_said(folder: Path) -> None:
    done = converted(folder, TROUBLED)
    assert "W_ZERO_STAMPS" in codes(done.conversion)
    loads = written_loads(done.written, "back_left", "foxglove")
    assert all(load.stamp == load.log_time for load in loads)


# --- The copy -------------------------------------------------------------------------------------


def recorded_in(written: Written) -> Counter[tuple[object, ...]]:
    return Counter(
        (
            channel.topic,
            written.schemas[channel.schema_id].name,
            written.schemas[channel.schema_id].data.decode("utf-8", "replace"),
            message.log_time,
            message.publish_time,
            message.sequence,
            message.data,
        )
        for message in written.messages
        if (channel := written.channels[message.channel_id]).message_encoding in {"ros1", "cdr"}
    )


def recorded_by(log: Path) -> Counter[tuple[object, ...]]:
    return Counter(
        (
            one.topic,
            one.type_name if log.suffix == ".mcap" else one.type_name.replace("/msg/", "/"),
            one.definition,
            one.log_time,
            one.publish_time,
            one.sequence,
            one.data,
        )
        for one in read_log(log)
    )


COPIES = [(TROUBLED, c) for c in (*COMPRESSIONS, None)] + [
    (WALK, "lz4"),
    (WALK, None),
    (TROT, None),
]


@pytest.mark.parametrize(
    ("log", "compression"), COPIES, ids=[f"{log.stem}-{c}" for log, c in COPIES]
)
def test_recorded_messages_are_copied_byte_for_byte(
    folder: Path, log: Path, compression: Compression | None
) -> None:
    done = converted(folder, log, compression=compression)
    assert recorded_in(done.written) == recorded_by(log)
    assert done.conversion.copied == len(read_log(log))
    name = "" if compression == "none" else (compression or "zstd")
    assert set(done.written.chunk_compressions) == {name}


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_without_copy_there_are_annotations_only(
    folder: Path, compression: Compression, encoding: EncodingName
) -> None:
    done = converted(folder, TROUBLED, copy=False, compression=compression, encoding=encoding)
    topics = {"/tf", "/support", *map(arrow_topic, FEET), *map(load_topic, FEET)}
    assert {channel.topic for channel in done.written.channels.values()} == topics
    encodings = {channel.message_encoding for channel in done.written.channels.values()}
    assert encodings == {of_encoding(encoding)}
    assert done.written.profile == ("" if encoding == "foxglove" else encoding)
    assert done.conversion.copied == 0
    with_copy = converted(folder, TROUBLED, compression=compression, encoding=encoding)
    for topic in topics - {"/tf"}:
        alone = [m.data for _, m in done.written.of(topic, of_encoding(encoding))]
        assert alone == [m.data for _, m in with_copy.written.of(topic, of_encoding(encoding))]


def test_profile_of_the_log_is_kept(folder: Path) -> None:
    assert converted(folder, TROT).written.profile == "ros1"
    assert converted(folder, WALK).written.profile == "ros2"


def chunks_of(path: Path) -> list[records.Chunk]:
    with path.open("rb") as stream:
        return [
            record
            for record in StreamReader(stream, emit_chunks=True).records
            if isinstance(record, records.Chunk)
        ]


def test_chunks_of_an_mcap_are_copied_as_they_stand(folder: Path) -> None:
    recorded = chunks_of(WALK)
    written = chunks_of(converted(folder, WALK).path)
    kept = [chunk for chunk in written if chunk in recorded]
    assert kept == recorded
    annotated = [chunk for chunk in written if chunk not in recorded]
    assert annotated
    done = converted(folder, WALK)
    assert done.written.statistics is not None
    assert done.written.statistics.chunk_count == len(written)
    assert len(done.written.chunk_compressions) == len(written)


def test_output_has_chunks_of_about_a_megabyte(folder: Path) -> None:
    sizes = [chunk.uncompressed_size for chunk in chunks_of(converted(folder, TROT).path)]
    assert max(sizes) < (1 << 20) + 10_000
    assert sum(sizes) / len(sizes) > 1 << 18


def test_start_and_end_choose_messages_by_log_time(folder: Path) -> None:
    first = min(one.log_time for one in read_log(WALK))
    done = converted(folder, WALK, start_s=2.0005, end_s=4.25)
    start, end = first + 2_000_500_000, first + 4_250_000_000
    wanted = Counter(
        (one.topic, one.log_time, one.data)
        for one in read_log(WALK)
        if start <= one.log_time <= end
    )
    copied = Counter(
        (done.written.channels[m.channel_id].topic, m.log_time, m.data)
        for m in done.written.messages
        if done.written.channels[m.channel_id].message_encoding == "cdr"
    )
    assert copied == wanted
    for foot in FEET:
        loads = [one for one in expected_loads(WALK, foot) if start <= one.log_time <= end]
        assert_same_loads(written_loads(done.written, foot, "foxglove"), loads)
    poses = [p for p in expected_poses(WALK, at_ticks=False) if start <= p.log_time <= end]
    told = written_poses(done.written, "/dogbot_logtool/tf", "foxglove")
    assert told[0] == poses[0]
    assert (
        told[1:]
        == [
            pose for pose in expected_poses(WALK, at_ticks=True) if pose.log_time > told[0].log_time
        ][: len(told) - 1]
    )
    assert poses[-1].stamp - told[-1].stamp < TICK_NS


def test_a_time_range_between_two_messages_is_refused(folder: Path) -> None:
    """The range lies inside a chunk, so the chunk is read, but nothing in it is taken."""
    for log in (TROUBLED, WALK):
        times = sorted({one.log_time for one in read_log(log)})
        place = next(n for n in range(100, len(times)) if times[n + 1] - times[n] > 10_000)
        start, end = times[place] - times[0] + 2_000, times[place + 1] - times[0] - 2_000
        with pytest.raises(CallError, match="no message was recorded from"):
            converted(folder, log, start_s=start / S, end_s=end / S)


# --- Logs made here -------------------------------------------------------------------------------


def typestore(stores: Stores) -> Typestore:
    store = get_typestore(stores)
    vectors = "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\n"
    state = (
        "string info\nstring collision1_name\nstring collision2_name\n"
        "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
        f"{vectors}float64[] depths\n"
    )
    store.register(get_types_from_msg(state, "gazebo_msgs/msg/ContactState"))
    contacts = "std_msgs/Header header\ngazebo_msgs/ContactState[] states\n"
    store.register(get_types_from_msg(contacts, CONTACTS_TYPE))
    if TF_TYPE not in store.fielddefs:
        definition = "geometry_msgs/TransformStamped[] transforms\n"
        store.register(get_types_from_msg(definition, TF_TYPE))
    return store


NOETIC = typestore(Stores.ROS1_NOETIC)
HUMBLE = typestore(Stores.ROS2_HUMBLE)


def make(name: str, *args: Any, **fields: Any) -> Any:
    return NOETIC.types[name](*args, **fields)


def vector(x: float, y: float, z: float) -> Any:
    return make("geometry_msgs/msg/Vector3", x, y, z)


def header(time: int, frame: str = "world") -> Any:
    stamp = make("builtin_interfaces/msg/Time", time // S, time % S)
    return make("std_msgs/msg/Header", 0, stamp, frame)


def odometry(time: int, position: tuple[float, float, float] = (0.0, 0.0, 0.5)) -> bytes:
    covariance = np.zeros(36)
    turn = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    pose = make("geometry_msgs/msg/Pose", make("geometry_msgs/msg/Point", *position), turn)
    twist = make("geometry_msgs/msg/Twist", vector(0, 0, 0), vector(0, 0, 0))
    message = make(
        ODOMETRY_TYPE,
        header=header(time),
        child_frame_id="base_link",
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose, covariance),
        twist=make("geometry_msgs/msg/TwistWithCovariance", twist, covariance),
    )
    return bytes(NOETIC.serialize_ros1(message, ODOMETRY_TYPE))


def contact(
    force: tuple[float, float, float],
    foot: str = "front_left",
    points: tuple[tuple[float, float, float], ...] = ((1.0, 2.0, 0.0),),
    info: str = "Debug:  i:(0/1)     my geom:a   other geom:b         time:1.000000000\n",
) -> Any:
    wrench = make("geometry_msgs/msg/Wrench", vector(*force), vector(0, 0, 0))
    return make(
        "gazebo_msgs/msg/ContactState",
        info=info,
        collision1_name=f"dogbot::{foot}_lowerleg::{foot}_foot_collision",
        collision2_name="ground_plane::link::collision",
        wrenches=[wrench] * len(points),
        total_wrench=wrench,
        contact_positions=[vector(*point) for point in points],
        contact_normals=[vector(0, 0, 1)] * len(points),
        depths=np.zeros(len(points)),
    )


def contacts(time: int, *states: Any) -> bytes:
    message = make(CONTACTS_TYPE, header=header(time), states=list(states))
    return bytes(NOETIC.serialize_ros1(message, CONTACTS_TYPE))


def transform(time: int, parent: str, child: str) -> bytes:
    turn = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    one = make(
        "geometry_msgs/msg/TransformStamped",
        header=header(time, parent),
        child_frame_id=child,
        transform=make("geometry_msgs/msg/Transform", vector(0, 0, 0), turn),
    )
    return bytes(NOETIC.serialize_ros1(make(TF_TYPE, transforms=[one]), TF_TYPE))


def text(content: str) -> bytes:
    return bytes(NOETIC.serialize_ros1(make(TEXT_TYPE, content), TEXT_TYPE))


@dataclass(frozen=True, slots=True)
class Entry:
    topic: str
    type_name: str
    log_time: int
    data: bytes


def write_bag(
    path: Path, entries: Iterable[Entry], *, chunk_size: int = 1 << 19, compressed: bool = False
) -> Path:
    writer = BagWriter(path)
    writer.chunk_threshold = chunk_size
    if compressed:
        writer.set_compression(BagWriter.CompressionFormat.LZ4)
    with writer:
        connections: dict[str, Any] = {}
        for entry in entries:
            if entry.topic not in connections:
                connections[entry.topic] = writer.add_connection(
                    entry.topic, entry.type_name, typestore=NOETIC
                )
            writer.write(connections[entry.topic], entry.log_time, entry.data)
    return path


def write_ros1_mcap(
    path: Path,
    entries: Iterable[Entry],
    *,
    extras: bool = False,
    compression: CompressionType = CompressionType.LZ4,
    chunk_size: int = 1 << 18,
) -> Path:
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size, compression)
        writer.start(profile="ros1", library="the tests")
        if extras:
            writer.add_metadata("weather", {"sky": "grey", "wind": "none"})
        channels: dict[str, int] = {}
        for entry in entries:
            if entry.topic not in channels:
                definition, _ = NOETIC.generate_msgdef(entry.type_name)
                name = entry.type_name.replace("/msg/", "/")
                schema = writer.register_schema(name, "ros1msg", definition.encode())
                channels[entry.topic] = writer.register_channel(
                    entry.topic, "ros1", schema, {"callerid": "/tests"}
                )
            writer.add_message(
                channels[entry.topic], entry.log_time, entry.data, entry.log_time - 7, 3
            )
        if extras:
            writer.add_attachment(5, 6, "map.txt", "text/plain", b"here be dragons" * 100)
            writer.add_attachment(7, 8, "empty", "application/octet-stream", b"")
            writer.add_metadata("nothing", {})
        writer.finish()
    return path


def small_walk(seconds: float = 1.0) -> Iterator[Entry]:
    """Yield odometry at 250 Hz, and a front left foot that presses harder and harder."""
    for index in range(round(seconds * 250)):
        time = 10 * S + index * 4_000_000
        yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time, (index / 250, 0.0, 0.5)))
        states = [] if index % 50 < 10 else [contact((0.0, 3.0, 1.0 + index))]
        yield Entry(
            contact_topic("front_left"), CONTACTS_TYPE, time + 1000, contacts(time, *states)
        )


BOUNDS_NM = (380, 440, 490, 510, 580, 645, 750)


def odd_forces() -> Iterator[tuple[float, float, float]]:
    """Yield forces on and beside every bound of the colours, and those that are no numbers."""
    for bound in BOUNDS_NM:
        p = (bound - 380) / 370 * 2.0 * 100.0
        for force in (math.nextafter(p, 0.0), p, math.nextafter(p, math.inf)):
            yield 0.0, 0.0, force
    yield 0.0, 0.0, 200.0000001
    yield 0.0, -0.0, 0.0
    for odd in (math.nan, math.inf, -math.inf):
        yield odd, 1.0, 2.0
        yield 1.0, odd, math.nan
    yield 1e200, 1.0, 1.0
    yield 1e154, 1e154, 1e154
    yield 1e-200, 0.0, 0.0
    rng = np.random.default_rng(3)
    yield from rng.normal(0, 90, (400, 3)).tolist()


def odd_contacts() -> Iterator[Entry]:
    topic = contact_topic("front_left")
    time = 10 * S
    for force in odd_forces():
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, contact(force)))
    for states in ((), (contact((1.0, 2.0, 3.0), points=()),)):
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, *states))


@pytest.mark.parametrize("style", STYLES)
def test_forces_of_all_kinds(tmp_path: Path, style: Style) -> None:
    log = write_bag(tmp_path / "odd.bag", odd_contacts())
    options = ConvertOptions(
        style=style, encoding="ros1", wrench_frame="world", topics=TopicOptions(robot="dogbot")
    )
    conversion = convert(log, tmp_path / "out.mcap", options)
    written = read_written(tmp_path / "out.mcap")
    expected = expected_arrows(log, "front_left", style, in_world=True)
    told = written_arrows(written, "front_left", "ros1", style)
    assert_same_arrows(told, expected, exactly=style == "classic")
    if style == "classic":
        np.testing.assert_array_equal([a.length for a in told], [a.length for a in expected])
        counts = conversion.counts.arrows
        assert (counts.overflow, counts.no_position, counts.not_finite) == (1, 1, 0)
        assert "W_OVERFLOW" in codes(conversion)
    else:
        assert conversion.counts.arrows.no_position == 1
        assert conversion.counts.arrows.not_finite == 8


def test_mcap_extras_are_copied(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(), extras=True)
    convert(log, tmp_path / "out.mcap", ConvertOptions())
    recorded, written = read_written(log), read_written(tmp_path / "out.mcap")
    assert written.attachments == recorded.attachments
    assert len(written.attachments) == 2
    assert written.metadata[:-1] == recorded.metadata
    assert written.metadata[-1].name == "dogbot_logtool"
    with (tmp_path / "out.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert list(reader.iter_attachments()) == recorded.attachments
        assert list(reader.iter_metadata()) == written.metadata
    channels = [c for c in written.channels.values() if c.message_encoding == "ros1"]
    assert [c.metadata for c in channels] == [{"callerid": "/tests"}] * 2
    assert {m.sequence for m in written.messages} == {0, 3}


@pytest.mark.parametrize("compression", ["none", "zstd"])
def test_a_chunk_without_messages(tmp_path: Path, compression: Compression) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.2), compression=CompressionType.NONE)
    empty = records.Chunk(
        compression="",
        data=b"",
        message_end_time=0,
        message_start_time=0,
        uncompressed_crc=0,
        uncompressed_size=0,
    )
    builder = RecordBuilder()
    pieces = [b"\x89MCAP0\r\n"]
    with log.open("rb") as stream:
        for record in StreamReader(stream, emit_chunks=True).records:
            if isinstance(record, records.DataEnd):
                break
            if isinstance(record, records.Chunk):
                empty.write(builder)
            record.write(builder)
            pieces.append(builder.end())
    empty.write(builder)
    records.DataEnd(0).write(builder)
    records.Footer(0, 0, 0).write(builder)
    log.write_bytes(b"".join([*pieces, builder.end(), b"\x89MCAP0\r\n"]))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(compression=compression))
    assert (conversion.exit_code, conversion.copied) == (0, 100)
    assert len(read_written(tmp_path / "out.mcap").messages) == 100 + 120


def test_extras_are_not_copied_without_copy(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(), extras=True)
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    written = read_written(tmp_path / "out.mcap")
    assert written.attachments == []
    assert [metadata.name for metadata in written.metadata] == ["dogbot_logtool"]


def test_metadata_that_is_no_text_is_copied_byte_for_byte(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert b"weather" in data
    log.write_bytes(data.replace(b"weather", b"w\xffather"))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert not [loss for loss in conversion.losses if "metadata" in loss.what]
    assert b"w\xffather" in (tmp_path / "out.mcap").read_bytes()


def test_a_damaged_attachment_is_left_out_and_told(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert data.count(b"here be dragons") == 100
    log.write_bytes(data.replace(b"here be dragons", b"here be unicorn", 1))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    written = read_written(tmp_path / "out.mcap")
    assert [attachment.name for attachment in written.attachments] == ["empty"]
    assert conversion.exit_code == 3
    with pytest.raises(LogError, match="--strict"):
        convert(log, tmp_path / "strict.mcap", ConvertOptions(strict=True))
    assert not (tmp_path / "strict.mcap").exists()


# --- Topic clashes --------------------------------------------------------------------------------


def test_own_tf_joins_the_log_s_where_type_and_encoding_are_the_same(folder: Path) -> None:
    done = converted(folder, TROT, encoding="ros1")
    assert done.written.encodings("/tf") == {"ros1"}
    recorded = [one.data for one in read_log(TROT) if one.topic == "/tf"]
    joined = done.written.of("/tf", "ros1")
    assert len(joined) == len(recorded) + 401
    assert {schema.name for schema, _ in joined} == {"tf2_msgs/TFMessage"}
    assert done.conversion.annotations["/tf"] == 401


def test_every_topic_has_one_type_and_encoding(folder: Path) -> None:
    for log in LOGS:
        for encoding in ENCODINGS:
            options: dict[str, Any] = {"style": "force"} if log == WALK else {}
            done = converted(folder, log, encoding=encoding, **options)
            kinds: dict[str, set[tuple[str, str]]] = defaultdict(set)
            for channel in done.written.channels.values():
                name = done.written.schemas[channel.schema_id].name
                kinds[channel.topic].add((name, channel.message_encoding))
            assert [topic for topic, found in kinds.items() if len(found) > 1] == []


def test_a_topic_that_is_taken_twice_is_moved_twice(tmp_path: Path) -> None:
    taken = (load_topic("front_left"), f"/dogbot_logtool{load_topic('front_left')}")
    entries = [Entry(topic, TEXT_TYPE, 10 * S, text("mine")) for topic in taken]
    log = write_bag(tmp_path / "log.bag", [*entries, *small_walk(0.2)])
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    topic = "/dogbot_logtool/dogbot_logtool/load/front_left"
    assert conversion.annotations[topic] == 50
    written = read_written(tmp_path / "out.mcap")
    assert {load.in_contact for load in _loads_at(written, topic)} == {True, False}
    (moved,) = [finding for finding in conversion.findings if finding.code == "N_TOPIC_MOVED"]
    assert moved.where == topic
    assert "/load/front_left" in moved.text


def _loads_at(written: Written, topic: str) -> list[Any]:
    return [
        written.decode(schema, message, "protobuf")
        for schema, message in written.of(topic, "protobuf")
    ]


# --- A second parent ------------------------------------------------------------------------------


def walk_with_late_parent(path: Path) -> Path:
    """Write 60 chunks, of which one in the middle says where the base is."""

    def entries() -> Iterator[Entry]:
        for index in range(60):
            time = 10 * S + index * 100_000_000
            yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time))
            state = contact((0.0, 0.0, 50.0))
            yield Entry(contact_topic("front_left"), CONTACTS_TYPE, time + 1, contacts(time, state))
            child = "base_link" if index == 21 else "camera"
            parent = "/map" if index == 21 else "base_link"
            yield Entry("/tf", TF_TYPE, time + 2, transform(time, parent, child))
            yield Entry("/filler", TEXT_TYPE, time + 3, text("-" * 300_000))

    return write_bag(path, entries(), chunk_size=250_000, compressed=True)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_second_parent_that_comes_late_is_noticed(tmp_path: Path, jobs: int) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    target = tmp_path / "out.mcap"
    conversion = convert(log, target, ConvertOptions(jobs=jobs))
    written = read_written(target)
    assert not [topic for topic in conversion.annotations if topic.endswith("/tf")]
    assert {c.message_encoding for c in written.channels.values() if c.topic.endswith("/tf")} == {
        "ros1"
    }
    assert "W_TF_HAS_PARENT" in codes(conversion)
    (finding,) = [f for f in conversion.findings if f.code == "W_TF_HAS_PARENT"]
    assert "base_link in map" in finding.text
    assert conversion.annotations[arrow_topic("front_left")] == 60
    assert conversion.copied == 240
    assert sorted(file.name for file in tmp_path.iterdir()) == ["log.bag", "out.mcap"]


def test_the_first_attempt_s_workers_are_gone_when_the_second_works(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    workers: set[str] = set()

    def look(_done: int, _total: int) -> None:
        threads = (each.name for each in threading.enumerate() if each.name.startswith("batch"))
        now = {*threads, *(each.name for each in multiprocessing.active_children())}
        assert len(now) <= 2
        workers.update(now)

    convert(log, tmp_path / "out.mcap", ConvertOptions(jobs=2), look)
    assert workers


def test_tf_always_writes_a_second_parent(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(tf="always"))
    assert conversion.annotations["/dogbot_logtool/tf"] == 60
    assert "W_TF_HAS_PARENT" not in codes(conversion)


def test_a_parent_that_is_not_copied_is_no_second_one(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    assert conversion.annotations.get("/tf") == 60


def test_tf_never_writes_none(folder: Path) -> None:
    done = converted(folder, TROUBLED, tf="never", copy=False)
    assert "/tf" not in done.conversion.annotations


# --- What is missing, what is broken --------------------------------------------------------------


def test_feet_only(tmp_path: Path) -> None:
    entries = [entry for entry in small_walk() if entry.topic != ODOMETRY]
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert "W_NO_ODOMETRY" in codes(conversion)
    assert conversion.annotations[arrow_topic("front_left")] == 250
    assert "/tf" not in conversion.annotations
    missing = {f.where for f in conversion.findings if f.code == "W_FOOT_MISSING"}
    assert missing == {contact_topic(foot) for foot in FEET[1:]}


@pytest.mark.parametrize("tf", ["auto", "never"])
def test_odometry_only(tmp_path: Path, tf: Literal["auto", "never"]) -> None:
    entries = [entry for entry in small_walk() if entry.topic == ODOMETRY]
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(tf=tf))
    assert "W_NO_FEET" in codes(conversion)
    assert conversion.annotations == ({"/tf": 50} if tf == "auto" else {})
    assert len(read_written(tmp_path / "out.mcap").messages) == (300 if tf == "auto" else 250)


def test_neither_is_an_error_that_lists_what_is_there(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", [Entry("/said", TEXT_TYPE, S, text("hello"))])
    with pytest.raises(LogError, match=r"/said\s+std_msgs/String"):
        convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert not (tmp_path / "out.mcap").exists()


def test_an_empty_log_is_an_error(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", [])
    with pytest.raises(LogError, match="nothing"):
        convert(log, tmp_path / "out.mcap", ConvertOptions())


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_a_malformed_message_costs_one_message(tmp_path: Path, kind: str) -> None:
    entries = list(small_walk())
    broken = next(i for i, e in enumerate(entries) if i > 200 and e.type_name == CONTACTS_TYPE)
    entries[broken] = replace(entries[broken], data=entries[broken].data[:-3])
    write = write_bag if kind == "bag" else write_ros1_mcap
    log = write(tmp_path / f"log.{kind}", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    written = read_written(tmp_path / "out.mcap")
    assert conversion.exit_code == 3
    assert conversion.copied == len(entries)
    assert conversion.annotations[load_topic("front_left")] == 249
    loads = written_loads(written, "front_left", "foxglove")
    assert entries[broken].log_time not in {load.log_time for load in loads}
    (loss,) = conversion.losses
    assert contact_topic("front_left") in loss.what
    assert loss.messages == 1
    provenance = written.metadata[-1].metadata
    assert provenance["lost_messages"] == "1"
    assert contact_topic("front_left") in provenance["damage"]
    with pytest.raises(LogError, match="--strict"):
        convert(log, tmp_path / "strict.mcap", ConvertOptions(strict=True))
    assert not (tmp_path / "strict.mcap").exists()


def test_transforms_that_cannot_be_decoded_are_told(tmp_path: Path) -> None:
    """They might have given the base a parent."""
    sent = [10 * S + index * 20_000_000 for index in range(50)]
    frames = [Entry("/tf", TF_TYPE, time, transform(time, "base_link", "leg")) for time in sent]
    frames[30] = replace(frames[30], data=frames[30].data[:-1])
    entries = sorted([*small_walk(), *frames], key=lambda entry: entry.log_time)
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert conversion.copied == len(entries)
    (loss,) = conversion.losses
    assert loss.messages == 1
    assert "/tf" in loss.what
    unused = convert(log, tmp_path / "never.mcap", ConvertOptions(tf="never"))
    assert not unused.losses


def test_a_chunk_whose_checksum_fails_is_left_out(tmp_path: Path) -> None:
    log = write_ros1_mcap(
        tmp_path / "log.mcap", small_walk(), compression=CompressionType.NONE, chunk_size=40_000
    )
    count = len(chunks_of(log))
    data = bytearray(log.read_bytes())
    place = data.index(b"ground_plane", len(data) // 2)
    data[place] ^= 1
    log.write_bytes(data)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(compression="none"))
    assert conversion.exit_code == 3
    (loss,) = conversion.losses
    assert loss.messages
    assert conversion.copied == 500 - loss.messages
    assert "checksum" in loss.what
    written = read_written(tmp_path / "out.mcap")
    assert len(written.messages) == conversion.copied + sum(conversion.annotations.values())
    kept = [c for c in chunks_of(tmp_path / "out.mcap") if c in chunks_of(log)]
    assert len(kept) == count - 1


# --- Sameness -------------------------------------------------------------------------------------


def test_the_same_bytes_whatever_the_jobs(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", _padded_walk(), chunk_size=200_000, compressed=True)
    outputs: set[bytes] = set()
    for number, jobs in enumerate((1, 2, 3, 1)):
        target = tmp_path / f"{number}.mcap"
        convert(log, target, ConvertOptions(jobs=jobs))
        outputs.add(target.read_bytes())
    assert len(outputs) == 1
    written = read_written(tmp_path / "0.mcap")
    assert written_poses(written, "/tf", "foxglove") == expected_poses(log, at_ticks=True)
    expected = expected_arrows(log, "front_left", "pressure", in_world=False)
    assert_same_arrows(
        written_arrows(written, "front_left", "foxglove", "pressure"), expected, exactly=False
    )


def _padded_walk() -> Iterator[Entry]:
    """Yield a walk that fills several batches."""
    for index, entry in enumerate(small_walk(1.5)):
        yield entry
        if index % 10 == 0:
            yield Entry("/filler", TEXT_TYPE, entry.log_time, text("+" * 250_000))


@pytest.mark.parametrize("log", LOGS, ids=lambda log: log.stem)
def test_sample_logs_convert_to_the_same_bytes_whatever_the_jobs(
    folder: Path, tmp_path: Path, log: Path
) -> None:
    options: dict[str, Any] = {"style": "force"} if log == WALK else {}
    target = tmp_path / "out.mcap"
    convert(log, target, ConvertOptions(jobs=3, encoding="foxglove", **options))
    assert (
        target.read_bytes()
        == converted(folder, log, encoding="foxglove", **options).path.read_bytes()
    )


def test_provenance_tells_how_but_not_when_or_where(folder: Path) -> None:
    done = converted(folder, TROUBLED, style="classic", encoding="ros1")
    (provenance,) = done.written.metadata
    assert provenance.name == "dogbot_logtool"
    told = provenance.metadata
    assert told["input"] == "dogbot_troubled.bag"
    assert (told["style"], told["encoding"], told["robot"]) == ("classic", "ros1", "dogbot")
    assert (told["mass_kg"], told["copy"], told["lost_messages"]) == ("21.261", "True", "0")
    assert not [value for value in told.values() if "/" in value and value.startswith("/")]
    everything = json.dumps(told)
    assert str(TROUBLED.parent) not in everything
    assert str(folder) not in everything
    assert not re.search(r"20\d\d-\d\d|\d\d:\d\d", everything)


def test_the_place_of_the_log_leaves_no_trace(folder: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    copy = elsewhere / TROUBLED.name
    copy.write_bytes(TROUBLED.read_bytes())
    convert(copy, tmp_path / "out.mcap", ConvertOptions())
    assert (tmp_path / "out.mcap").read_bytes() == converted(folder, TROUBLED).path.read_bytes()


def test_the_same_walk_in_two_containers_has_the_same_annotations(
    folder: Path, tmp_path: Path
) -> None:
    entries = [Entry(one.topic, one.type_name, one.log_time, one.data) for one in read_log(TROT)]
    log = write_ros1_mcap(tmp_path / "trot.mcap", entries)
    for encoding in ENCODINGS:
        convert(log, tmp_path / f"{encoding}.mcap", ConvertOptions(encoding=encoding))
        other = read_written(tmp_path / f"{encoding}.mcap")
        bag = converted(folder, TROT, encoding=encoding).written
        for topic in ("/tf", "/dogbot_logtool/tf", *map(arrow_topic, FEET), *map(load_topic, FEET)):
            here, there = (w.of(topic, of_encoding(encoding)) for w in (other, bag))
            assert [(m.log_time, m.data) for _, m in here] == [
                (m.log_time, m.data) for _, m in there
            ]


def test_the_same_walk_of_ros1_and_ros2_has_the_same_annotations(
    folder: Path, tmp_path: Path
) -> None:
    kinds = {ODOMETRY: ODOMETRY_TYPE} | {contact_topic(foot): CONTACTS_TYPE for foot in FEET}
    entries = [
        Entry(
            one.topic,
            one.type_name,
            one.log_time,
            bytes(HUMBLE.cdr_to_ros1(one.data, one.type_name)),
        )
        for one in read_log(WALK)
        if one.topic in kinds
    ]
    log = write_bag(tmp_path / "walk.bag", entries)
    convert(log, tmp_path / "out.mcap", ConvertOptions(style="force"))
    ros1 = read_written(tmp_path / "out.mcap")
    ros2 = converted(folder, WALK, style="force", encoding="foxglove").written
    for topic in (*map(arrow_topic, FEET), *map(load_topic, FEET)):
        assert [m.data for _, m in ros1.of(topic, "protobuf")] == [
            m.data for _, m in ros2.of(topic, "protobuf")
        ]
    assert written_poses(ros1, "/tf", "foxglove") == written_poses(
        ros2, "/dogbot_logtool/tf", "foxglove"
    )


# --- Targets --------------------------------------------------------------------------------------


def test_progress_ends_at_the_whole(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    convert(
        TROUBLED,
        tmp_path / "out.mcap",
        ConvertOptions(copy=False),
        lambda done, total: told.append((done, total)),
    )
    assert told[-1][0] == told[-1][1]
    assert told == sorted(told)


# --- An outside checker ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_the_doctor_finds_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    """`pymcap-cli doctor` over all encodings, compressions and copy modes."""
    if kind == "bag":
        log = write_bag(tmp_path / "log.bag", small_walk(0.3))
    else:
        log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.3), extras=True)
    target = tmp_path / "out.mcap"
    for encoding in ENCODINGS:
        for compression in (*COMPRESSIONS, None):
            for copy in (True, False):
                options = ConvertOptions(
                    encoding=encoding, compression=compression, copy=copy, overwrite=True
                )
                convert(log, target, options)
                code = pymcap_cli(["doctor", str(target)], result_action="return_value")
                told = capsys.readouterr()
                assert code == 0, told.out + told.err
                assert "passed MCAP doctor checks" in " ".join(told.out.split())
                assert "warning" not in told.out


def test_nothing_but_the_output_is_left(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(jobs=2))
    assert [file.name for file in tmp_path.iterdir()] == ["out.mcap"]
