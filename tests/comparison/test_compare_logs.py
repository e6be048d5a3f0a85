"""Logs written by the mcap library and compared: whatever is changed is found, and nothing else."""

import math
import random
import struct
import tracemalloc
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.writer import CompressionType, IndexType, Writer

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.comparison.logs.windows import indexed_track, load, measured_track, plan_windows
from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.errors import CallError
from dogbot_logtool.pipeline.options import CompareOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.opening import open_log
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    START,
    WITH_NUMBER,
    Kind,
    Message,
    Packing,
    Recording,
    file_set,
    load_with_force,
    mixed,
    odometry,
    one_topic,
    recording,
    ros_kind,
    scene,
)


class Pair:
    """Two recordings, written and compared."""

    def __init__(self, folder: Path) -> None:
        self.expected = folder / "expected.mcap"
        self.actual = folder / "actual.mcap"

    def write(self, expected: Recording, actual: Recording) -> None:
        expected.write(self.expected)
        actual.write(self.actual)

    def compare(self, options: CompareOptions = CompareOptions()) -> Comparison:  # noqa: B008
        return compare(self.expected, self.actual, options)

    def lines(
        self,
        expected: Recording,
        actual: Recording,
        options: CompareOptions = CompareOptions(),  # noqa: B008 - frozen
    ) -> list[str]:
        self.write(expected, actual)
        result = self.compare(options)
        assert result.same == (not result.differences)
        assert result.exit_code == (0 if result.same else 1)
        return [difference.line for difference in result.differences]


@pytest.fixture
def pair(tmp_path: Path) -> Pair:
    return Pair(tmp_path)


def tally(result: Comparison, name: str) -> Tally:
    return next(one for one in result.tallies if one.name == name)


def counts(one: Tally) -> tuple[int, int, int, int, int, int, int]:
    return (
        one.expected,
        one.actual,
        one.equal,
        one.within_tolerance,
        one.different,
        one.missing,
        one.extra,
    )


PACKINGS = [
    Packing(CompressionType.NONE, 300),
    Packing(CompressionType.LZ4, 5000),
    Packing(CompressionType.ZSTD, 100_000, indexes=IndexType.NONE),
    Packing(CompressionType.LZ4, 700, summary=False),
    Packing(chunked=False),
]


@pytest.mark.parametrize("packing", PACKINGS, ids=str)
def test_packing_does_not_matter(pair: Pair, packing: Packing) -> None:
    mixed().write(pair.expected)
    mixed().write(pair.actual, packing)
    result = pair.compare()
    assert (result.exit_code, result.difference_count, result.losses) == (0, 0, [])
    assert result.verdict == "same: 5 topics, 250 messages"
    assert counts(tally(result, "/scene")) == (100, 100, 100, 0, 0, 0, 0)
    assert counts(tally(result, "/silent")) == (0,) * 7


@pytest.mark.parametrize("encoding", WITH_NUMBER)
def test_the_last_bit_among_many_is_found_and_tolerated_on_request(
    pair: Pair, encoding: str
) -> None:
    kind, make, path = WITH_NUMBER[encoding]
    numbers = [i / 7 for i in range(3000)]
    expected = one_topic(kind, *map(make, numbers))
    numbers[1234] = math.nextafter(numbers[1234], math.inf)
    actual = one_topic(kind, *map(make, numbers))
    before, after = 1234 / 7, numbers[1234]
    assert pair.lines(expected, actual) == [
        f"/a[1234] t=1.234 s {path}: expected {before!r}, got {after!r} (|d| 2.84e-14)"
    ]
    one = tally(pair.compare(), "/a")
    assert counts(one) == (3000, 3000, 2999, 0, 1, 0, 0)
    assert (one.deviation, one.deviation_path) == (after - before, f"[1234] {path}")
    for options in (CompareOptions(atol=1e-13), CompareOptions(rtol=1e-15)):
        result = pair.compare(options)
        assert result.exit_code == 0
        assert counts(tally(result, "/a")) == (3000, 3000, 2999, 1, 0, 0, 0)
        assert tally(result, "/a").deviation == after - before
        assert result.verdict.endswith("1 within tolerance")


