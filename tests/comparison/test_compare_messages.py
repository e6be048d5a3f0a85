"""Messages compared by their definitions, in every encoding, and as bytes without."""

import math
import re
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

import dogbot_logtool as dl
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    START,
    WITH_NUMBER,
    Kind,
    Recording,
    compared,
    counts,
    json_log,
    lines,
    odometry,
    one_topic,
    recording,
    ros_kind,
    scene,
)


@pytest.mark.parametrize("encoding", WITH_NUMBER)
def test_the_last_bit_among_many_is_found_and_tolerated_on_request(
    tmp_path: Path, encoding: str
) -> None:
    kind, make, path = WITH_NUMBER[encoding]
    numbers = [i / 7 for i in range(300)]
    expected = one_topic(kind, *map(make, numbers))
    numbers[234] = math.nextafter(numbers[234], math.inf)
    actual = one_topic(kind, *map(make, numbers))
    before, after = 234 / 7, numbers[234]
    result = compared(tmp_path, expected, actual)
    assert (result.exit_code, lines(result)) == (
        1,
        [f"/a[234] t=0.234 s {path}: expected {before!r}, got {after!r} (|d| 7.11e-15)"],
    )
    assert counts(result) == (300, 300, 299, 0, 1, 0, 0)
    deviations = [(one.deviation, one.deviation_path) for one in result.tallies if one.deviation]
    assert deviations == [(after - before, f"[234] {path}")]
    for options in ({"atol": 1e-13}, {"rtol": 1e-15}):
        result = compared(tmp_path, expected, actual, **options)
        assert result.exit_code == 0
        assert counts(result) == (300, 300, 299, 1, 0, 0, 0)
        assert result.verdict.endswith("1 within tolerance")


def ros(*messages: bytes) -> Recording:
    return one_topic(ros_kind(1), *messages)


ODD_NAN = struct.unpack("<d", struct.pack("<Q", 0xFFF8000000000123))[0]
FIVE = [(time, "1") for time in range(5)]
THREE = json_log((0, '{"x": 1, "h": {"s": 1}}'), topics="/a /b /c")
CHANGED = json_log((0, '{"x": 2, "h": {"s": 2}}'), topics="/a /b /c")
AT = "/a[0] t=0.000 s"
PUBLISHED = one_topic(JSON, b"1")
LATER = replace(PUBLISHED, publish_delay=1)
NAN = ros(odometry(1, (math.nan, 0.0, 0.0), covariance=math.nan))
ROS = ros_kind(1)
RENAMED = replace(ROS, schema=ROS.schema.replace(b"child_frame_id", b"other_frame_id"))
COMMENTED = replace(ROS, schema=b"# a comment\n" + ROS.schema.replace(b"\n", b"\r\n"))
UNKNOWN = bytes([(100 << 3) & 0x7F | 0x80, (100 << 3) >> 7, 7])
"""A field of protobuf that the definition lacks."""
NO_POSE = '{"position": null, "orientation": null}'
DEFINITION = '/a schema: expected "string child_frame_id", got "string other_frame_id"'


def update(*, with_pose: bool) -> bytes:
    message: Any = SceneUpdate()
    arrow = message.entities.add().arrows.add()
    if with_pose:
        arrow.pose.SetInParent()
    data: bytes = message.SerializeToString()
    return data


ARRAYS = Kind("ros1", "a/Arrays", "ros1msg", b"uint64[] whole\nfloat32[] numbers\n")


def arrays(whole: Sequence[int], numbers: Sequence[float]) -> bytes:
    parts = zip(("<u8", "<f4"), (whole, numbers), strict=True)
    return b"".join(
        struct.pack("<I", len(each)) + np.array(each, kind).tobytes() for kind, each in parts
    )


def padded() -> bytes:
    """The scene with a length in two bytes; the entity has become a byte longer."""
    data = scene(entity="a").replace(b"\x1a\x01a", b"\x1a\x81\x00a", 1)
    return data[:1] + bytes([len(data) - 2]) + data[2:]


