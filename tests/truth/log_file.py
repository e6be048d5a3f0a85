"""A recording as a log file, written by the official libraries."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter

from tests.truth.messages import (
    CONTACTS,
    GZ_CONTACTS,
    IMU,
    ODOMETRY,
    TF,
    TWIST,
    TWIST_STAMPED,
    WRENCH,
    Messages,
)
from tests.truth.recording import Recording, VectorRecording

BASE: Final = "base_link"
WORLD: Final = "odom"
TF_RATE_HZ: Final = 50.0

Entry = tuple[int, str, str, bytes]
"""Log time, topic, type, payload."""


def write_log(recording: Recording, path: Path) -> Path:
    """Write a ``.mcap`` (ROS 2) or a ``.bag`` (ROS 1)."""
    messages = _messages(1 if path.suffix == ".bag" else 2)
    entries = sorted(_entries(recording, messages), key=lambda entry: entry[0])
    (_write_bag if path.suffix == ".bag" else _write_mcap)(path, messages, entries)
    return path


@cache
def _messages(ros: int) -> Messages:
    return Messages(ros)


def link_name(foot: str) -> str:
    """Name the frame that a foot's sensor is in."""
    return f"{foot}_link"


def _entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    yield from _base_entries(recording, messages)
    for foot in range(len(recording.feet)):
        yield from _SENSORS[recording.kind](recording, messages, foot)
    if recording.has_tf:
        yield from _transform_entries(recording, messages)
    if recording.statics:
        yield from _static_entries(recording, messages)
    for topic in recording.beside:
        yield from _vector_entries(topic, messages)


def _base_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    base, topic = recording.base, recording.robot.odometry_topic
    template = messages.odometry(WORLD, BASE)
    numbers = np.concatenate([base.position, base.orientation, base.velocity], axis=1).tolist()
    for row, log_time in enumerate(base.log_time.tolist()):
        yield log_time, topic, ODOMETRY, template.filled(int(base.stamp[row]), numbers[row])


def _force_entries(recording: Recording, messages: Messages, foot: int) -> Iterator[Entry]:
    sensor, topic = recording.feet[foot], recording.robot.topic(foot)
    template = messages.wrench_stamped(link_name(recording.robot.feet[foot]))
    force = sensor.force.tolist()
    for row, log_time in enumerate(sensor.log_time.tolist()):
        yield log_time, topic, WRENCH, template.filled(int(sensor.stamp[row]), force[row])


def _bumper_entries(recording: Recording, messages: Messages, foot: int) -> Iterator[Entry]:
    sensor, robot = recording.feet[foot], recording.robot
    link = link_name(robot.feet[foot])
    empty = messages.no_contact(link)
    contact = messages.contact(link, f"{robot.name}::{link}::{robot.feet[foot]}_collision")
    own = messages.contact(
        link,
        f"{robot.name}::{link}::{robot.feet[foot]}_collision",
        f"{robot.name}::{BASE}::{BASE}_collision",
    )
    numbers = np.concatenate(
        [sensor.force, sensor.force, sensor.point, sensor.normal], axis=1
    ).tolist()
    own_contact = (*(0.0, 0.0, 30.0) * 2, *(0.0, 0.0, 0.3), *(0.0, 0.0, 1.0))
    for row, log_time in enumerate(sensor.log_time.tolist()):
        stamp = int(sensor.stamp[row])
        if sensor.touching[row]:
            data = contact.filled(stamp, numbers[row])
        elif recording.touches_itself:
            data = own.filled(stamp, own_contact)
        else:
            data = empty.filled(stamp, ())
        yield log_time, robot.topic(foot), CONTACTS, data


def _gz_entries(recording: Recording, messages: Messages, foot: int) -> Iterator[Entry]:
    """Report contacts only; the force on the ground is the force on the foot turned round."""
    sensor, robot = recording.feet[foot], recording.robot
    sensor = sensor.pick(sensor.touching)
    link = link_name(robot.feet[foot])
    contact = messages.gz_contact(link, f"{robot.name}::{link}::{robot.feet[foot]}_collision")
    numbers = np.concatenate(
        [sensor.force, -sensor.force, sensor.point, sensor.normal], axis=1
    ).tolist()
    for row, log_time in enumerate(sensor.log_time.tolist()):
        data = contact.filled(int(sensor.stamp[row]), numbers[row])
        yield log_time, robot.topic(foot), GZ_CONTACTS, data


def _static_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    template = messages.transforms(BASE, [name for name, _ in recording.statics])
    numbers = [number for _, pose in recording.statics for number in pose]
    first = recording.base
    data = template.filled(int(first.stamp[0]), numbers)
    yield int(first.log_time[0]), "/tf_static", TF, data


def _vector_entries(topic: VectorRecording, messages: Messages) -> Iterator[Entry]:
    name, template = {
        "twist": (TWIST, messages.twist()),
        "twist_stamped": (TWIST_STAMPED, messages.twist_stamped(topic.frame)),
        "imu": (IMU, messages.imu(topic.frame)),
    }[topic.kind]
    numbers = topic.vector.tolist()
    for row, log_time in enumerate(topic.log_time.tolist()):
        yield log_time, topic.topic, name, template.filled(int(topic.stamp[row]), numbers[row])


_SENSORS: Final = {
    "contacts": _bumper_entries,
    "gz_contacts": _gz_entries,
    "wrench": _force_entries,
}


def _transform_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    """Send all links in one message, fifty times a second, by the first foot's clock."""
    first, robot = recording.feet[0], recording.robot
    ticks = np.searchsorted(first.time, np.arange(0.0, first.time[-1], 1.0 / TF_RATE_HZ))
    ticks = np.append(ticks, len(first.time) - 1)
    template = messages.transforms(BASE, [link_name(name) for name in robot.feet])
    hips = [(x, y, -0.5 * robot.height_m) for x, y in robot.corners_m]
    for row in np.unique(ticks).tolist():
        numbers: list[float] = []
        for foot, hip in zip(recording.feet, hips, strict=True):
            at = min(int(np.searchsorted(foot.time, first.time[row])), len(foot.time) - 1)
            numbers += [*hip, *foot.link[at].tolist()]
        data = template.filled(int(first.stamp[row]), numbers)
        yield int(first.log_time[row]), "/tf", TF, data


def _write_mcap(path: Path, messages: Messages, entries: list[Entry]) -> None:
    with path.open("wb") as stream:
        writer = McapWriter(stream, compression=CompressionType.NONE)
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        for log_time, topic, kind, data in entries:
            if topic not in channels:
                definition = messages.definition(kind).encode()
                schema = writer.register_schema(kind, "ros2msg", definition)
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channels[topic], log_time, data, log_time)
        writer.finish()


def _write_bag(path: Path, messages: Messages, entries: list[Entry]) -> None:
    with BagWriter(path) as writer:
        connections: dict[str, Any] = {}
        for log_time, topic, kind, data in entries:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=messages.store)
            writer.write(connections[topic], log_time, data)
