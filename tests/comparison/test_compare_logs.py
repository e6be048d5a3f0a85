"""Logs written by the mcap library and compared: whatever is changed is found, and nothing else."""

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

from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    START,
    UNINDEXED,
    Message,
    Recording,
    compared,
    counts,
    lines,
    load,
    odometry,
    one_topic,
    recording,
    ros_kind,
    scene,
)


def mixed(count: int = 50) -> Recording:
    kinds = {"/odom": ros_kind(1), "/scene": SCENE, "/load": JSON, "/raw": RAW, "/silent": JSON}
    messages = [
        message
        for i in range(count)
        for message in (
            ("/odom", i, odometry(1, (float(i), 0.0, 0.0))),
            ("/scene", i, scene(i / 7)),
            ("/scene", i, scene(i / 9)),
            ("/load", i + 1, load(i / 3)),
            ("/raw", 2 * i, bytes(range(i % 7))),
        )
    ]
    metadata = {"dogbot_logtool": {"version": "1", "style": "force"}}
    whole = recording(kinds, *messages)
    return replace(whole, metadata=metadata, attachments={"notes": b"wet floor"})


PACKINGS: list[dict[str, Any]] = [
    {"compression": CompressionType.NONE, "chunk_size": 300},
    {"compression": CompressionType.LZ4, "chunk_size": 5000},
    {"index_types": IndexType.NONE, "chunk_size": 100_000},
    {"compression": CompressionType.LZ4, "chunk_size": 700, **UNINDEXED},
    {"use_chunking": False},
]


@pytest.mark.parametrize("packing", PACKINGS, ids=str)
def test_neither_packing_nor_order_matters(tmp_path: Path, packing: dict[str, Any]) -> None:
    whole = mixed()
    by_topic = sorted(whole.messages, key=lambda message: message[0])
    backwards = sorted(whole.messages, key=lambda message: -message[1])
    for messages in (whole.messages, by_topic, backwards):
        other = replace(whole, messages=messages).write(tmp_path / "other.mcap", **packing)
        result = compared(tmp_path, whole, other)
        assert (result.exit_code, result.difference_count, result.damage) == (0, 0, [])
        assert result.verdict == "same: 5 topics, 250 messages"
        assert counts(result, "/scene") == (100, 100, 100, 0, 0, 0, 0)
        assert counts(result, "/silent") == (0,) * 7


def test_several_senders_of_a_topic_are_one_topic(tmp_path: Path) -> None:
    def write(name: str, *encodings: str) -> Path:
        path = tmp_path / name
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start("", "")
            schema = writer.register_schema("Load", "jsonschema", b"{}")
            channels = [
                writer.register_channel("/a", each, schema, {"callerid": str(number)})
                for number, each in enumerate(encodings)
            ]
            for time in range(10):
                writer.add_message(channels[time % len(channels)], time, b"1", time)
            writer.finish()
        return path

    two, one = write("two", "json", "json"), write("one", "json")
    assert compared(tmp_path, two, one).exit_code == 0
    result = compared(tmp_path, one, write("other", "json", "cbor"))
    assert lines(result) == ["/a encoding: expected json, got cbor, json"]
    assert counts(result) == (10, 10, 5, 0, 5, 0, 0)


def test_records_beside_the_messages(tmp_path: Path) -> None:
    expected = mixed()
    other_version = {"dogbot_logtool": {"version": "2", "style": "force"}}
    assert compared(tmp_path, expected, replace(expected, metadata=other_version)).same
    changed = replace(
        expected,
        metadata={"dogbot_logtool": {"style": "classic"}, "more": {"a": "b"}},
        attachments={"notes": b"dry floor"},
        profile="",
    )
    found = lines(compared(tmp_path, expected, changed))
    assert [line.partition(": ")[0] for line in found] == [
        "(records) profile",
        "(records) attachment:notes.sha256",
        "(records) metadata:dogbot_logtool.style",
        "(records) metadata:more",
    ]
    assert found[2].endswith('expected "force", got "classic"')
    ours = ("metadata:dogbot_logtool", "metadata:more")
    for everything in (("metadata:*", "profile", "attachment:notes"), ("(records)",)):
        assert compared(tmp_path, expected, changed, ignore=everything).same
    assert compared(tmp_path, expected, changed, ignore=ours).difference_count == 2
    assert compared(tmp_path, expected, changed, topics=("/*",)).same


