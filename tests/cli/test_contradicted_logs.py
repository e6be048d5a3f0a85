"""What the commands make of a log whose summary is not true."""

import io
import json
import struct
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import IndexType, Writer

from tests.forked_cli import run
from tests.paths import SAMPLE_LOGS
from tests.reader.mcap_bytes import CHANNEL, MAGIC, STATISTICS

WALK = SAMPLE_LOGS / "dogbot_walk.mcap"
SECONDS, CHUNK_BYTES = 3, 1 << 18
FEET = ("/dogbot/front_left_contactsensor_state", "/dogbot/front_right_contactsensor_state")


def run_json(*words: object) -> tuple[int, dict[str, Any]]:
    result = run(*words, "--json")
    found: dict[str, Any] = json.loads(result.stdout)
    return result.returncode, found


def with_summary(data: bytes, opcode: int, edit: Callable[[bytes], bytes]) -> bytes:
    """Edit each record of a kind in the summary, in its place; the checksum holds again."""
    footer = len(data) - len(MAGIC) - 29
    (place,) = struct.unpack_from("<Q", data, footer + 9)
    start, section = place, b""
    while place < footer:
        kind, length = struct.unpack_from("<BQ", data, place)
        body = data[place + 9 : place + 9 + length]
        new = edit(body) if kind == opcode else body
        assert len(new) == length
        section += data[place : place + 9] + new
        place += 9 + length
    section += data[footer : footer + 25]
    return data[:start] + section + struct.pack("<I", zlib.crc32(section)) + MAGIC


def swapped_feet(data: bytes) -> bytes:
    """Give each of two feet's channels the number of the other one in the summary."""
    summary = make_reader(io.BytesIO(data)).get_summary()
    assert summary is not None
    ids = {c.topic: struct.pack("<H", number) for number, c in summary.channels.items()}
    other = dict(zip((ids[FEET[0]], ids[FEET[1]]), (ids[FEET[1]], ids[FEET[0]]), strict=True))
    return with_summary(data, CHANNEL, lambda body: other.get(body[:2], body[:2]) + body[2:])


def moved_counts(data: bytes) -> bytes:
    """Count 100 messages of one foot as another one's in the statistics."""
    summary = make_reader(io.BytesIO(data)).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    ids = {c.topic: number for number, c in summary.channels.items()}
    counts = summary.statistics.channel_message_counts
    for topic, by in zip(FEET, (100, -100), strict=True):
        true = struct.pack("<HQ", ids[topic], counts[ids[topic]])
        wrong = struct.pack("<HQ", ids[topic], counts[ids[topic]] + by)
        data = with_summary(data, STATISTICS, _replacing(true, wrong))
    return data


def _replacing(old: bytes, new: bytes) -> Callable[[bytes], bytes]:
    return lambda body: body.replace(old, new)


@cache
def short_walk(*, indexed: bool) -> bytes:
    """The walk's first seconds; without message indexes only the statistics tell of counts."""
    target = io.BytesIO()
    with WALK.open("rb") as source:
        reader = make_reader(source)
        indexes = IndexType.ALL if indexed else IndexType.ALL & ~IndexType.MESSAGE
        writer = Writer(target, CHUNK_BYTES, index_types=indexes)
        writer.start(profile="ros1")
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        end = None
        for schema, channel, message in reader.iter_messages():
            end = end or message.log_time + SECONDS * 10**9
            if message.log_time > end:
                break
            assert schema is not None
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(
                    schema.name, schema.encoding, schema.data
                )
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id]
                )
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time
            )
        writer.finish()
    return target.getvalue()


@pytest.mark.parametrize("indexed", [True, False])
def test_feet_swapped_in_the_summary_are_right_and_said(tmp_path: Path, *, indexed: bool) -> None:
    sound = short_walk(indexed=indexed)
    paths = tmp_path / "sound.mcap", tmp_path / "swapped.mcap"
    for path, data in zip(paths, (sound, swapped_feet(sound)), strict=True):
        path.write_bytes(data)
    true, found = (run_json("stats", path) for path in paths)
    assert (true[0], found[0]) == (0, 3)
    assert true[1]["feet"] == found[1]["feet"]
    damage = run_json("info", paths[1])[1]["damage"]
    for one, other in (FEET, FEET[::-1]):
        assert f"is described in two ways: as {one} and, at byte " in str(damage)
        assert f"as {other}; the former was used" in str(damage)
    assert run("info", paths[1]).returncode == 3
    assert run("convert", paths[1], "-o", tmp_path / "out.mcap").returncode == 3


def test_wrong_statistics_are_said_by_info(tmp_path: Path) -> None:
    path, wrong = tmp_path / "walk.mcap", tmp_path / "wrong.mcap"
    path.write_bytes(short_walk(indexed=True))
    wrong.write_bytes(moved_counts(path.read_bytes()))
    sound, found = run_json("info", path), run_json("info", wrong)
    assert (sound[0], found[0]) == (0, 3)
    assert found[1]["topics"] == sound[1]["topics"]
    assert "the summary counts" in str(found[1]["damage"])


def test_wrong_statistics_without_an_index_are_said_by_those_that_read_all(tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap"
    path.write_bytes(short_walk(indexed=False))
    assert run("stats", path).returncode == 0
    path.write_bytes(moved_counts(path.read_bytes()))
    code, found = run_json("stats", path)
    assert code == 3
    assert "the log's statistics count" in str(found)
    code, found = run_json("convert", path, "-o", tmp_path / "out.mcap")
    assert code == 3
    assert "the log's statistics count" in str(found["damage"])
    assert run("stats", path, "--end", "1").returncode == 0
