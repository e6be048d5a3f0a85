"""Logs written by the mcap library and compared: whatever is changed is found, and nothing else."""

import math
import random
import struct
import tracemalloc
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType, IndexType, Writer

import dogbot_logtool as dl
from dogbot_logtool.commands.compare import compare
from dogbot_logtool.options.compare import CompareOptions
from tests.comparison.recordings import (
    JSON,
    RAW,
    START,
    UNINDEXED,
    WITH_NUMBER,
    Message,
    Pair,
    Recording,
    counts,
    mixed,
    odometry,
    one_topic,
    recording,
    ros_kind,
    tally,
)

PACKINGS: list[dict[str, Any]] = [
    {"compression": CompressionType.NONE, "chunk_size": 300},
    {"compression": CompressionType.LZ4, "chunk_size": 5000},
    {"index_types": IndexType.NONE, "chunk_size": 100_000},
    {"compression": CompressionType.LZ4, "chunk_size": 700, **UNINDEXED},
    {"use_chunking": False},
]


@pytest.mark.parametrize("packing", PACKINGS, ids=str)
def test_packing_does_not_matter(pair: Pair, packing: dict[str, Any]) -> None:
    mixed().write(pair.expected)
    mixed().write(pair.actual, **packing)
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
    numbers = [i / 7 for i in range(300)]
    expected = one_topic(kind, *map(make, numbers))
    numbers[234] = math.nextafter(numbers[234], math.inf)
    actual = one_topic(kind, *map(make, numbers))
    before, after = 234 / 7, numbers[234]
    assert pair.lines(expected, actual) == [
        f"/a[234] t=0.234 s {path}: expected {before!r}, got {after!r} (|d| 7.11e-15)"
    ]
    one = tally(pair.compare(), "/a")
    assert counts(one) == (300, 300, 299, 0, 1, 0, 0)
    assert (one.deviation, one.deviation_path) == (after - before, f"[234] {path}")
    for options in (CompareOptions(atol=1e-13), CompareOptions(rtol=1e-15)):
        result = pair.compare(options)
        assert result.exit_code == 0
        assert counts(tally(result, "/a")) == (300, 300, 299, 1, 0, 0, 0)
        assert result.verdict.endswith("1 within tolerance")


def json_log(*messages: tuple[int, str], topics: str = "/a") -> Recording:
    """JSON messages by time, ms; the same on each topic."""
    kinds = dict.fromkeys(topics.split(), JSON)
    return recording(kinds, *((topic, t, data.encode()) for t, data in messages for topic in kinds))


def ros(*messages: bytes) -> Recording:
    return one_topic(ros_kind(1), *messages)