def test_the_line_reads_as_promised(pair: Pair) -> None:
    topic = "/marker_basic_front_left_foot"
    times = [*range(128), 12_400]
    kinds = {topic: SCENE}
    expected = recording(kinds, *((topic, time, scene(0.0213)) for time in times))
    actual = recording(
        kinds, *((topic, time, scene(0.0231 if time == 12_400 else 0.0213)) for time in times)
    )
    assert pair.lines(expected, actual) == [
        (
            f"{topic}[128] t=12.400 s entities[0].arrows[0].pose.position.z: "
            "expected 0.0213, got 0.0231 (|d| 0.0018)"
        )
    ]


def test_one_message_fewer_and_one_more(pair: Pair) -> None:
    payloads = [load_with_force(i / 3) for i in range(100)]
    messages = [("/a", i, data) for i, data in enumerate(payloads)]
    whole = recording({"/a": JSON}, *messages)
    part = recording({"/a": JSON}, *(m for m in messages if m[1] != 42))
    assert pair.lines(whole, part) == ["/a[42] t=0.042 s: missing"]
    assert counts(tally(pair.compare(), "/a")) == (100, 99, 99, 0, 0, 1, 0)
    assert pair.lines(part, whole) == ["/a[42] t=0.042 s: extra"]
    assert counts(tally(pair.compare(), "/a")) == (99, 100, 99, 0, 0, 0, 1)
    assert pair.compare().verdict == "different: 1 extra, of 1 topics and 99 messages"


def test_one_message_more_at_the_same_time(pair: Pair) -> None:
    expected = recording({"/a": JSON}, ("/a", 0, b"1"), ("/a", 1, b"1"), ("/a", 1, b"2"))
    actual = recording({"/a": JSON}, ("/a", 0, b"1"), ("/a", 1, b"1"))
    assert pair.lines(expected, actual) == ["/a[2] t=0.001 s: missing"]


def test_swapped_messages(pair: Pair) -> None:
    one, other = load_with_force(1.0), load_with_force(2.0)
    assert pair.lines(one_topic(JSON, one, one, other), one_topic(JSON, one, other, one)) == [
        "/a[1] t=0.001 s force[0]: expected 1.0, got 2.0 (|d| 1)",
        "/a[2] t=0.002 s force[0]: expected 2.0, got 1.0 (|d| 1)",
    ]
    same_time = [("/a", 5, one), ("/a", 5, other)]
    expected = recording({"/a": JSON}, *same_time)
    assert len(pair.lines(expected, recording({"/a": JSON}, *reversed(same_time)))) == 2


def test_the_order_among_topics_and_times_does_not_matter(pair: Pair) -> None:
    whole = mixed()
    by_topic = sorted(whole.messages, key=lambda message: message.topic)
    backwards = sorted(whole.messages, key=lambda message: -message.time)
    for messages in (by_topic, backwards):
        assert not pair.lines(whole, replace(whole, messages=messages))


@pytest.mark.parametrize("version", [1, 2])
def test_a_renamed_frame(pair: Pair, version: int) -> None:
    kind = ros_kind(version)
    expected = one_topic(kind, odometry(version), odometry(version))
    actual = one_topic(kind, odometry(version), odometry(version, frame="/world"))
    assert pair.lines(expected, actual) == [
        '/a[1] t=0.001 s header.frame_id: expected "world", got "/world"'
    ]


def test_nan_equals_nan_only(pair: Pair) -> None:
    odd_nan = struct.unpack("<d", struct.pack("<Q", 0xFFF8000000000123))[0]
    kind = ros_kind(1)
    expected = one_topic(kind, odometry(1, (math.nan, 0.0, 0.0), covariance=math.nan))
    actual = one_topic(kind, odometry(1, (odd_nan, 0.0, 0.0), covariance=odd_nan))
    assert not pair.lines(expected, actual)
    assert counts(tally(pair.compare(), "/a")) == (1, 1, 1, 0, 0, 0, 0)
    assert pair.lines(expected, one_topic(kind, odometry(1, covariance=math.nan))) == [
        "/a[0] t=0.000 s pose.pose.position.x: expected nan, got 1.0",
        "/a[0] t=0.000 s pose.pose.position.y: expected 0.0, got 2.0 (|d| 2)",
        "/a[0] t=0.000 s pose.pose.position.z: expected 0.0, got 3.0 (|d| 3)",
    ]


