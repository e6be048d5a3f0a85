"""A recording as a log file."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.oracles.walks import Entry
from tests.truth.messages import (
    CONTACTS,
    GROUND,
    IMU,
    ODOMETRY,
    SPOT,
    TF,
    WRENCH,
    contact_state,
    header,
    messages,
    transform,
    write,
)
from tests.truth.recording import Messages, Recording, Sensor, VectorRecording

BASE: Final = "base_link"
WORLD: Final = "odom"
TF_RATE_HZ: Final = 50.0


def write_log(recording: Recording, path: Path) -> Path:
    """Write an MCAP of ROS 2 messages."""
    return write(path, _entries(recording))


def _entries(recording: Recording) -> Iterator[Entry]:
    yield from _base_entries(recording)
    if recording.kind in {"spot", "flags"}:
        yield from _state_entries(recording)
    else:
        for foot in range(len(recording.feet)):
            for sensor in recording.sensors_of(foot):
                yield from _SENSORS[recording.kind](recording, sensor)
    if recording.has_tf:
        yield from _transform_entries(recording)
    if recording.statics:
        frames = [transform(BASE, name, pose[:3], pose[3:]) for name, pose in recording.statics]
        yield from _sent(recording.base.pick(np.arange(1)), "/tf_static", TF, transforms=frames)
    for topic in recording.beside:
        yield from _vector_entries(topic)


def _sent(given: Messages, topic: str, kind: str, **fields: Any) -> list[Entry]:
    return messages(topic, kind, given.stamp, given.log_time, **fields)


def _base_entries(recording: Recording) -> list[Entry]:
    base, topic = recording.base, recording.odometry or recording.robot.odometry_topic
    return _sent(
        base,
        topic,
        ODOMETRY,
        header=header(WORLD),
        child_frame_id=recording.child_frame,
        pose=[[base.position, base.orientation]],
        twist=[[base.velocity]],
    )


def _force_entries(_: Recording, of: Sensor) -> list[Entry]:
    wrench = [of.columns.force]
    return _sent(of.columns, of.topic, WRENCH, header=header(of.frame), wrench=wrench)


def _bumper_entries(recording: Recording, of: Sensor) -> Iterator[Entry]:
    robot, link, touching = recording.robot.name, of.frame, of.columns.touching
    name = f"{robot}::{link}::{link.removesuffix('_link')}_collision"
    down, swing = of.columns.pick(touching), of.columns.pick(~touching)
    own = contact_state(
        name, (0, 0, 30), (0, 0, 0.3), (0, 0, 1), f"{robot}::{BASE}::{BASE}_collision"
    )
    states = [contact_state(name, down.force, down.point, down.normal)]
    others = [own] if recording.touches_itself else []
    kinds = [
        iter(_sent(each, of.topic, CONTACTS, header=header(link), states=told))
        for each, told in ((swing, others), (down, states))
    ]
    yield from (next(kinds[is_down]) for is_down in touching.astype(int))


def _gz_entries(recording: Recording, of: Sensor) -> list[Entry]:
    """Report contacts only; the force on the ground is the force on the foot turned round."""
    sensor, link = of.columns.pick(of.columns.touching), of.frame
    name = f"{recording.robot.name}::{link}::{link.removesuffix('_link')}_collision"
    wrenches = {"body_1_wrench": [sensor.force], "body_2_wrench": [-sensor.force]}
    pair = {
        "collision1": {"name": name, "type": 4},
        "collision2": {"name": GROUND, "type": 4},
        "positions": [sensor.point],
        "normals": [sensor.normal],
        "depths": [0.0],
        "wrenches": [{"header": header(link), **wrenches}],
    }
    kind = "ros_gz_interfaces/msg/Contacts"
    return _sent(sensor, of.topic, kind, header=header(link), contacts=[pair])


_SENSORS: Final[dict[str, Callable[[Recording, Sensor], Any]]] = {
    "contacts": _bumper_entries,
    "gz_contacts": _gz_entries,
    "wrench": _force_entries,
}


def _vector_entries(of: VectorRecording) -> list[Entry]:
    first, second, third = of.vector[:, :3].T
    twist = [(first, second, 0.0), (0.0, 0.0, third)]
    stamped = header(of.frame)
    if of.kind == "twist":
        linear, angular = twist
        return _sent(of, of.topic, "geometry_msgs/msg/Twist", linear=linear, angular=angular)
    if of.kind == "twist_stamped":
        return _sent(of, of.topic, "geometry_msgs/msg/TwistStamped", header=stamped, twist=twist)
    told = {"linear_acceleration": of.vector[:, :3], "angular_velocity": of.vector[:, 3:]}
    return _sent(of, of.topic, IMU, header=stamped, **told)


def _state_entries(recording: Recording) -> list[Entry]:
    """Tell contact of all feet in one message, and perhaps their places."""
    first = recording.feet[0]
    touching = [each.touching for each in recording.feet]
    if recording.kind == "flags":
        kind = "champ_msgs/msg/ContactsStamped"
        return _sent(first, "/foot_contacts", kind, header=header(), contacts=touching)
    # Contact is 1 where it is made, 2 where it is lost.
    states = [
        {"foot_position_rt_body": place, "contact": np.where(down, 1, 2)}
        for place, down in zip(recording.places, touching, strict=True)
    ]
    return _sent(first, "/status/feet", SPOT, header=header(), states=states)


def _transform_entries(recording: Recording) -> list[Entry]:
    """Send all links in one message, fifty times a second, by the first foot's clock."""
    first, robot = recording.feet[0], recording.robot
    ticks = np.searchsorted(first.time, np.arange(0.0, first.time[-1], 1.0 / TF_RATE_HZ))
    sent = first.pick(np.unique([*ticks, len(first.time) - 1]))
    transforms = []
    for row, (name, foot, corner) in enumerate(
        zip(robot.feet, recording.feet, robot.corners_m, strict=True)
    ):
        at = np.searchsorted(foot.time, sent.time).clip(max=len(foot.time) - 1)
        hip = np.tile((*corner, -0.5 * robot.height_m), (len(at), 1))
        place = recording.places[row][at] if recording.places else hip
        transforms.append(transform(BASE, f"{name}_link", place, foot.link[at]))
    return _sent(sent, "/tf", TF, transforms=transforms)