ODD_NAN = struct.unpack("<d", struct.pack("<Q", 0xFFF8000000000123))[0]
FIVE = [(time, "1") for time in range(5)]
THREE = json_log((0, '{"x": 1, "h": {"s": 1}}'), topics="/a /b /c")
CHANGED = json_log((0, '{"x": 2, "h": {"s": 2}}'), topics="/a /b /c")
AT = "[0] t=0.000 s "
PUBLISHED = Recording({"/a": JSON}, [Message("/a", START, b"1", START)])
LATER = Recording({"/a": JSON}, [Message("/a", START, b"1", START + 1)])
NAN = ros(odometry(1, (math.nan, 0.0, 0.0), covariance=math.nan))
PAIRS: dict[str, tuple[Recording, Recording, dict[str, Any], list[str]]] = {
    "one fewer": (json_log(*FIVE), json_log(*FIVE[:2], *FIVE[3:]), {}, [
        "/a[2] t=0.002 s: missing"
    ]),
    "one fewer at the same time": (
        json_log((0, "1"), (1, "1"), (1, "2")), json_log((0, "1"), (1, "1")), {}, [
        "/a[2] t=0.001 s: missing"
    ]),
    "swapped at one time": (
        json_log((5, "1.5"), (5, "2.5")), json_log((5, "2.5"), (5, "1.5")), {}, [
        f"/a{AT.strip()}: expected 1.5, got 2.5 (|d| 1)",
        "/a[1] t=0.000 s: expected 2.5, got 1.5 (|d| 1)",
    ]),
    "a renamed frame": (ros(odometry(1)), ros(odometry(1, frame="/world")), {}, [
        f'/a{AT}header.frame_id: expected "world", got "/world"'
    ]),
    "NaN of another kind": (
        NAN, ros(odometry(1, (ODD_NAN, 0.0, 0.0), covariance=ODD_NAN)), {}, []
    ),
    "NaN and numbers": (NAN, ros(odometry(1, (1.0, 0.0, 0.5), covariance=math.nan)), {}, [
        f"/a{AT}pose.pose.position.x: expected nan, got 1.0",
        f"/a{AT}pose.pose.position.z: expected 0.0, got 0.5 (|d| 0.5)",
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
        f"/a{AT}publish_time: expected {START}, got {START + 1}"
    ]),
    "an ignored publish time": (PUBLISHED, LATER, {"ignore": ["publish_time"]}, []),
    "some topics": (THREE, CHANGED, {"topics": ["/[ab]"], "ignore": ["x"]}, [
        f"/{topic}{AT}h.s: expected 1, got 2" for topic in "ab"
    ]),
    "ignored fields of topics": (THREE, CHANGED, {"ignore": ["/a:*", "/[bc]:h.*"]}, [
        f"/{topic}{AT}x: expected 1, got 2" for topic in "bc"
    ]),
    "empty": (Recording({}, []), Recording({}, []), {}, []),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_what_differs(pair: Pair, name: str) -> None:
    expected, actual, options, lines = PAIRS[name]
    assert pair.lines(expected, actual, CompareOptions(**options)) == lines


def test_messages_are_counted(pair: Pair) -> None:
    found = []
    fewer, more, *_ = PAIRS["one fewer"]
    others = (PAIRS[name][:2] for name in ("turned quaternions", "NaN of another kind"))
    for sides in ((fewer, more), (more, fewer), *others):
        pair.write(*sides)
        found.append(counts(tally(pair.compare(), "/a")))
    assert found == [
        (5, 4, 4, 0, 0, 1, 0),
        (4, 5, 4, 0, 0, 0, 1),
        (1, 1, 0, 1, 0, 0, 0),
        (1, 1, 1, 0, 0, 0, 0),
    ]
    pair.write(more, fewer)
    assert pair.compare().verdict == "different: 1 extra, of 1 topics and 4 messages"
    pair.write(*PAIRS["empty"][:2])
    assert pair.compare().verdict == "same: 0 topics, 0 messages"
    assert pair.compare().warnings == ("neither file has any messages to compare",)
    pair.write(json_log(*FIVE), Recording({}, []))
    result = pair.compare().verdict
    assert result == "different: 5 missing, 1 described differently, of 1 topics and 5 messages"


def test_patterns_that_leave_nothing_are_a_wrong_call(pair: Pair) -> None:
    pair.write(THREE, CHANGED)
    with pytest.raises(dl.CallError, match="--ignore leaves no topic to compare: /"):
        pair.compare(CompareOptions(ignore=("/*",)))
    with pytest.raises(dl.CallError, match="--topics leaves no topic to compare: /x, /y"):
        pair.compare(CompareOptions(topics=("/x", "/y")))


def test_the_order_among_topics_and_times_does_not_matter(pair: Pair) -> None:
    whole = mixed()
    by_topic = sorted(whole.messages, key=lambda message: message.topic)
    backwards = sorted(whole.messages, key=lambda message: -message.time)
    for messages in (by_topic, backwards):
        assert not pair.lines(whole, replace(whole, messages=messages))


def test_several_senders_of_a_topic_are_one_topic(pair: Pair) -> None:
    def write(path: Path, *, second: str | None) -> None:
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start("", "")
            schema = writer.register_schema("Load", "jsonschema", b"{}")
            one = other = writer.register_channel("/a", "json", schema, {"callerid": "one"})
            if second is not None:
                other = writer.register_channel("/a", second, schema, {"callerid": "other"})
            for time in range(10):
                writer.add_message(other if time % 2 else one, time, b"1", time)
            writer.finish()

    write(pair.expected, second="json")
    write(pair.actual, second=None)
    assert pair.compare().exit_code == 0
    write(pair.actual, second="cbor")
    result = pair.compare()
    assert [d.line for d in result.differences] == ["/a encoding: expected json, got cbor, json"]
    assert counts(tally(result, "/a")) == (10, 10, 5, 0, 5, 0, 0)


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
        "(records) attachment:notes.sha256",
        "(records) metadata:dogbot_logtool.style",
        "(records) metadata:more",
    ]
    assert lines[2].endswith('expected "force", got "classic"')
    ours = ("metadata:dogbot_logtool", "metadata:more")
    for everything in (("metadata:*", "profile", "attachment:notes"), ("(records)",)):
        assert not pair.lines(expected, changed, CompareOptions(ignore=everything))
    assert len(pair.lines(expected, changed, CompareOptions(ignore=ours))) == 2
    assert not pair.lines(expected, changed, CompareOptions(topics=("/*",)))