@pytest.mark.parametrize("version", [1, 2])
def test_quaternions_of_the_other_sign_are_the_same(pair: Pair, version: int) -> None:
    expected = one_topic(ros_kind(version), odometry(version, orientation=(0.6, 0.0, 0.0, 0.8)))
    actual = one_topic(ros_kind(version), odometry(version, orientation=(-0.6, 0.0, 0.0, -0.8)))
    assert not pair.lines(expected, actual)
    assert counts(tally(pair.compare(), "/a")) == (1, 1, 0, 1, 0, 0, 0)
    assert not pair.lines(one_topic(SCENE, scene()), one_topic(SCENE, scene(sign=-1.0)))


def test_unknown_encodings_are_compared_as_bytes(pair: Pair) -> None:
    expected = one_topic(RAW, b"abc", b"abc", b"abc")
    assert not pair.lines(expected, expected)
    assert not tally(pair.compare(), "/a").note
    assert pair.lines(expected, one_topic(RAW, b"abc", b"abx", b"ab")) == [
        "/a[1] t=0.001 s payload[2]: expected 0x63, got 0x78",
        "/a[2] t=0.002 s payload: expected 3 bytes, got 2 bytes",
    ]
    assert tally(pair.compare(), "/a").note == (
        "compared as bytes: the encoding 'cbor' is not known"
    )


@pytest.mark.parametrize("encoding", WITH_NUMBER)
def test_messages_that_cannot_be_decoded_are_compared_as_bytes(pair: Pair, encoding: str) -> None:
    kind, make, _ = WITH_NUMBER[encoding]
    sound = make(1.0)
    assert pair.lines(one_topic(kind, sound), one_topic(kind, sound[:-1])) == [
        f"/a[0] t=0.000 s payload: expected {len(sound)} bytes, got {len(sound) - 1} bytes"
    ]
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: not ")


@pytest.mark.parametrize("encoding", ["ros1", "cdr", "protobuf"])
def test_broken_definitions_mean_comparing_bytes(pair: Pair, encoding: str) -> None:
    kind, make, _ = WITH_NUMBER[encoding]
    broken = replace(kind, schema=b"\xff( no definition")
    expected, actual = one_topic(broken, make(1.0)), one_topic(broken, make(2.0))
    assert not pair.lines(expected, expected)
    assert len(pair.lines(expected, actual)) == 1
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: the definition of ")


def test_what_a_protobuf_message_leaves_out_is_told_from_its_default(pair: Pair) -> None:
    def update(*, with_pose: bool) -> bytes:
        message: Any = SceneUpdate()
        arrow = message.entities.add().arrows.add()
        if with_pose:
            arrow.pose.SetInParent()
        data: bytes = message.SerializeToString()
        return data

    lines = pair.lines(
        one_topic(SCENE, update(with_pose=True)), one_topic(SCENE, update(with_pose=False))
    )
    assert lines == [
        (
            '/a[0] t=0.000 s entities[0].arrows[0].pose: expected {"position": null, '
            '"orientation": null}, got null'
        )
    ]


def test_protobuf_fields_that_the_definition_lacks_count_too(pair: Pair) -> None:
    unknown = bytes([(100 << 3) & 0x7F | 0x80, (100 << 3) >> 7, 7])
    lines = pair.lines(one_topic(SCENE, scene()), one_topic(SCENE, scene() + unknown))
    assert lines == [
        (
            "/a[0] t=0.000 s (unknown fields): expected nothing, got "
            '[{"number": 100, "wire_type": 0, "data": 7}]'
        )
    ]


def test_a_protobuf_message_written_in_another_way_is_equal(pair: Pair) -> None:
    padded = scene(entity="a").replace(b"\x1a\x01a", b"\x1a\x81\x00a", 1)
    assert padded != scene(entity="a")
    # The entity has become a byte longer.
    padded = padded[:1] + bytes([len(padded) - 2]) + padded[2:]
    assert not pair.lines(one_topic(SCENE, scene(entity="a")), one_topic(SCENE, padded))
    assert counts(tally(pair.compare(), "/a"))[2] == 1


def test_json_fields(pair: Pair) -> None:
    expected = one_topic(JSON, b'{"a": [1, {"b": null}], "c": "x", "d": 1}')
    actual = one_topic(JSON, b'{"c": "y", "a": [1.0, {"b": false}], "e": 1}')
    assert pair.lines(expected, actual) == [
        "/a[0] t=0.000 s a[1].b: expected null, got false",
        '/a[0] t=0.000 s c: expected "x", got "y"',
        "/a[0] t=0.000 s d: expected 1, got nothing",
        "/a[0] t=0.000 s e: expected nothing, got 1",
    ]


