"""Links that joint states move, against the transforms that the sample log has of them."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options import ConvertOptions
from tests.oracles.annotated_file import annotations, read_written
from tests.oracles.recorded import TEXT_TYPE, decoded_log, read_log
from tests.oracles.ros1_logs import text, write_ros1_mcap
from tests.oracles.walks import Entry
from tests.paths import TROT

JOINTS = "/dogbot/joint_states"
AXES = {"hip": ("roll", "0 1 0"), "upperleg": ("pitch", "1 0 0"), "lowerleg": ("knee", "1 0 0")}
"""Joint and axis by link, as sample_logs/leg_kinematics.py describes them."""
SECONDS = 1.0


@cache
def recorded() -> tuple[list[Any], Mapping[tuple[int, str], Any]]:
    """The beginning of the sample log, and its transforms by stamp and child frame."""
    messages = read_log(TROT)
    start = messages[0].log_time
    messages = [m for m in messages if m.log_time - start < SECONDS * 1e9]
    transforms = {
        (one.header.stamp.sec * 10**9 + one.header.stamp.nanosec, one.child_frame_id): one
        for topic in ("/tf", "/tf_static")
        for decoded in decoded_log(TROT).get(topic, [])
        for one in decoded.message.transforms
    }
    return messages, transforms


def urdf() -> str:
    """The log's frames as a description; joints of the links have no angle at position 0."""
    _, transforms = recorded()
    joints: dict[str, str] = {}
    for (_, child), one in transforms.items():
        foot, _, link = child.rpartition("_")
        shift = one.transform.translation
        kind, axis = "fixed", ""
        if link in AXES:
            kind, axis = "revolute", f'<axis xyz="{AXES[link][1]}"/>'
        name = f"{foot}_{AXES[link][0]}" if link in AXES else f"{child}_fixed"
        joints[child] = (
            f'<joint name="{name}" type="{kind}"><origin xyz="{shift.x} {shift.y} {shift.z}"/>'
            f'<parent link="{one.header.frame_id}"/><child link="{child}"/>{axis}</joint>'
        )
    links = "".join(f'<link name="{name}"/>' for name in ["base_link", *joints])
    return f'<robot name="r">{links}{"".join(joints.values())}</robot>'


def write(path: Path, description: str = "") -> Path:
    """Write the sample log without its transforms, and if wanted with a description."""
    messages, _ = recorded()
    entries = [
        Entry(m.topic, m.type_name, m.log_time, m.data)
        for m in messages
        if m.topic not in {"/tf", "/tf_static"}
    ]
    if description:
        entries.insert(
            0, Entry("/robot_description", TEXT_TYPE, entries[0].log_time, text(description))
        )
    return write_ros1_mcap(path, entries)


def moved(path: Path, encoding: str) -> list[tuple[int, list[Any]]]:
    kind = "foxglove.FrameTransforms" if encoding == "foxglove" else "tf2_msgs/TFMessage"
    found = annotations(read_written(path), "/tf", encoding, kind)
    return [
        (message.log_time, list(one.transforms))
        for message, one in found
        if len(one.transforms) > 1
    ]


def numbers(one: Any) -> tuple[str, str, int, list[float]]:
    """Parent, child, stamp and pose of a transform of either encoding."""
    if hasattr(one, "parent_frame_id"):
        shift, turn = one.translation, one.rotation
        names = one.parent_frame_id, one.child_frame_id
        stamp = one.timestamp.seconds * 10**9 + one.timestamp.nanos
    else:
        shift, turn = one.transform.translation, one.transform.rotation
        names = one.header.frame_id, one.child_frame_id
        time = one.header.stamp
        stamp = getattr(time, "sec", getattr(time, "secs", 0)) * 10**9
        stamp += getattr(time, "nanosec", getattr(time, "nsecs", 0))
    return *names, stamp, [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z, turn.w]


@pytest.mark.parametrize(
    ("encoding", "source"), [("foxglove", "given"), ("ros1", "own"), ("ros2", "given")]
)
def test_links_are_where_the_recorded_transforms_had_them(
    tmp_path: Path, encoding: str, source: str
) -> None:
    file, own = tmp_path / "dog.urdf", source == "own"
    file.write_text(urdf())
    log = write(tmp_path / "log.mcap", urdf() if own else "")
    options = ConvertOptions(encoding=encoding, copy=own, urdf=None if own else file)
    done = convert(log, tmp_path / "out.mcap", options)
    assert "ROBOT_DESCRIPTION" in {finding.code for finding in done.findings}
    messages = moved(tmp_path / "out.mcap", encoding)
    _, transforms = recorded()
    children = {child for _, child in transforms}
    assert len(messages) >= 49
    for _, each in messages[1:]:
        found = {numbers(one)[1]: numbers(one) for one in each}
        assert set(found) == children
        for child, (parent, _, stamp, pose) in found.items():
            expected = transforms.get((stamp, child)) or next(
                one for (_, name), one in transforms.items() if name == child
            )
            assert parent == expected.header.frame_id
            if child.endswith("_foot") or (stamp, child) in transforms:
                *_, truth = numbers(expected)
                sign = np.sign(np.dot(pose[3:], truth[3:]))
                np.testing.assert_allclose(pose[:3], truth[:3], atol=5e-8)
                np.testing.assert_allclose(sign * np.array(pose[3:]), truth[3:], atol=5e-8)
    assert any((numbers(one)[2], numbers(one)[1]) in transforms for one in messages[5][1])


def test_the_links_stand_at_the_first_time(tmp_path: Path) -> None:
    log = write(tmp_path / "log.mcap", urdf())
    convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert moved(tmp_path / "out.mcap", "foxglove")[0][0] == recorded()[0][0].log_time


def test_recorded_transforms_and_unknown_joints_are_left_alone(tmp_path: Path) -> None:
    file = tmp_path / "dog.urdf"
    file.write_text(urdf())
    done = convert(TROT, tmp_path / "out.mcap", ConvertOptions(urdf=file, end=0.5))
    assert "ROBOT_DESCRIPTION" not in {finding.code for finding in done.findings}
    file.write_text(
        urdf().replace("_knee", "_other").replace("_roll", "_b").replace("_pitch", "_c")
    )
    log = write(tmp_path / "log.mcap")
    done = convert(log, tmp_path / "out2.mcap", ConvertOptions(urdf=file))
    assert "ROBOT_DESCRIPTION" not in {finding.code for finding in done.findings}
    file.write_text(urdf().replace("base_link", "trunk"))
    done = convert(log, tmp_path / "out3.mcap", ConvertOptions(urdf=file))
    assert "ROBOT_DESCRIPTION" in {finding.code for finding in done.findings}


def test_joints_that_are_left_out_are_counted(tmp_path: Path) -> None:
    description = urdf().replace('axis xyz="0 1 0"', 'axis xyz="0 nan 0"', 1)
    log = write(tmp_path / "log.mcap", description)
    done = convert(log, tmp_path / "out.mcap", ConvertOptions())
    said = [each.text for each in done.findings if each.code == "ROBOT_DESCRIPTION"]
    assert any("joints left out of the robot description: 1 (" in each for each in said)
