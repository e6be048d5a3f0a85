"""A recording as a log file."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from tests.oracles.mcap_file import Entry, write_mcap
from tests.truth.messages import (
    CONTACTS,
    FLAGS,
    GZ_CONTACTS,
    IMU,
    ODOMETRY,
    SPOT,
    TF,
    TWIST,
    TWIST_STAMPED,
    WRENCH,
    Messages,
    ros_messages,
)
from tests.truth.recording import Ints, Recording, Sensor, VectorRecording

BASE: Final = "base_link"
WORLD: Final = "odom"
TF_RATE_HZ: Final = 50.0


def write_log(recording: Recording, path: Path) -> Path:
    """Write an MCAP of ROS 2 messages."""
    messages = ros_messages()
    entries = sorted(_entries(recording, messages), key=lambda entry: entry.log_time)
    return write_mcap(path, entries, messages.definition)


def _entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    yield from _base_entries(recording, messages)
    if recording.kind in {"spot", "flags"}:
        yield from _state_entries(recording, messages)
    else:
        for foot in range(len(recording.feet)):
            for sensor in recording.sensors_of(foot):
                yield from _SENSORS[recording.kind_of(foot)](recording, messages, sensor)
    if recording.has_tf:
        yield from _transform_entries(recording, messages)
    if recording.statics:
        yield from _static_entries(recording, messages)
    for topic in recording.beside:
        yield from _vector_entries(topic, messages)


def _base_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    base, topic = recording.base, recording.odometry or recording.robot.odometry_topic
    template = messages.odometry(WORLD, recording.child_frame)
    numbers = np.concatenate([base.position, base.orientation, base.velocity], axis=1)
    data = template.all_filled(base.stamp, numbers)
    yield from _rows(base.log_time, topic, ODOMETRY, data)


def _rows(log_time: Ints, topic: str, kind: str, data: Sequence[bytes]) -> Iterator[Entry]:
    for time, each in zip(log_time.tolist(), data, strict=True):
        yield Entry(topic, kind, time, each)


def _force_entries(_: Recording, messages: Messages, of: Sensor) -> Iterator[Entry]:
    data = messages.wrench_stamped(of.frame).all_filled(of.columns.stamp, of.columns.force)
    yield from _rows(of.columns.log_time, of.topic, WRENCH, data)


def _bumper_entries(recording: Recording, messages: Messages, of: Sensor) -> Iterator[Entry]:
    sensor, robot, link = of.columns, recording.robot, of.frame
    name = f"{robot.name}::{link}::{link.removesuffix('_link')}_collision"
    contact = messages.contact(link, name)
    numbers = np.concatenate([sensor.force, sensor.force, sensor.point, sensor.normal], axis=1)
    data = contact.all_filled(sensor.stamp, numbers)
    swing = np.flatnonzero(~sensor.touching)
    if recording.touches_itself:
        own = messages.contact(link, name, f"{robot.name}::{BASE}::{BASE}_collision")
        of_own = np.tile([*(0.0, 0.0, 30.0) * 2, 0.0, 0.0, 0.3, 0.0, 0.0, 1.0], (len(swing), 1))
        others = own.all_filled(sensor.stamp[swing], of_own)
    else:
        nothing = np.empty((len(swing), 0))
        others = messages.no_contact(link).all_filled(sensor.stamp[swing], nothing)
    for row, each in zip(swing.tolist(), others, strict=True):
        data[row] = each
    yield from _rows(sensor.log_time, of.topic, CONTACTS, data)


def _gz_entries(recording: Recording, messages: Messages, of: Sensor) -> Iterator[Entry]:
    """Report contacts only; the force on the ground is the force on the foot turned round."""
    sensor, link = of.columns.pick(of.columns.touching), of.frame
    collision = f"{link.removesuffix('_link')}_collision"
    contact = messages.gz_contact(link, f"{recording.robot.name}::{link}::{collision}")
    numbers = np.concatenate([sensor.force, -sensor.force, sensor.point, sensor.normal], axis=1)
    data = contact.all_filled(sensor.stamp, numbers)
    yield from _rows(sensor.log_time, of.topic, GZ_CONTACTS, data)


def _static_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    template = messages.transforms(BASE, [name for name, _ in recording.statics])
    numbers = [number for _, pose in recording.statics for number in pose]
    first = recording.base
    data = template.filled(int(first.stamp[0]), numbers)
    yield Entry("/tf_static", TF, int(first.log_time[0]), data)


def _vector_entries(topic: VectorRecording, messages: Messages) -> Iterator[Entry]:
    name, template = {
        "twist": (TWIST, messages.twist()),
        "twist_stamped": (TWIST_STAMPED, messages.twist_stamped(topic.frame)),
        "imu": (IMU, messages.imu(topic.frame, turns=topic.vector.shape[1] > 3)),
    }[topic.kind]
    data = template.all_filled(topic.stamp, topic.vector)
    yield from _rows(topic.log_time, topic.topic, name, data)


def _state_entries(recording: Recording, messages: Messages) -> Iterator[Entry]:
    """Tell contact of all feet in one message, and perhaps their places."""
    first, feet = recording.feet[0], len(recording.feet)
    touching = np.stack([each.touching for each in recording.feet], axis=1)
    if recording.kind == "spot":
        # Contact is 1 where it is made, 2 where it is lost.
        numbers, flags = np.concatenate(recording.places, axis=1), np.where(touching, 1, 2)
        data = messages.spot(feet).all_filled(first.stamp, numbers, flags)
        yield from _rows(first.log_time, "/status/feet", SPOT, data)
    else:
        nothing = np.empty((len(first.stamp), 0))
        data = messages.contacts(feet).all_filled(first.stamp, nothing, touching.astype(np.int64))
        yield from _rows(first.log_time, "/foot_contacts", FLAGS, data)


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
    template = messages.transforms(BASE, [f"{name}_link" for name in robot.feet])
    hips = [(x, y, -0.5 * robot.height_m) for x, y in robot.corners_m]
    for row in np.unique(ticks).tolist():
        numbers: list[float] = []
        for number, (foot, hip) in enumerate(zip(recording.feet, hips, strict=True)):
            at = min(int(np.searchsorted(foot.time, first.time[row])), len(foot.time) - 1)
            place = recording.places[number][at].tolist() if recording.places else hip
            numbers += [*place, *foot.link[at].tolist()]
        data = template.filled(int(first.stamp[row]), numbers)
        yield Entry("/tf", TF, int(first.log_time[row]), data)