def test_json_that_is_nested_too_deeply_is_compared_as_bytes(pair: Pair) -> None:
    expected, actual = (b"[" * 700 + number + b"]" * 700 for number in (b"1", b"2"))
    assert pair.lines(one_topic(JSON, expected), one_topic(JSON, actual)) == [
        "/a[0] t=0.000 s payload[700]: expected 0x31, got 0x32"
    ]
    assert tally(pair.compare(), "/a").note.endswith("a message is nested too deeply")


def test_definitions_are_compared_by_what_they_say(pair: Pair) -> None:
    kind = ros_kind(1)
    commented = replace(kind, schema=b"# a comment\n" + kind.schema.replace(b"\n", b"\r\n"))
    expected = one_topic(kind, odometry(1))
    assert not pair.lines(expected, one_topic(commented, odometry(1)))

    turned = replace(SCENE, schema=file_set(SceneUpdate.DESCRIPTOR.file, last_first=True))
    assert turned.schema != SCENE.schema
    assert not pair.lines(one_topic(SCENE, scene()), one_topic(turned, scene(sign=-1.0)))

    spaced = replace(JSON, schema=b'{ "type" : "object" }')
    assert not pair.lines(one_topic(JSON, b"1"), one_topic(spaced, b"1"))


def test_another_definition_is_named_once(pair: Pair) -> None:
    kind = ros_kind(1)
    renamed = replace(kind, schema=kind.schema.replace(b"child_frame_id", b"other_frame_id"))
    expected = one_topic(kind, *[odometry(1)] * 100)
    assert pair.lines(expected, one_topic(renamed, *[odometry(1)] * 100)) == [
        (
            '/a schema.nav_msgs/msg/Odometry[1]: expected "string child_frame_id", '
            'got "string other_frame_id"'
        )
    ]
    assert counts(tally(pair.compare(), "/a")) == (100, 100, 100, 0, 0, 0, 0)
    assert tally(pair.compare(), "/a").faults == 1

    other = replace(JSON, schema=b'{"type": "array"}')
    assert pair.lines(one_topic(JSON, b"1"), one_topic(other, b"1")) == [
        '/a schema.type: expected "object", got "array"'
    ]
    other = replace(RAW, schema=b"thing = bool")
    assert pair.lines(one_topic(RAW, b"1"), one_topic(other, b"1")) == [
        "/a schema: expected 11 bytes, got 12 bytes"
    ]
    without = Kind("json")
    assert pair.lines(one_topic(without, b"1"), one_topic(without, b"1")) == []


def test_each_side_is_decoded_by_its_own_definition(pair: Pair) -> None:
    kind = ros_kind(1)
    renamed = replace(kind, schema=kind.schema.replace(b"child_frame_id", b"other_frame_id"))
    lines = pair.lines(one_topic(kind, odometry(1)), one_topic(renamed, odometry(1, frame="w")))
    assert lines[1:] == [
        '/a[0] t=0.000 s header.frame_id: expected "world", got "w"',
        '/a[0] t=0.000 s child_frame_id: expected "base_link", got nothing',
        '/a[0] t=0.000 s other_frame_id: expected nothing, got "base_link"',
    ]


def test_another_type_or_encoding_is_named_once(pair: Pair) -> None:
    expected = one_topic(ros_kind(1), *[odometry(1)] * 100)
    actual = one_topic(SCENE, *[scene()] * 100)
    assert pair.lines(expected, actual) == [
        "/a type: expected nav_msgs/Odometry, got foxglove.SceneUpdate",
        "/a encoding: expected ros1, got protobuf",
    ]
    assert counts(tally(pair.compare(), "/a")) == (100, 100, 0, 0, 100, 0, 0)


def test_a_topic_that_only_one_has_is_named_once(pair: Pair) -> None:
    both = recording({"/a": JSON, "/b": JSON}, *(("/a", i, b"1") for i in range(5)))
    one = recording({"/a": JSON}, *(("/a", i, b"1") for i in range(5)))
    assert pair.lines(both, one) == ["/b: the topic is missing (0 messages)"]
    none = recording({"/b": JSON})
    assert pair.lines(none, both) == ["/a: the topic is extra (5 messages)"]
    assert counts(tally(pair.compare(), "/a")) == (0, 5, 0, 0, 0, 0, 5)
    assert tally(pair.compare(), "/a").summary("messages") == "/a: is extra (5 messages)"


