"""Messages compared by their definitions, in every encoding, and as bytes without."""

import time
from dataclasses import replace
from typing import Any

import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from tests.comparison.pairs import Pair, counts, tally
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    WITH_NUMBER,
    Kind,
    file_set,
    odometry,
    one_topic,
    ros_kind,
    scene,
)


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


def test_a_broken_definition_is_parsed_once(pair: Pair) -> None:
    kind = replace(ros_kind(1), schema=ros_kind(1).schema + b"\nMSG: a/B\n" + b"Unknown y\n" * 3000)
    sides = [one_topic(kind, *(bytes([i % 256, by]) for i in range(3000))) for by in (1, 2)]
    pair.write(*sides)
    start = time.monotonic()
    assert counts(tally(pair.compare(), "/a")) == (3000, 3000, 0, 0, 3000, 0, 0)
    assert time.monotonic() - start < 10.0


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
    expected, actual = (b"[" * 990 + number + b"]" * 990 for number in (b"1", b"2"))
    assert pair.lines(one_topic(JSON, expected), one_topic(JSON, actual)) == [
        "/a[0] t=0.000 s payload[990]: expected 0x31, got 0x32"
    ]
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: ")


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