def test_damage_is_reported_and_the_rest_compared(tmp_path: Path) -> None:
    whole = one_topic(RAW, *(bytes([i]) * 1000 for i in range(200)))
    path = whole.write(tmp_path / "x.mcap", compression=CompressionType.NONE, chunk_size=20_000)
    data = bytearray(path.read_bytes())
    place = data.index(bytes([150]) * 1000)
    # The records of one chunk no longer fit together from here on.
    data[place - 31 : place - 23] = b"\xff" * 8
    path.write_bytes(data)
    result = compared(tmp_path, whole, path)
    assert [found.log for found in result.damage] == [str(path)]
    missing = counts(result)[-2]
    assert 0 < missing < 30
    assert counts(result) == (200, 200 - missing, 200 - missing, 0, 0, missing, 0)
    assert result.exit_code == 1
    assert "damaged" in result.verdict


@pytest.mark.parametrize("seed", range(5))
def test_counts_agree_with_a_naive_pairing(tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)  # noqa: S311 - no cryptography
    kinds = dict.fromkeys(("/a", "/b", "/c"), RAW)

    def messages() -> list[tuple[str, int, bytes]]:
        return [
            (chance.choice(sorted(kinds)), chance.randrange(8), chance.choice([b"", b"x", b"yz"]))
            for _ in range(chance.randrange(60))
        ]

    sides = [messages(), messages()]
    paths = [
        recording(kinds, *side).write(tmp_path / f"{n}.mcap", chunk_size=chance.choice([50, 5000]))
        for n, side in enumerate(sides)
    ]
    result = compared(tmp_path, *paths, max_differences=1000)

    one, other = map(by_place, sides)
    wanted: dict[str, Counter[str]] = defaultdict(Counter)
    for key in one.keys() | other.keys():
        both = "equal" if one.get(key) == other.get(key) else "different"
        wanted[key[0]]["missing" if key not in other else "extra" if key not in one else both] += 1
    for topic in kinds:
        _, _, equal, _, different, missing, extra = counts(result, topic)
        found = Counter(equal=equal, different=different, missing=missing, extra=extra)
        assert +found == wanted[topic]
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
    places = {time: chance.random() for time in sorted({each[1] for each in messages})}
    return sorted(messages, key=lambda message: places[message[1]])


@pytest.mark.parametrize("indexed", [True, False])
def test_memory_does_not_grow_with_the_file(tmp_path: Path, *, indexed: bool) -> None:
    """Times lie as far apart as they can, and some of them hold more than is read at once."""
    payloads = [struct.pack("<Q", number) * 12_500 for number in range(400)]
    times = [0, START, 2**61, 2**63 - 2, 2**63 - 1]
    messages = [("/a", times[n // 80], data) for n, data in enumerate(payloads)]
    whole = Recording({"/a": RAW}, shuffled(messages))
    packing = {} if indexed else UNINDEXED
    expected = whole.write(tmp_path / "expected.mcap", chunk_size=300_000, **packing)
    messages[399] = ("/a", times[4], payloads[399] + b"x")
    other = replace(whole, messages=messages)
    actual = other.write(tmp_path / "actual.mcap", chunk_size=300_000)
    tracemalloc.start()
    result = compared(tmp_path, expected, actual)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [each.index for each in result.differences] == [399]
    assert counts(result) == (400, 400, 399, 0, 1, 0, 0)
    assert peak < 35_000_000