def test_several_senders_of_a_topic_are_one_topic(pair: Pair) -> None:
    def write(path: Path, *, second: str | None, publish: str) -> None:
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start("", "")
            schema = writer.register_schema("Load", "jsonschema", b"{}")
            one = writer.register_channel("/a", "json", schema, {"callerid": "one"})
            other = one
            if second is not None:
                other = writer.register_channel("/a", second, schema, {"callerid": "other"})
            for time in range(10):
                writer.add_message(other if time % 2 else one, time, publish.encode(), time)
            writer.finish()

    write(pair.expected, second="json", publish="1")
    write(pair.actual, second=None, publish="1")
    assert pair.compare().exit_code == 0
    write(pair.actual, second="cbor", publish="1")
    result = pair.compare()
    assert [d.line for d in result.differences] == ["/a encoding: expected json, got cbor, json"]
    assert counts(tally(result, "/a")) == (10, 10, 5, 0, 5, 0, 0)


def test_publish_times_count_unless_ignored(pair: Pair) -> None:
    expected = Recording({"/a": JSON}, [Message("/a", START, b"1", START)])
    actual = Recording({"/a": JSON}, [Message("/a", START, b"1", START + 1)])
    assert pair.lines(expected, actual) == [
        f"/a[0] t=0.000 s publish_time: expected {START}, got {START + 1}"
    ]
    assert not pair.lines(expected, actual, CompareOptions(ignore=("publish_time",)))


def test_ignored_and_chosen_topics_and_fields(pair: Pair) -> None:
    kinds = {"/a": JSON, "/b": JSON, "/c": JSON}
    expected = recording(kinds, *((t, 0, b'{"x": 1, "h": {"s": 1}}') for t in kinds))
    actual = recording(kinds, *((t, 0, b'{"x": 2, "h": {"s": 2}}') for t in kinds))

    def left(**options: tuple[str, ...]) -> list[str]:
        lines = pair.lines(expected, actual, CompareOptions(**options))  # type: ignore[arg-type]
        return [line.partition(":")[0].replace("[0] t=0.000 s", "") for line in lines]

    assert left() == ["/a x", "/a h.s", "/b x", "/b h.s", "/c x", "/c h.s"]
    assert left(topics=("/[ab]",)) == ["/a x", "/a h.s", "/b x", "/b h.s"]
    assert left(ignore=("/a", "h")) == ["/b x", "/c x"]
    assert left(ignore=("/a:*", "/[bc]:h.*")) == ["/b x", "/c x"]
    with pytest.raises(CallError, match="--ignore leaves no topic to compare: /"):
        pair.compare(CompareOptions(ignore=("/*",)))
    with pytest.raises(CallError, match="neither file has a topic like /x, /y"):
        pair.compare(CompareOptions(topics=("/x", "/y")))


def test_records_beside_the_messages(pair: Pair) -> None:
    expected = mixed()
    other_version = {"dogbot_logtool": {"version": "2", "style": "force"}}
    assert not pair.lines(expected, replace(expected, metadata=other_version))
    changed = replace(
        expected,
        metadata={"dogbot_logtool": {"style": "classic"}, "more": {"a": "b"}},
        attachments={"notes": b"dry floor"},
        profile="",
    )
    lines = pair.lines(expected, changed)
    assert [line.partition(": ")[0] for line in lines] == [
        "(records) profile",
        "(records) metadata:dogbot_logtool.style",
        "(records) attachment:notes.sha256",
        "(records) metadata:more",
    ]
    assert lines[1].endswith('expected "force", got "classic"')
    everything = ("profile", "metadata:*", "attachment:notes")
    assert not pair.lines(expected, changed, CompareOptions(ignore=everything))
    assert not pair.lines(expected, changed, CompareOptions(topics=("/*",)))


def test_all_differences_are_counted_and_the_first_are_kept(pair: Pair) -> None:
    kinds = {"/a": JSON, "/b": JSON}
    expected = recording(kinds, *((t, i, b"[0, 0]") for i in range(50) for t in kinds))
    actual = recording(kinds, *((t, i, b"[1, 2]") for i in range(50) for t in kinds))
    pair.write(expected, actual)
    for limit in (0, 1, 5, 1000):
        result = pair.compare(CompareOptions(max_differences=limit))
        assert len(result.differences) == min(limit, 200)
        assert (result.difference_count, result.exit_code) == (200, 1)
    result = pair.compare(CompareOptions(max_differences=5))
    assert [(d.topic, d.index, d.path) for d in result.differences] == [
        ("/a", 0, "[0]"),
        ("/a", 0, "[1]"),
        ("/b", 0, "[0]"),
        ("/b", 0, "[1]"),
        ("/a", 1, "[0]"),
    ]


