"""Logs written by the mcap library and compared: whatever is changed is found, and nothing else."""

import math
import random
import struct
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.writer import CompressionType, IndexType, Writer

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import CompareOptions
from dogbot_logtool.reader.opening import open_log
from tests.comparison.pairs import Pair, counts, tally
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    START,
    WITH_NUMBER,
    Message,
    Packing,
    Recording,
    load_with_force,
    mixed,
    odometry,
    one_topic,
    recording,
    ros_kind,
    scene,
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
    assert (result.exit_code, result.difference_count, result.damage) == (0, 0, [])
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
    assert [found.log for found in result.damage] == [str(pair.actual)]
    missing = tally(result, "/a").missing
    assert 0 < missing < 30
    assert counts(tally(result, "/a")) == (200, 200 - missing, 200 - missing, 0, 0, missing, 0)
    assert result.exit_code == 1
    assert "damaged" in result.verdict

    result = compare(pair.actual, pair.actual, CompareOptions())
    assert (result.same, result.exit_code) == (True, 3)

    cut = tmp_path / "cut.mcap"
    cut.write_bytes(pair.expected.read_bytes()[:100_000])
    result = compare(pair.expected, cut, CompareOptions())
    assert result.exit_code == 1
    assert result.damage
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