PAIRS: dict[str, tuple[Recording, Recording, dict[str, Any], list[str]]] = {
    "one fewer": (json_log(*FIVE), json_log(*FIVE[:2], *FIVE[3:]), {}, [
        "/a[2] t=0.002 s: missing"
    ]),
    "one fewer at the same time": (
        json_log((0, "1"), (1, "1"), (1, "2")), json_log((0, "1"), (1, "1")), {}, [
        "/a[2] t=0.001 s: missing"
    ]),
    "a renamed frame": (ros(odometry(1)), ros(odometry(1, frame="/world")), {}, [
        f'{AT} header.frame_id: expected "world", got "/world"'
    ]),
    "NaN of another kind": (
        NAN, ros(odometry(1, (ODD_NAN, 0.0, 0.0), covariance=ODD_NAN)), {}, []
    ),
    "NaN and numbers": (NAN, ros(odometry(1, (1.0, 0.0, 0.5), covariance=math.nan)), {}, [
        f"{AT} pose.pose.position.x: expected nan, got 1.0",
        f"{AT} pose.pose.position.z: expected 0.0, got 0.5 (|d| 0.5)",
    ]),
    "turned quaternions": (
        ros(odometry(1, orientation=(0.6, 0.0, 0.0, 0.8))),
        ros(odometry(1, orientation=(-0.6, 0.0, 0.0, -0.8))), {}, []
    ),
    "a topic fewer": (json_log(*FIVE, topics="/a /b"), json_log(*FIVE), {}, [
        "/b: the topic is missing (5 messages)"
    ]),
    "a silent topic more": (json_log(*FIVE), recording({"/a": JSON, "/b": JSON}, *(
        ("/a", t, b"1") for t in range(5))), {}, ["/b: the topic is extra (0 messages)"]),
    "another publish time": (PUBLISHED, LATER, {}, [
        f"{AT} publish_time: expected {START}, got {START + 1}"
    ]),
    "an ignored publish time": (PUBLISHED, LATER, {"ignore": ["publish_time"]}, []),
    "some topics": (THREE, CHANGED, {"topics": ["/[ab]"], "ignore": ["x"]}, [
        f"/{topic}[0] t=0.000 s h.s: expected 1, got 2" for topic in "ab"
    ]),
    "ignored fields of topics": (THREE, CHANGED, {"ignore": ["/a:*", "/[bc]:h.*"]}, [
        f"/{topic}[0] t=0.000 s x: expected 1, got 2" for topic in "bc"
    ]),
    "empty": (Recording({}, []), Recording({}, []), {}, []),
    "an unknown encoding": (one_topic(RAW, b"abc", b"abc"), one_topic(RAW, b"abx", b"ab"), {}, [
        f"{AT} payload[2]: expected 0x63, got 0x78",
        "/a[1] t=0.001 s payload: expected 3 bytes, got 2 bytes",
    ]),
    "no definition": (one_topic(Kind("cdr"), b"abc"), one_topic(Kind("cdr"), b"abx"), {}, [
        f"{AT} payload[2]: expected 0x63, got 0x78",
    ]),
    "a field that protobuf leaves out": (
        one_topic(SCENE, update(with_pose=True)), one_topic(SCENE, update(with_pose=False)), {}, [
        f"{AT} entities[0].arrows[0].pose: expected {NO_POSE}, got null"
    ]),
    "a field that protobuf's definition lacks": (
        one_topic(SCENE, scene()), one_topic(SCENE, scene() + UNKNOWN), {}, [
        f"{AT} (unknown fields): expected nothing, got {len(UNKNOWN)} bytes {UNKNOWN.hex()}"
    ]),
    "protobuf in another way": (
        one_topic(SCENE, scene(entity="a")), one_topic(SCENE, padded()), {}, []
    ),
    "arrays": (
        one_topic(ARRAYS, arrays([1, 2, 200], [1.0, 2.0, 3.0])),
        one_topic(ARRAYS, arrays([2, 1, 200], [1.0, 2.5])), {}, [
        f"{AT} whole[0]: expected 1, got 2",
        f"{AT} whole[1]: expected 2, got 1",
        f"{AT} numbers[1]: expected 2.0, got 2.5 (|d| 0.5)",
        f"{AT} numbers: expected 3 elements, got 2 elements",
    ]),
    "a definition with comments": (
        one_topic(ROS, odometry(1)), one_topic(COMMENTED, odometry(1)), {}, []
    ),
    # Named once.
    "another definition": (
        one_topic(ROS, *[odometry(1)] * 100), one_topic(RENAMED, *[odometry(1)] * 100), {}, [
        DEFINITION
    ]),
    "each by its own definition": (
        one_topic(ROS, odometry(1)), one_topic(RENAMED, odometry(1, frame="w")), {}, [
        DEFINITION,
        f'{AT} header.frame_id: expected "world", got "w"',
        f'{AT} child_frame_id: expected "base_link", got nothing',
        f'{AT} other_frame_id: expected nothing, got "base_link"',
    ]),
    "another JSON schema": (
        one_topic(JSON, b"1"), one_topic(replace(JSON, schema=b'{"type": "array"}'), b"1"), {}, [
        r'/a schema: expected "\"type\": \"object\"", got "\"type\": \"array\""'
    ]),
    "another type and encoding": (
        one_topic(ROS, *[odometry(1)] * 100), one_topic(SCENE, *[scene()] * 100), {}, [
        "/a type: expected nav_msgs/Odometry, got foxglove.SceneUpdate",
        "/a encoding: expected ros1, got protobuf",
    ]),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_what_differs(tmp_path: Path, name: str) -> None:
    expected, actual, options, wanted = PAIRS[name]
    result = compared(tmp_path, expected, actual, **options)
    assert (result.exit_code, lines(result)) == (1 if wanted else 0, wanted)


def test_the_verdict_counts(tmp_path: Path) -> None:
    fewer, more, *_ = PAIRS["one fewer"]
    assert compared(tmp_path, more, fewer).verdict == (
        "different: 1 extra, of 1 topics and 4 messages"
    )
    result = compared(tmp_path, *PAIRS["turned quaternions"][:2])
    assert counts(result) == (1, 1, 0, 1, 0, 0, 0)
    result = compared(tmp_path, *PAIRS["empty"][:2])
    assert result.warnings == ("neither file has any messages to compare",)
    # A description is no message.
    result = compared(tmp_path, *PAIRS["another definition"][:2])
    assert counts(result) == (100, 100, 100, 0, 0, 0, 0)
    result = compared(tmp_path, *PAIRS["another type and encoding"][:2])
    assert counts(result) == (100, 100, 0, 0, 100, 0, 0)


def test_patterns_that_leave_nothing_are_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(dl.CallError, match="--ignore leaves no topic to compare: /"):
        compared(tmp_path, THREE, CHANGED, ignore=("/*",))
    with pytest.raises(dl.CallError, match="--topics leaves no topic to compare: /x, /y"):
        compared(tmp_path, THREE, CHANGED, topics=("/x", "/y"))


def test_all_differences_are_counted_and_the_first_are_kept(tmp_path: Path) -> None:
    times = range(50)
    pair = [json_log(*((t, v) for t in times), topics="/a /b") for v in ("[0, 0]", "[1, 2]")]
    for limit in (0, 1, 5, 1000):
        result = compared(tmp_path, *pair, max_differences=limit)
        assert len(result.differences) == min(limit, 200)
        assert (result.difference_count, result.exit_code) == (200, 1)
        found = [f"{d.topic}{d.index}{d.path}" for d in result.differences[:5]]
        assert found == ["/a0[0]", "/a0[1]", "/b0[0]", "/b0[1]", "/a1[0]"][:limit]
    pair = [one_topic(ARRAYS, arrays([each] * 107, [])) for each in (0, 1)]
    result = compared(tmp_path, *pair, max_differences=1000)
    assert lines(result)[-1] == f"{AT} whole: expected 7 more elements, got others"
    assert (len(result.differences), result.difference_count) == (101, 107)


# --- Messages that cannot be decoded --------------------------------------------------------------


@pytest.mark.parametrize("encoding", WITH_NUMBER)
@pytest.mark.parametrize("fault", ["cut short", "broken definition"])
def test_they_are_compared_as_bytes(tmp_path: Path, encoding: str, fault: str) -> None:
    kind, make, _ = WITH_NUMBER[encoding]
    payloads = make(1.0), make(2.0)
    if encoding == "json":
        # It is decoded without a definition, if it is not nested too deeply.
        payloads = b"[" * 990 + b"1" + b"]" * 990, b"[" * 990 + b"2" + b"]" * 990
    if fault == "cut short":
        payloads = payloads[0], payloads[0][:-1]
    else:
        kind = replace(kind, schema=b"\xff( none")
    expected, actual = (one_topic(kind, each) for each in payloads)
    assert compared(tmp_path, expected, expected).same
    result = compared(tmp_path, expected, actual)
    (line,) = lines(result)
    assert line.startswith(f"{AT} payload")
    (note,) = [one.note for one in result.tallies if one.name == "/a"]
    assert re.match("compared as bytes: (not |the definition of )", note)