def test_empty_logs_are_the_same(pair: Pair) -> None:
    nothing = Recording({}, [])
    assert not pair.lines(nothing, nothing)
    assert pair.compare().verdict == "same: 0 topics, 0 messages"
    assert pair.compare().warnings == ("neither file has any messages to compare",)


def test_damage_is_reported_and_the_rest_compared(pair: Pair, tmp_path: Path) -> None:
    whole = one_topic(RAW, *(bytes([i]) * 1000 for i in range(200)))
    whole.write(pair.expected, Packing(CompressionType.NONE, 20_000))
    data = bytearray(pair.expected.read_bytes())
    place = data.index(bytes([150]) * 1000)
    # The records of one chunk no longer fit together from here on.
    data[place - 31 : place - 23] = b"\xff" * 8
    pair.actual.write_bytes(data)
    result = pair.compare()
    assert {found.path for found in result.losses} == {pair.actual}
    missing = tally(result, "/a").missing
    assert 0 < missing < 30
    assert counts(tally(result, "/a")) == (200, 200 - missing, 200 - missing, 0, 0, missing, 0)
    assert result.exit_code == 1
    assert "damaged" in result.verdict

    result = compare(pair.actual, pair.actual, CompareOptions())
    assert (result.same, result.exit_code) == (True, 3)
    assert result.verdict.endswith("damaged: what is lost was not compared")

    cut = tmp_path / "cut.mcap"
    cut.write_bytes(pair.expected.read_bytes()[:100_000])
    result = compare(pair.expected, cut, CompareOptions())
    assert result.exit_code == 1
    assert result.losses
    assert tally(result, "/a").missing == 200 - tally(result, "/a").actual


def test_an_index_with_untrue_times_does_not_hide_messages(pair: Pair) -> None:
    whole = one_topic(RAW, *(bytes([i]) * 1000 for i in range(200)))
    packing = Packing(CompressionType.NONE, 20_000)
    whole.write(pair.expected, packing)
    changed = replace(whole.messages[150], data=b"x")
    messages = [*whole.messages[:150], changed, *whole.messages[151:]]
    replace(whole, messages=messages).write(pair.actual, packing)
    for path in (pair.expected, pair.actual):
        data = path.read_bytes()
        with_index = open_log(path)
        chunk = next(c for c in with_index.chunks if (c.end_time or 0) >= changed.time)
        times = struct.pack("<QQ", chunk.start_time, chunk.end_time)
        with_index.close()
        # In the chunk's header, and in the index of chunks.
        path.write_bytes(data.replace(times, struct.pack("<QQ", START, START)))
    result = pair.compare()
    assert [d.index for d in result.differences] == [150]
    assert counts(tally(result, "/a")) == (200, 200, 199, 0, 1, 0, 0)


def windows_of(log: Log, window_size: int, *, measured: bool) -> list[list[tuple[int, bytes]]]:
    """Times and payloads of the messages, window by window."""
    topic_of = {channel.id: 0 for channel in log.channels.values() if channel.topic != "/b"}
    track = (measured_track if measured else indexed_track)(log, topic_of)
    windows: list[list[tuple[int, bytes]]] = []
    for window in plan_windows([track], window_size):
        block = load(track, window)
        messages = block.messages
        windows.append(
            [
                (time, block.buffer[start:end].tobytes())
                for time, start, end in zip(
                    messages.log_time.tolist(),
                    messages.start.tolist(),
                    messages.end.tolist(),
                    strict=True,
                )
            ]
        )
    return windows


def test_times_may_lie_as_far_apart_as_they_can(pair: Pair) -> None:
    times = [*range(100), 2**61, 2**62 + 1, 2**62 + 2, 2**63 - 2, 2**63 - 1]
    whole = Recording({"/a": RAW}, [Message("/a", time, bytes(300_000)) for time in times])
    other = replace(whole, messages=[*whole.messages[:-1], Message("/a", times[-1], b"x")])
    whole.write(pair.expected, Packing(CompressionType.NONE, 1))
    other.write(pair.actual)
    result = pair.compare()
    assert [d.index for d in result.differences] == [104]
    assert counts(tally(result, "/a")) == (105, 105, 104, 0, 1, 0, 0)