def test_all_differences_are_counted_and_the_first_are_kept(pair: Pair) -> None:
    times = range(50)
    pair.write(*(json_log(*((t, v) for t in times), topics="/a /b") for v in ("[0, 0]", "[1, 2]")))
    for limit in (0, 1, 5, 1000):
        result = pair.compare(CompareOptions(max_differences=limit))
        assert len(result.differences) == min(limit, 200)
        assert (result.difference_count, result.exit_code) == (200, 1)
        found = [f"{d.topic}{d.index}{d.path}" for d in result.differences[:5]]
        assert found == ["/a0[0]", "/a0[1]", "/b0[0]", "/b0[1]", "/a1[0]"][:limit]


def test_damage_is_reported_and_the_rest_compared(pair: Pair, tmp_path: Path) -> None:
    whole = one_topic(RAW, *(bytes([i]) * 1000 for i in range(200)))
    whole.write(pair.expected, compression=CompressionType.NONE, chunk_size=20_000)
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
    assert (result.exit_code, len(result.damage)) == (1, 1)
    assert tally(result, "/a").missing == 200 - tally(result, "/a").actual


@pytest.mark.parametrize("seed", range(5))
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
        recording(kinds, *side).write(path, chunk_size=chance.choice([50, 5000]))
    result = pair.compare(CompareOptions(max_differences=1000))

    one, other = map(by_place, sides)
    wanted: dict[str, Counter[str]] = defaultdict(Counter)
    for key in one.keys() | other.keys():
        both = "equal" if one.get(key) == other.get(key) else "different"
        wanted[key[0]]["missing" if key not in other else "extra" if key not in one else both] += 1
    for topic in kinds:
        found = tally(result, topic)
        numbers = {n: getattr(found, n) for n in ("equal", "different", "missing", "extra")}
        assert {name: count for name, count in numbers.items() if count} == wanted[topic]
    assert result.difference_count == len(result.differences)


def by_place(messages: Iterable[tuple[str, int, bytes]]) -> dict[tuple[str, int, int], bytes]:
    seen: Counter[tuple[str, int]] = Counter()
    places: dict[tuple[str, int, int], bytes] = {}
    for topic, time, data in messages:
        places[topic, time, seen[topic, time]] = data
        seen[topic, time] += 1
    return places


def shuffled(messages: Sequence[Message]) -> list[Message]:
    """Bring the times, each with its messages, into another order."""
    chance = random.Random(5)  # noqa: S311 - no cryptography
    places = {time: chance.random() for time in sorted({each.time for each in messages})}
    return sorted(messages, key=lambda message: places[message.time])


@pytest.mark.parametrize("indexed", [True, False])
def test_memory_does_not_grow_with_the_file(pair: Pair, *, indexed: bool) -> None:
    """Times lie as far apart as they can, and some of them hold more than is read at once."""
    payloads = [struct.pack("<Q", number) * 12_500 for number in range(400)]
    times = [0, START, 2**61, 2**63 - 2, 2**63 - 1]
    messages = [Message("/a", times[n // 80], data) for n, data in enumerate(payloads)]
    whole = Recording({"/a": RAW}, shuffled(messages))
    whole.write(pair.expected, chunk_size=300_000, **({} if indexed else UNINDEXED))
    messages[399] = replace(messages[399], data=payloads[399] + b"x")
    replace(whole, messages=messages).write(pair.actual, chunk_size=300_000)
    tracemalloc.start()
    result = pair.compare()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [each.index for each in result.differences] == [399]
    assert counts(tally(result, "/a")) == (400, 400, 399, 0, 1, 0, 0)
    assert peak < 35_000_000
