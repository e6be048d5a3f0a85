"""`info --frames`: the frames of whole logs, against rosbags, message by message."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from mcap_protobuf.schema import build_file_descriptor_set
from rosbags.highlevel import AnyReader

import dogbot_logtool as dl
from dogbot_logtool.results import LogInfo
from dogbot_logtool.robot.frames import MOST_EDGES, Frames
from tests.oracles.mcap_channels import SentChannel, write_channels
from tests.paths import SAMPLE_LOGS

LOGS = [SAMPLE_LOGS / f"dogbot_{name}" for name in ("trot.bag", "walk.mcap", "troubled.bag")]
CORPUS = os.environ.get("LOGTOOL_CORPUS")
REAL = Path(CORPUS or "absent") / "MichaelGrupp+evo" / "test" / "data"
REAL_LOGS = [REAL / "nav2_turtlebot.mcap", REAL / "tf_example.bag", REAL / "tf_example"]
real = pytest.mark.skipif(not CORPUS, reason="LOGTOOL_CORPUS names no folder of real logs")
SECOND = 1_000_000_000
KIND = "foxglove.FrameTransforms"


LastMessage = dict[tuple[str, str], list[tuple[int, int, bool]]]
"""Stamp, log time, and whether static, by parent and child, in the order of the log."""


def survey(path: Path) -> tuple[LogInfo, Frames]:
    info = dl.info(path, frames=True)
    assert info.frames is not None
    return info, info.frames


def heard(path: Path) -> LastMessage:
    """Read every transform with rosbags."""
    edges: LastMessage = {}
    with AnyReader([path]) as reader:
        connections = [c for c in reader.connections if c.msgtype.endswith("/TFMessage")]
        for connection, log_time, data in reader.messages(connections):
            message: Any = reader.deserialize(data, connection.msgtype)
            for each in message.transforms:
                stamp = each.header.stamp.sec * SECOND + each.header.stamp.nanosec
                pair = each.header.frame_id.lstrip("/"), each.child_frame_id.lstrip("/")
                static = connection.topic == "/tf_static"
                edges.setdefault(pair, []).append((stamp, log_time, static))
    return edges


@pytest.mark.parametrize("path", [*LOGS, *(pytest.param(log, marks=real) for log in REAL_LOGS)])
def test_every_edge_is_what_rosbags_reads(path: Path) -> None:
    told = {(edge.parent, edge.child): edge for edge in survey(path)[1].edges}
    oracle = heard(path)
    assert told.keys() == oracle.keys()
    for pair, messages in oracle.items():
        edge = told[pair]
        moving = [(stamp, log_time) for stamp, log_time, static in messages if not static]
        assert edge.transforms == len(messages)
        assert edge.static == len(messages) - len(moving)
        assert edge.not_finite == edge.zero_rotations == edge.not_normalised == 0
        if not moving:
            assert edge.timing is None
            continue
        assert edge.timing is not None
        stamped = all(stamp for stamp, _ in moving)
        times = np.array([stamp if stamped else log_time for stamp, log_time in moving])
        assert (edge.timing.first, edge.timing.last) == (times.min(), times.max())
        assert edge.timing.backward_stamps == (np.diff(times) < 0).sum() * stamped


# ---- logs of our own making ----

Sent = tuple[int, str, str]
"""Time in ms, parent, child."""


def foxglove_log(path: Path, topics: dict[str, list[Sent]]) -> Path:
    """Write an MCAP of foxglove.FrameTransforms, one transform a message.

    Log times are the transforms' own, but none of a pair is before the one in front of it.
    """
    definition = build_file_descriptor_set(FrameTransforms).SerializeToString()
    channels = []
    for topic, sent in topics.items():
        messages = []
        logged: dict[tuple[str, str], int] = {}
        for milliseconds, parent, child in sent:
            message = FrameTransforms()
            one = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
            one.timestamp.FromMilliseconds(milliseconds)
            one.rotation.w = 1.0
            time = max(milliseconds * 1_000_000, logged.get((parent, child), 0))
            logged[parent, child] = time
            messages.append((time, message.SerializeToString()))
        channels.append(SentChannel(topic, KIND, "protobuf", "protobuf", definition, messages))
    return write_channels(path, channels)


def codes(info: LogInfo) -> set[str]:
    about_topics = {"ROBOT_GUESSED", "NO_FEET", "NO_BASE", "NO_SUPPORT_DRAWN"}
    about_base = {"TOPICS_CHOSEN", "TF_NOT_WRITTEN"}
    return {finding.code for finding in info.findings} - about_topics - about_base


def every(start: int, end: int, parent: str, child: str) -> list[Sent]:
    return [(time, parent, child) for time in range(start, end, 20)]


@pytest.mark.parametrize(
    ("topics", "wanted"),
    [
        ({"/tf": every(0, 900, "map", "base")}, {"BAD_TRANSFORMS"}),
        ({"/tf": every(20, 900, "map", "base")}, set()),
        ({"/tf": every(20, 900, "/map", "base")}, {"FRAME_NAMES"}),
        ({"/tf": every(20, 900, "m", "b") + every(2000, 3000, "m", "b")}, {"BAD_TRANSFORMS"}),
        ({"/tf": every(20, 900, "m", "b"), "/t": every(30, 900, "o", "b")}, {"FRAME_TREE"}),
        ({"/tf": every(20, 900, "m", "b") + every(900, 1800, "o", "b")}, {"FRAME_TREE"}),
        ({"/tf": every(20, 900, "a", "b") + every(20, 900, "b", "a")}, {"FRAME_TREE"}),
        ({"/tf": every(20, 900, "a", "b") + every(20, 900, "c", "d")}, {"FRAME_TREE"}),
        ({"/tf": every(20, 900, "a", "b"), "/tf_static": [(5, "a", "b")]}, {"FRAME_TREE"}),
        ({"/tf": [(20, "a", "b"), (40, "a", "b"), (30, "a", "b")]}, {"BAD_TRANSFORMS"}),
        ({"/tf": [(20, "a", "b"), (20, "a", "b"), (30, "a", "b")]}, {"BAD_TRANSFORMS"}),
        ({"/tf": [(20, "a", "b"), (20, "", "b")]}, {"FRAME_NAMES"}),
    ],
)
def test_findings(topics: dict[str, list[Sent]], wanted: set[str], tmp_path: Path) -> None:
    info, _ = survey(foxglove_log(tmp_path / "log.mcap", topics))
    assert codes(info) == wanted


def test_messages_that_are_no_transforms_are_damage(tmp_path: Path) -> None:
    one = FrameTransform(parent_frame_id="a", child_frame_id="b")
    whole = FrameTransforms(transforms=[one]).SerializeToString()
    one.timestamp.seconds = -(1 << 62)
    ages = FrameTransforms(transforms=[one]).SerializeToString()
    payloads = (b"\xff\xff\xff", whole, whole[:-1], ages, b"\n\0" * (1 << 20))
    messages = [(SECOND, payload) for payload in payloads]
    channels = [
        SentChannel(topic, KIND, encoding, "protobuf", b"", messages)
        for topic, encoding in (("/tf", "protobuf"), ("/tf_cbor", "cbor"))
    ]
    info, frames = survey(write_channels(tmp_path / "log.mcap", channels))
    assert [edge.transforms for edge in frames.edges] == [2]
    assert [loss.messages for loss in info.damage.losses] == [3]
    assert info.damage.exit_code == 3
    assert "UNREADABLE" in codes(info)


def test_of_very_many_frames_the_rest_is_counted(tmp_path: Path) -> None:
    sent = [(number, "base", f"link_{number:04}") for number in range(MOST_EDGES + 3)]
    info, frames = survey(foxglove_log(tmp_path / "many.mcap", {"/tf": sent}))
    assert len(frames.edges) == MOST_EDGES
    (text,) = [each.text for each in info.findings if each.code == "FRAME_NAMES"]
    assert text.startswith("3 transforms were left out")