def test_messages_of_one_time_stay_together(pair: Pair) -> None:
    payloads = [struct.pack("<Q", i) * 10_000 for i in range(300)]
    messages = [Message("/a", START, data) for data in payloads]
    whole = Recording({"/a": RAW}, messages)
    whole.write(pair.expected, Packing(chunk_size=1))
    replace(whole, messages=[*messages[1:], messages[0]]).write(pair.actual)
    assert counts(tally(pair.compare(), "/a")) == (300, 300, 0, 0, 300, 0, 0)


def shuffled(messages: Iterable[Message]) -> list[Message]:
    mixed_up = list(messages)
    random.Random(5).shuffle(mixed_up)  # noqa: S311 - no cryptography
    return mixed_up


@pytest.mark.parametrize("measured", [False, True])
@pytest.mark.parametrize("order", [list, shuffled, reversed])
def test_windows_hold_each_message_once_and_are_small(
    tmp_path: Path, order: Any, *, measured: bool
) -> None:
    numbered = [("/b" if i % 3 == 0 else "/a", i, struct.pack("<Q", i) * 20) for i in range(1000)]
    whole = recording({"/a": RAW, "/b": RAW}, *numbered)
    whole = replace(whole, messages=list(order(whole.messages)))
    packing = Packing(CompressionType.ZSTD, 1000)
    log = open_log(whole.write(tmp_path / "log.mcap", packing))
    windows = windows_of(log, 20_000, measured=measured)
    log.close()
    expected = [(m.time, m.data) for m in whole.messages if m.topic == "/a"]
    assert sorted(one for window in windows for one in window) == sorted(expected)
    assert len(windows) >= 8
    for earlier, later in pairwise(windows):
        assert max(earlier)[0] < min(later)[0]
    # What the chunks' times tell is less where they overlap, but still bounds a window.
    assert max(sum(len(data) for _, data in window) for window in windows) < 2 * 20_000


def test_memory_does_not_grow_with_the_file(pair: Pair) -> None:
    payloads = [struct.pack("<Q", i) * 12_500 for i in range(400)]
    one_topic(RAW, *payloads).write(pair.expected)
    payloads[399] += b"x"
    one_topic(RAW, *payloads).write(pair.actual, Packing(CompressionType.LZ4, 300_000))
    tracemalloc.start()
    result = pair.compare()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [d.index for d in result.differences] == [399]
    assert sum(len(data) for data in payloads) == 40_000_001
    assert peak < 35_000_000


@pytest.mark.parametrize("seed", range(20))
def test_counts_agree_with_a_naive_pairing(pair: Pair, seed: int) -> None:
    chance = random.Random(seed)  # noqa: S311 - no cryptography
    kinds = dict.fromkeys(("/a", "/b", "/c"), RAW)

    def messages() -> list[tuple[str, int, bytes]]:
        return [
            (chance.choice(sorted(kinds)), chance.randrange(8), chance.choice([b"", b"x", b"yz"]))
            for _ in range(chance.randrange(60))
        ]

    sides = [messages(), messages()]
    for path, side in zip((pair.expected, pair.actual), sides, strict=True):
        recording(kinds, *side).write(path, Packing(chunk_size=chance.choice([50, 5000])))
    result = pair.compare(CompareOptions(max_differences=1000))

    places = [by_place(side) for side in sides]
    wanted: dict[str, Counter[str]] = defaultdict(Counter)
    for key in places[0].keys() | places[1].keys():
        if key not in places[1]:
            wanted[key[0]]["missing"] += 1
        elif key not in places[0]:
            wanted[key[0]]["extra"] += 1
        else:
            wanted[key[0]]["equal" if places[0][key] == places[1][key] else "different"] += 1
    for topic in kinds:
        one = tally(result, topic)
        found = {"equal": one.equal, "different": one.different}
        found |= {"missing": one.missing, "extra": one.extra}
        assert {name: count for name, count in found.items() if count} == wanted[topic]
    assert result.difference_count == len(result.differences)


def by_place(messages: Iterable[tuple[str, int, bytes]]) -> dict[tuple[str, int, int], bytes]:
    seen: Counter[tuple[str, int]] = Counter()
    places: dict[tuple[str, int, int], bytes] = {}
    for topic, time, data in messages:
        places[topic, time, seen[topic, time]] = data
        seen[topic, time] += 1
    return places
