"""Joint states of every type: the same positions, velocities and efforts by name."""

import json
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from rosbags.typesys import get_types_from_msg

import dogbot_logtool as dl
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.reader.messages.others import read_joints
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.reader.opening import open_log
from tests.oracles import walks
from tests.oracles.mcap_channels import SentChannel, write_channels

NAMES: Final = tuple(
    f"{leg}_{joint}_joint" for leg in ("FR", "FL", "RR", "RL") for joint in ("hip", "thigh", "calf")
)
SAMPLES: Final = 7
MOTORS: Final = {
    "unitree_go/msg/LowState": ("motor_state", "tau_est", "foot_force"),
    "unitree_legged_msgs/msg/LowState": ("motorState", "tauEst", "footForce"),
}
"""The fields of motors, of a motor's effort, and of forces."""
ROS: Final = "sensor_msgs/msg/JointState"


def value(sample: int, joint: int, kind: int) -> float:
    """Position, velocity or effort of a joint; exact in single precision."""
    return sample + joint / 16.0 + kind * 100.0


def values(sample: int, kind: int, joints: Sequence[int] = range(12)) -> list[float]:
    return [value(sample, joint, kind) for joint in joints]


def ros(walk: walks.Walk, sample: int) -> Any:
    """Names in another order in every message; efforts of the first ten only."""
    order = np.roll(np.arange(12), sample).tolist()
    return walk.make(
        ROS,
        header=walk.header(sample, ""),
        name=[NAMES[joint] for joint in order],
        position=np.array(values(sample, 0, order)),
        velocity=np.array(values(sample, 1, order)),
        effort=np.array(values(sample, 2, order[:10])),
    )


def motors(walk: walks.Walk, kind: str, sample: int) -> Any:
    """Twenty motors, of which a quadruped has twelve."""
    field, effort, _ = MOTORS[kind]
    numbers = [[value(sample, joint, kind) for kind in range(3)] for joint in range(20)]
    states = [{"mode": 1, "q": q, "dq": dq, effort: tau} for q, dq, tau in numbers]
    return walk.make(kind, tick=sample, **{field: states})


def store(kind: str, ros_version: int) -> walks.Walk:
    walk = walks.Walk(ros_version)
    if kind in MOTORS:
        field, effort, forces = MOTORS[kind]
        motor = kind.replace("LowState", "MotorState")
        walk.store.fielddefs.pop(kind, None)
        text = f"uint8 mode\nfloat32 q\nfloat32 dq\nfloat32 {effort}"
        walk.store.register(get_types_from_msg(text, motor))
        text = f"{motor}[20] {field}\nint16[4] {forces}\nuint32 tick"
        walk.store.register(get_types_from_msg(text, kind))
    return walk


def foxglove(sample: int, encoding: str) -> bytes:
    """A message in which the last joint has no effort."""
    time = divmod(walks.START + sample * walks.STEP, 1_000_000_000)
    joints = [
        {"name": name, "position": value(sample, joint, 0), "velocity": value(sample, joint, 1)}
        | ({} if joint == 11 else {"effort": value(sample, joint, 2)})
        for joint, name in enumerate(NAMES)
    ]
    parts = ("sec", "nsec") if encoding == "json" else ("seconds", "nanos")
    fields: Any = {"timestamp": dict(zip(parts, time, strict=True)), "joints": joints}
    if encoding == "json":
        return json.dumps(fields).encode()
    return bytes(JointStates(**fields).SerializeToString())


def read(path: Path) -> JointTable:
    with closing(open_log(path)) as log:
        (channel,) = log.channels.values()
        source = source_of(channel, "joints")
        assert source
        assert not source.fault
        (span,) = log.spans()
        (states,) = read_joints(log.read(span), channel)
    return states


def check(states: JointTable, *, unknown_efforts: bool) -> None:
    assert sorted(states.names) == sorted(NAMES)
    assert states.samples.log_time.tolist() == [
        walks.START + s * walks.STEP for s in range(SAMPLES)
    ]
    order = [states.names.index(name) for name in NAMES]
    samples = states.samples
    for kind, found in enumerate((samples.position, samples.velocity, samples.effort)):
        expected = np.array([values(sample, kind) for sample in range(SAMPLES)])
        told = np.isfinite(found[:, order])
        assert found[:, order][told].tolist() == expected[told].tolist()
        assert told.all() == (kind < 2 or not unknown_efforts)


def write(folder: Path, kind: str, ros_version: int, damaged: int = -1) -> Path:
    walk, entries = store(kind, ros_version), []
    for sample in range(SAMPLES):
        message = ros(walk, sample) if kind == ROS else motors(walk, kind, sample)
        data = walk.bytes_of(kind, message)
        time = walks.START + sample * walks.STEP
        data = data[: 50 if sample == damaged else None]
        entries.append(walks.Entry("/joints", kind, time, data))
    return walks.write_log(folder, walk, entries)


@pytest.mark.parametrize(("kind", "ros_version"), [(ROS, 1), *((kind, 2) for kind in MOTORS)])
def test_ros_messages(tmp_path: Path, kind: str, ros_version: int) -> None:
    states = read(write(tmp_path, kind, ros_version))
    check(states, unknown_efforts=kind == ROS)


def test_a_message_that_tells_of_joints_and_feet_is_lost_once(tmp_path: Path) -> None:
    found = dl.measure(write(tmp_path, "unitree_go/msg/LowState", 2, damaged=3)).stats
    text = next(each["text"] for each in found["findings"] if "decoded" in each["text"])
    assert text == "lost 1 message: 1 messages of /joints could not be decoded"


def without_names(folder: Path, definition: str = "") -> Path:
    """Write a message of two joints; its definition may be another one."""
    walk = walks.Walk(1)
    if definition:
        walk.store.fielddefs.pop(ROS)
        walk.store.register(get_types_from_msg(definition, ROS))
    message = walk.make(ROS, header=walk.header(0, ""), position=np.array([0.5, 0.25]))
    entry = walks.Entry("/joints", ROS, walks.START, walk.bytes_of(ROS, message))
    return walks.write_log(folder, walk, [entry])


def test_joints_without_names_are_numbered(tmp_path: Path) -> None:
    states = read(without_names(tmp_path))
    assert states.names == ("joint_0", "joint_1")
    assert states.samples.position.tolist() == [[0.5, 0.25]]


def test_joints_in_a_fixed_array_are_not_read(tmp_path: Path) -> None:
    text = "std_msgs/Header header\nstring[] name\nfloat64[2] position\nfloat64[] velocity\n"
    with closing(open_log(without_names(tmp_path, f"{text}float64[] effort"))) as log:
        (channel,) = log.channels.values()
        source = source_of(channel, "joints")
    assert source
    assert source.fault == "its joints stand in arrays of a fixed length"


@pytest.mark.parametrize("encoding", ["protobuf", "json"])
def test_foxglove_messages(tmp_path: Path, encoding: str) -> None:
    messages = [
        (walks.START + sample * walks.STEP, foxglove(sample, encoding)) for sample in range(SAMPLES)
    ]
    sent = SentChannel("/joints", "foxglove.JointStates", encoding, encoding, messages=messages)
    states = read(write_channels(tmp_path / "log.mcap", [sent]))
    check(states, unknown_efforts=True)
    assert states.samples.stamp.tolist() == states.samples.log_time.tolist()
