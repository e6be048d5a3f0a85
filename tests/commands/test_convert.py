"""Conversion against an oracle that takes one message at a time.

The logs are read with the containers' own libraries and decoded by rosbags with the definitions
that are recorded in them. What should be written is computed in plain Python, a message at a time,
by the formulas of docs/convert.md; what was written is read and decoded by the mcap library and its
decoders, checksums and all. Nothing of the product takes part in either.
"""

import itertools
import json
import math
import multiprocessing
import re
import threading
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import pytest
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.styles import ARROW_STYLES
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.pipeline.options import ConvertOptions, TopicOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.oracles.annotated_file import (
    Written,
    described_robots,
    of_encoding,
    read_written,
    written_arrows,
    written_loads,
    written_poses,
)
from tests.oracles.conversion import (
    LOGS,
    TICK_NS,
    Arrow,
    Load,
    Pose,
    expected_arrows,
    expected_loads,
    expected_poses,
)
from tests.oracles.recorded import (
    CONTACTS_TYPE,
    DESCRIPTION,
    FEET,
    ODOMETRY,
    ODOMETRY_TYPE,
    TEXT_TYPE,
    TF_TYPE,
    S,
    arrow_topic,
    contact_topic,
    label_topic,
    load_topic,
    read_log,
)
from tests.oracles.ros1_logs import (
    HUMBLE,
    Entry,
    contact,
    contacts,
    odd_contacts,
    odometry,
    small_walk,
    text,
    transform,
    write_bag,
    write_ros1_mcap,
)
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, TROUBLED, WALK

IN_WORLD = {TROT: False, WALK: True, TROUBLED: False}
"""Whether wrenches are in the world frame, as the logs' truths say."""

STYLES = tuple(ARROW_STYLES)
COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)


# --- Reading logs ---------------------------------------------------------------------------------


# --- What should be written, a message at a time --------------------------------------------------


# --- What was written -----------------------------------------------------------------------------


def assert_same_arrows(actual: list[Arrow], expected: list[Arrow], *, exactly: bool) -> None:
    rows = [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in actual]
    assert rows == [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in expected]
    for name in ("position", "orientation", "length"):
        told = [getattr(arrow, name) for arrow in actual if arrow.position]
        wanted = [getattr(arrow, name) for arrow in expected if arrow.position]
        if exactly and name != "length":
            np.testing.assert_array_equal(told, wanted)
        else:
            # A length is written as shaft and head, which round; anything else is a sum's order,
            # or the way in which rotations are computed.
            np.testing.assert_allclose(told, wanted, rtol=1e-13, atol=1e-12)
    colours = np.array([arrow.colour for arrow in actual if arrow.position])
    wanted_colours = np.array([arrow.colour for arrow in expected if arrow.position], np.float32)
    if exactly:
        np.testing.assert_array_equal(colours.astype(np.float32), wanted_colours)
    else:
        np.testing.assert_allclose(colours, wanted_colours, rtol=2e-7, atol=1e-7)


def assert_same_loads(actual: list[Load], expected: list[Load], opening: int) -> None:
    """Besides the expected rows there are only the first time's, and those of silences."""
    times = {one.log_time for one in expected}
    extra = [one for one in actual if one.log_time not in times]
    assert all(one.log_time == opening or math.isnan(one.force) for one in extra)
    actual = [one for one in actual if one.log_time in times]
    assert [(one.log_time, one.stamp, one.in_contact) for one in actual] == [
        (one.log_time, one.stamp, one.in_contact) for one in expected
    ]
    for name in ("force", "body_weights"):
        told = [getattr(one, name) for one in actual]
        wanted = [getattr(one, name) for one in expected]
        np.testing.assert_allclose(told, wanted, rtol=1e-13, atol=1e-14)


# --- Converting -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Done:
    conversion: Conversion
    path: Path

    @cached_property
    def written(self) -> Written:
        return read_written(self.path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("converted")


_DONE: dict[tuple[Path, str], Done] = {}


def converted(folder: Path, log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = folder / f"{len(_DONE)}.mcap"
        conversion = convert(log, target, ConvertOptions(**options))
        _DONE[key] = Done(conversion, target)
    return _DONE[key]


def opening_of(log: Path) -> int:
    """The first log time, ns."""
    return min(message.log_time for message in read_log(log))


def assert_same_poses(actual: list[Pose], expected: list[Pose], opening: int) -> None:
    """The first pose also stands at the log's first time, unless it is there already."""
    if expected[0].log_time > opening:
        first = actual.pop(0)
        assert first == replace(expected[0], log_time=opening, stamp=opening)
    assert actual == expected


def codes(conversion: Conversion) -> set[str]:
    return {finding.code for finding in conversion.findings}


MATRIX = [
    (TROUBLED, "classic", "foxglove"),
    (TROUBLED, "pressure", "foxglove"),
    (TROUBLED, "pressure", "ros2"),
    (TROUBLED, "force", "ros1"),
    (TROT, "classic", "ros1"),
    (WALK, "force", "foxglove"),
]


@pytest.mark.parametrize(
    ("log", "style", "encoding"), MATRIX, ids=[f"{p.stem}-{s}-{e}" for p, s, e in MATRIX]
)
def test_annotations_are_what_message_by_message_conversion_gives(
    folder: Path, log: Path, style: str, encoding: str
) -> None:
    done = converted(folder, log, style=style, encoding=encoding)
    assert done.conversion.exit_code == 0
    for foot in FEET:
        arrows = expected_arrows(log, foot, style, in_world=IN_WORLD[log])
        assert_same_arrows(
            written_arrows(done.written, foot, encoding, style),
            arrows,
            exactly=style == "classic",
        )
        loads = written_loads(done.written, foot, encoding)
        assert_same_loads(loads, expected_loads(log, foot), opening_of(log))
        assert done.conversion.annotations[arrow_topic(foot)] == len(arrows)
    # The logs have a /tf of their own; only transforms of its own ROS fit on it.
    joined = encoding == ("ros2" if log == WALK else "ros1")
    topic = "/tf" if joined else "/dogbot_logtool/tf"
    poses = written_poses(done.written, topic, encoding)
    assert_same_poses(poses, expected_poses(log, at_ticks=True), opening_of(log))
    assert ("N_TOPIC_MOVED" in codes(done.conversion)) != joined


def test_lengths_of_classic_markers_are_exact(folder: Path) -> None:
    done = converted(folder, TROT, style="classic", encoding="ros1")
    for foot in FEET:
        told = [a.length for a in written_arrows(done.written, foot, "ros1", "classic")]
        wanted = [a.length for a in expected_arrows(TROT, foot, "classic", in_world=False)]
        np.testing.assert_array_equal(told, wanted)


@pytest.mark.parametrize(
    ("log", "encoding"),
    [(TROUBLED, "ros2"), (TROT, "ros1"), (WALK, "foxglove")],
    ids=lambda each: each.stem if isinstance(each, Path) else each,
)
def test_tf_rate_0_writes_every_pose(folder: Path, log: Path, encoding: str) -> None:
    done = converted(folder, log, tf_rate_hz=0.0, encoding=encoding, copy=False)
    poses = written_poses(done.written, "/tf", encoding)
    assert_same_poses(poses, expected_poses(log, at_ticks=False), opening_of(log))


def test_tf_has_fifty_poses_a_second(folder: Path) -> None:
    poses = written_poses(converted(folder, TROT, copy=False).written, "/tf", "foxglove")
    assert len(poses) == 401
    assert {after.stamp - before.stamp for before, after in pairwise(poses)} == {TICK_NS}


def test_counts_of_what_cannot_be_drawn_are_told(folder: Path) -> None:
    damage = json.loads(TROUBLED.with_suffix(".truth.json").read_text(encoding="utf-8"))["damage"]
    not_finite = sum(
        len(numbers)
        for kind in ("nan_force", "infinite_position")
        for numbers in damage[kind].values()
    )
    counts = converted(folder, TROUBLED).conversion.counts
    assert counts.arrows.not_finite == not_finite
    assert counts.bad_poses == len(damage["zero_quaternion"])
    assert codes(converted(folder, TROUBLED).conversion) >= {"W_NOT_FINITE", "W_BAD_POSES"}


def test_zero_stamps_are_replaced_by_log_times_and_said(folder: Path) -> None:
    done = converted(folder, TROUBLED)
    assert "W_ZERO_STAMPS" in codes(done.conversion)
    loads = written_loads(done.written, "back_left", "foxglove")
    assert all(load.stamp == load.log_time for load in loads)


# --- The copy -------------------------------------------------------------------------------------


def recorded_in(written: Written) -> Counter[tuple[object, ...]]:
    return Counter(
        (
            channel.topic,
            written.schemas[channel.schema_id].name,
            written.schemas[channel.schema_id].data.decode("utf-8", "replace"),
            message.log_time,
            message.publish_time,
            message.sequence,
            message.data,
        )
        for message in written.messages
        if (channel := written.recorded().get(message.channel_id)) is not None
    )


def recorded_by(log: Path) -> Counter[tuple[object, ...]]:
    return Counter(
        (
            one.topic,
            one.type_name if log.suffix == ".mcap" else one.type_name.replace("/msg/", "/"),
            one.definition,
            one.log_time,
            one.publish_time,
            one.sequence,
            one.data,
        )
        for one in read_log(log)
    )


COPIES: list[tuple[Path, Compression | None]] = [
    (TROUBLED, "zstd"),
    (TROUBLED, "none"),
    (TROUBLED, "lz4"),
    (WALK, None),
    (TROT, None),
]


@pytest.mark.parametrize(
    ("log", "compression"), COPIES, ids=[f"{log.stem}-{c}" for log, c in COPIES]
)
def test_recorded_messages_are_copied_byte_for_byte(
    folder: Path, log: Path, compression: Compression | None
) -> None:
    done = converted(folder, log, compression=compression)
    assert recorded_in(done.written) == recorded_by(log)
    assert described_robots(done.written) == [(opening_of(log), "dogbot")]
    assert done.conversion.copied == len(read_log(log))
    name = "" if compression == "none" else (compression or "zstd")
    assert set(done.written.chunk_compressions) == {name}


@pytest.mark.parametrize(
    ("compression", "encoding"), list(zip(COMPRESSIONS, ENCODINGS, strict=True))
)
def test_without_copy_there_are_annotations_only(
    folder: Path, compression: Compression, encoding: str
) -> None:
    log = first_seconds(TROUBLED)
    done = converted(folder, log, copy=False, compression=compression, encoding=encoding)
    topics = {"/tf", "/support"}
    topics |= {topic(foot) for topic in (arrow_topic, load_topic, label_topic) for foot in FEET}
    channels = done.written.channels.values()
    assert {channel.topic for channel in channels} == topics | {DESCRIPTION}
    assert done.written.encodings(DESCRIPTION) == {"ros1" if encoding == "ros1" else "cdr"}
    assert described_robots(done.written) == [(opening_of(log), "dogbot")]
    encodings = {c.message_encoding for c in channels if c.topic != DESCRIPTION}
    assert encodings == {of_encoding(encoding)}
    assert done.written.profile == ("" if encoding == "foxglove" else encoding)
    assert done.conversion.copied == 0
    with_copy = converted(folder, log, compression=compression, encoding=encoding)
    for topic in topics - {"/tf"}:
        alone = [m.data for _, m in done.written.of(topic, of_encoding(encoding))]
        assert alone == [m.data for _, m in with_copy.written.of(topic, of_encoding(encoding))]


def test_profile_of_the_log_is_kept(folder: Path) -> None:
    for log, profile in ((TROT, "ros1"), (WALK, "ros2")):
        with converted(folder, log).path.open("rb") as stream:
            assert make_reader(stream).get_header().profile == profile


def chunks_of(path: Path) -> list[records.Chunk]:
    with path.open("rb") as stream:
        return [
            record
            for record in StreamReader(stream, emit_chunks=True).records
            if isinstance(record, records.Chunk)
        ]


def test_chunks_of_an_mcap_are_copied_as_they_stand(folder: Path) -> None:
    recorded = chunks_of(WALK)
    written = chunks_of(converted(folder, WALK).path)
    kept = [chunk for chunk in written if chunk in recorded]
    assert kept == recorded
    annotated = [chunk for chunk in written if chunk not in recorded]
    assert annotated
    done = converted(folder, WALK)
    assert done.written.statistics is not None
    assert done.written.statistics.chunk_count == len(written)
    assert len(done.written.chunk_compressions) == len(written)


def test_output_has_chunks_of_about_a_megabyte(folder: Path) -> None:
    sizes = [chunk.uncompressed_size for chunk in chunks_of(converted(folder, TROT).path)]
    assert max(sizes) < (1 << 20) + 10_000
    assert sum(sizes) / len(sizes) > 1 << 18


def test_start_and_end_choose_messages_by_log_time(folder: Path) -> None:
    first = min(one.log_time for one in read_log(WALK))
    done = converted(folder, WALK, start_s=2.0005, end_s=4.25)
    start, end = first + 2_000_500_000, first + 4_250_000_000
    wanted = Counter(
        (one.topic, one.log_time, one.data)
        for one in read_log(WALK)
        if start <= one.log_time <= end
    )
    copied = Counter(
        (channel.topic, m.log_time, m.data)
        for m in done.written.messages
        if (channel := done.written.recorded().get(m.channel_id)) is not None
    )
    assert copied == wanted
    assert described_robots(done.written) == [(start, "dogbot")]
    for foot in FEET:
        loads = [one for one in expected_loads(WALK, foot) if start <= one.log_time <= end]
        assert_same_loads(written_loads(done.written, foot, "foxglove"), loads, start)
    poses = [p for p in expected_poses(WALK, at_ticks=False) if start <= p.log_time <= end]
    told = written_poses(done.written, "/dogbot_logtool/tf", "foxglove")
    if poses[0].log_time > start:
        assert told.pop(0) == replace(poses[0], log_time=start, stamp=start)
    assert told[0] == poses[0]
    assert (
        told[1:]
        == [
            pose for pose in expected_poses(WALK, at_ticks=True) if pose.log_time > told[0].log_time
        ][: len(told) - 1]
    )
    assert poses[-1].stamp - told[-1].stamp < TICK_NS


def test_a_time_range_between_two_messages_is_refused(folder: Path) -> None:
    """The range lies inside a chunk, so the chunk is read, but nothing in it is taken."""
    for log in (TROUBLED, WALK):
        times = sorted({one.log_time for one in read_log(log)})
        place = next(n for n in range(100, len(times)) if times[n + 1] - times[n] > 10_000)
        start, end = times[place] - times[0] + 2_000, times[place + 1] - times[0] - 2_000
        with pytest.raises(CallError, match="no message was recorded from"):
            converted(folder, log, start_s=start / S, end_s=end / S)


# --- Logs made here -------------------------------------------------------------------------------


@pytest.mark.parametrize("style", STYLES)
def test_forces_of_all_kinds(tmp_path: Path, style: str) -> None:
    log = write_bag(tmp_path / "odd.bag", odd_contacts())
    options = ConvertOptions(
        style=style, encoding="ros1", wrench_frame="world", topics=TopicOptions(robot="dogbot")
    )
    conversion = convert(log, tmp_path / "out.mcap", options)
    written = read_written(tmp_path / "out.mcap")
    expected = expected_arrows(log, "front_left", style, in_world=True)
    told = written_arrows(written, "front_left", "ros1", style)
    assert_same_arrows(told, expected, exactly=style == "classic")
    if style == "classic":
        np.testing.assert_array_equal([a.length for a in told], [a.length for a in expected])
        counts = conversion.counts.arrows
        assert (counts.overflow, counts.no_position, counts.not_finite) == (1, 1, 0)
        assert "W_OVERFLOW" in codes(conversion)
    else:
        assert conversion.counts.arrows.no_position == 1
        assert conversion.counts.arrows.not_finite == 8


def test_mcap_extras_are_copied(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(), extras=True)
    convert(log, tmp_path / "out.mcap", ConvertOptions())
    recorded, written = read_written(log), read_written(tmp_path / "out.mcap")
    assert written.attachments == recorded.attachments
    assert len(written.attachments) == 2
    assert written.metadata[:-1] == recorded.metadata
    assert written.metadata[-1].name == "dogbot_logtool"
    with (tmp_path / "out.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert list(reader.iter_attachments()) == recorded.attachments
        assert list(reader.iter_metadata()) == written.metadata
    channels = written.recorded().values()
    assert [c.metadata for c in channels] == [{"callerid": "/tests"}] * 2
    assert {m.sequence for m in written.messages} == {0, 3}


@pytest.mark.parametrize("compression", ["none", "zstd"])
def test_a_chunk_without_messages(tmp_path: Path, compression: Compression) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.2), compression=CompressionType.NONE)
    empty = records.Chunk(
        compression="",
        data=b"",
        message_end_time=0,
        message_start_time=0,
        uncompressed_crc=0,
        uncompressed_size=0,
    )
    builder = RecordBuilder()
    pieces = [b"\x89MCAP0\r\n"]
    with log.open("rb") as stream:
        for record in StreamReader(stream, emit_chunks=True).records:
            if isinstance(record, records.DataEnd):
                break
            if isinstance(record, records.Chunk):
                empty.write(builder)
            record.write(builder)
            pieces.append(builder.end())
    empty.write(builder)
    records.DataEnd(0).write(builder)
    records.Footer(0, 0, 0).write(builder)
    log.write_bytes(b"".join([*pieces, builder.end(), b"\x89MCAP0\r\n"]))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(compression=compression))
    assert (conversion.exit_code, conversion.copied) == (0, 100)
    # Besides one of every message: the robot, the first time's load (of the one foot with
    # messages), and labels.
    labels = conversion.annotations[label_topic("front_left")]
    assert 0 < labels <= 10
    written = read_written(tmp_path / "out.mcap")
    assert len(written.messages) == 100 + 120 + 1 + 1 + labels


def test_extras_are_not_copied_without_copy(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(), extras=True)
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    written = read_written(tmp_path / "out.mcap")
    assert written.attachments == []
    assert [metadata.name for metadata in written.metadata] == ["dogbot_logtool"]


def test_metadata_that_is_no_text_is_copied_byte_for_byte(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert b"weather" in data
    log.write_bytes(data.replace(b"weather", b"w\xffather"))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert not [loss for loss in conversion.losses if "metadata" in loss.what]
    assert b"w\xffather" in (tmp_path / "out.mcap").read_bytes()


def test_a_damaged_attachment_is_left_out_and_told(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert data.count(b"here be dragons") == 100
    log.write_bytes(data.replace(b"here be dragons", b"here be unicorn", 1))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    written = read_written(tmp_path / "out.mcap")
    assert [attachment.name for attachment in written.attachments] == ["empty"]
    assert conversion.exit_code == 3
    with pytest.raises(LogError, match="--strict"):
        convert(log, tmp_path / "strict.mcap", ConvertOptions(strict=True))
    assert not (tmp_path / "strict.mcap").exists()


# --- Topic clashes --------------------------------------------------------------------------------


def test_own_tf_joins_the_log_s_where_type_and_encoding_are_the_same(folder: Path) -> None:
    done = converted(folder, TROT, style="classic", encoding="ros1")
    assert done.written.encodings("/tf") == {"ros1"}
    recorded = [one.data for one in read_log(TROT) if one.topic == "/tf"]
    joined = done.written.of("/tf", "ros1")
    assert len(joined) == len(recorded) + 401
    assert {schema.name for schema, _ in joined} == {"tf2_msgs/TFMessage"}
    assert done.conversion.annotations["/tf"] == 401


def test_every_topic_has_one_type_and_encoding(folder: Path) -> None:
    for log, style, encoding in MATRIX:
        with converted(folder, log, style=style, encoding=encoding).path.open("rb") as stream:
            summary = make_reader(stream).get_summary()
        assert summary is not None
        kinds: dict[str, set[tuple[str, str]]] = defaultdict(set)
        for channel in summary.channels.values():
            name = summary.schemas[channel.schema_id].name
            kinds[channel.topic].add((name, channel.message_encoding))
        assert [topic for topic, found in kinds.items() if len(found) > 1] == []


def test_a_topic_that_is_taken_twice_is_moved_twice(tmp_path: Path) -> None:
    taken = (load_topic("front_left"), f"/dogbot_logtool{load_topic('front_left')}")
    entries = [Entry(topic, TEXT_TYPE, 10 * S, text("mine")) for topic in taken]
    log = write_bag(tmp_path / "log.bag", [*entries, *small_walk(0.2)])
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    topic = "/dogbot_logtool/dogbot_logtool/load/front_left"
    assert conversion.annotations[topic] == 51  # with the first time's
    written = read_written(tmp_path / "out.mcap")
    assert {load.in_contact for load in _loads_at(written, topic)} == {True, False}
    (moved,) = [finding for finding in conversion.findings if finding.code == "N_TOPIC_MOVED"]
    assert moved.where == topic
    assert "/load/front_left" in moved.text


def _loads_at(written: Written, topic: str) -> list[Any]:
    return [
        written.decode(schema, message, "protobuf")
        for schema, message in written.of(topic, "protobuf")
    ]


# --- A second parent ------------------------------------------------------------------------------


def walk_with_late_parent(path: Path) -> Path:
    """Write 60 chunks, of which one in the middle says where the base is."""

    def entries() -> Iterator[Entry]:
        for index in range(60):
            time = 10 * S + index * 100_000_000
            yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time))
            state = contact((0.0, 0.0, 50.0))
            yield Entry(contact_topic("front_left"), CONTACTS_TYPE, time + 1, contacts(time, state))
            child = "base_link" if index == 21 else "camera"
            parent = "/map" if index == 21 else "base_link"
            yield Entry("/tf", TF_TYPE, time + 2, transform(time, parent, child))
            yield Entry("/filler", TEXT_TYPE, time + 3, text("-" * 300_000))

    return write_bag(path, entries(), chunk_size=250_000, compressed=True)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_second_parent_that_comes_late_is_noticed(tmp_path: Path, jobs: int) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    target = tmp_path / "out.mcap"
    conversion = convert(log, target, ConvertOptions(jobs=jobs))
    written = read_written(target)
    assert not [topic for topic in conversion.annotations if topic.endswith("/tf")]
    assert {c.message_encoding for c in written.channels.values() if c.topic.endswith("/tf")} == {
        "ros1"
    }
    assert "W_TF_HAS_PARENT" in codes(conversion)
    (finding,) = [f for f in conversion.findings if f.code == "W_TF_HAS_PARENT"]
    assert "base_link a parent (map)" in finding.text
    assert conversion.annotations[arrow_topic("front_left")] == 60
    assert conversion.copied == 240
    assert sorted(file.name for file in tmp_path.iterdir()) == ["log.bag", "out.mcap"]


def test_the_first_attempt_s_workers_are_gone_when_the_second_works(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    workers: set[str] = set()

    def look(_done: int, _total: int) -> None:
        threads = (each.name for each in threading.enumerate() if each.name.startswith("batch"))
        now = {*threads, *(each.name for each in multiprocessing.active_children())}
        assert len(now) <= 2
        workers.update(now)

    convert(log, tmp_path / "out.mcap", ConvertOptions(jobs=2), look)
    assert workers


def test_tf_always_writes_a_second_parent(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(tf="always"))
    assert conversion.annotations["/dogbot_logtool/tf"] == 60
    assert "W_TF_HAS_PARENT" not in codes(conversion)


def test_a_parent_that_is_not_copied_is_no_second_one(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    assert conversion.annotations.get("/tf") == 60


def test_tf_never_writes_none(folder: Path) -> None:
    done = converted(folder, TROUBLED, tf="never", copy=False)
    assert "/tf" not in done.conversion.annotations


# --- What is missing, what is broken --------------------------------------------------------------


def test_feet_only(tmp_path: Path) -> None:
    entries = [entry for entry in small_walk() if entry.topic != ODOMETRY]
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert "W_NO_ODOMETRY" in codes(conversion)
    assert conversion.annotations[arrow_topic("front_left")] == 250
    assert "/tf" not in conversion.annotations
    missing = {f.where for f in conversion.findings if f.code == "W_FOOT_MISSING"}
    assert missing == {contact_topic(foot) for foot in FEET[1:]}


@pytest.mark.parametrize("tf", ["auto", "never"])
def test_odometry_only(tmp_path: Path, tf: Literal["auto", "never"]) -> None:
    entries = [entry for entry in small_walk() if entry.topic == ODOMETRY]
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(tf=tf))
    assert "W_NO_FEET" in codes(conversion)
    assert conversion.annotations == {DESCRIPTION: 1} | ({"/tf": 50} if tf == "auto" else {})
    assert len(read_written(tmp_path / "out.mcap").messages) == (301 if tf == "auto" else 251)


def test_neither_is_an_error_that_lists_what_is_there(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", [Entry("/said", TEXT_TYPE, S, text("hello"))])
    with pytest.raises(LogError, match=r"/said\s+std_msgs/String"):
        convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert not (tmp_path / "out.mcap").exists()


def test_an_empty_log_is_an_error(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", [])
    with pytest.raises(LogError, match="nothing"):
        convert(log, tmp_path / "out.mcap", ConvertOptions())


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_a_malformed_message_costs_one_message(tmp_path: Path, kind: str) -> None:
    entries = list(small_walk())
    broken = next(i for i, e in enumerate(entries) if i > 200 and e.type_name == CONTACTS_TYPE)
    entries[broken] = replace(entries[broken], data=entries[broken].data[:-3])
    write = write_bag if kind == "bag" else write_ros1_mcap
    log = write(tmp_path / f"log.{kind}", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    written = read_written(tmp_path / "out.mcap")
    assert conversion.exit_code == 3
    assert conversion.copied == len(entries)
    assert conversion.annotations[load_topic("front_left")] == 249 + 1
    loads = written_loads(written, "front_left", "foxglove")
    assert [load.log_time for load in loads] == [
        entries[0].log_time,
        *(
            entry.log_time
            for index, entry in enumerate(entries)
            if entry.type_name == CONTACTS_TYPE and index != broken
        ),
    ]
    (loss,) = conversion.losses
    assert contact_topic("front_left") in loss.what
    assert loss.messages == 1
    provenance = written.metadata[-1].metadata
    assert provenance["lost_messages"] == "1"
    assert contact_topic("front_left") in provenance["damage"]
    with pytest.raises(LogError, match="--strict"):
        convert(log, tmp_path / "strict.mcap", ConvertOptions(strict=True))
    assert not (tmp_path / "strict.mcap").exists()


def test_transforms_that_cannot_be_decoded_are_told(tmp_path: Path) -> None:
    """They might have given the base a parent."""
    sent = [10 * S + index * 20_000_000 for index in range(50)]
    frames = [Entry("/tf", TF_TYPE, time, transform(time, "base_link", "leg")) for time in sent]
    frames[30] = replace(frames[30], data=frames[30].data[:-1])
    entries = sorted([*small_walk(), *frames], key=lambda entry: entry.log_time)
    log = write_bag(tmp_path / "log.bag", entries)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert conversion.copied == len(entries)
    (loss,) = conversion.losses
    assert loss.messages == 1
    assert "/tf" in loss.what
    unused = convert(log, tmp_path / "never.mcap", ConvertOptions(tf="never"))
    assert not unused.losses


def test_a_chunk_whose_checksum_fails_is_left_out(tmp_path: Path) -> None:
    log = write_ros1_mcap(
        tmp_path / "log.mcap", small_walk(), compression=CompressionType.NONE, chunk_size=40_000
    )
    count = len(chunks_of(log))
    data = bytearray(log.read_bytes())
    place = data.index(b"ground_plane", len(data) // 2)
    data[place] ^= 1
    log.write_bytes(data)
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(compression="none"))
    assert conversion.exit_code == 3
    (loss,) = conversion.losses
    assert loss.messages
    assert conversion.copied == 500 - loss.messages
    assert "checksum" in loss.what
    written = read_written(tmp_path / "out.mcap")
    assert len(written.messages) == conversion.copied + sum(conversion.annotations.values())
    kept = [c for c in chunks_of(tmp_path / "out.mcap") if c in chunks_of(log)]
    assert len(kept) == count - 1


# --- Sameness -------------------------------------------------------------------------------------


def test_the_same_bytes_whatever_the_jobs(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", _padded_walk(), chunk_size=200_000, compressed=True)
    outputs: set[bytes] = set()
    for number, jobs in enumerate((1, 2, 3, 1)):
        target = tmp_path / f"{number}.mcap"
        convert(log, target, ConvertOptions(jobs=jobs))
        outputs.add(target.read_bytes())
    assert len(outputs) == 1
    written = read_written(tmp_path / "0.mcap")
    assert written_poses(written, "/tf", "foxglove") == expected_poses(log, at_ticks=True)
    expected = expected_arrows(log, "front_left", "pressure", in_world=False)
    assert_same_arrows(
        written_arrows(written, "front_left", "foxglove", "pressure"), expected, exactly=False
    )


def _padded_walk() -> Iterator[Entry]:
    """Yield a walk that fills several batches."""
    for index, entry in enumerate(small_walk(1.5)):
        yield entry
        if index % 10 == 0:
            yield Entry("/filler", TEXT_TYPE, entry.log_time, text("+" * 250_000))


@pytest.mark.parametrize("log", LOGS, ids=lambda log: log.stem)
def test_sample_logs_convert_to_the_same_bytes_whatever_the_jobs(
    folder: Path, tmp_path: Path, log: Path
) -> None:
    options: dict[str, Any] = {"style": "force"} if log == WALK else {}
    target = tmp_path / "out.mcap"
    convert(log, target, ConvertOptions(jobs=3, encoding="foxglove", **options))
    assert (
        target.read_bytes()
        == converted(folder, log, encoding="foxglove", **options).path.read_bytes()
    )


def test_provenance_tells_how_but_not_when_or_where(folder: Path) -> None:
    done = converted(folder, TROUBLED, style="force", encoding="ros1")
    (provenance,) = done.written.metadata
    assert provenance.name == "dogbot_logtool"
    told = provenance.metadata
    assert told["input"] == "dogbot_troubled.bag"
    assert (told["style"], told["encoding"], told["robot"]) == ("force", "ros1", "dogbot")
    assert (told["mass_kg"], told["copy"], told["lost_messages"]) == ("21.261", "True", "0")
    assert not [value for value in told.values() if "/" in value and value.startswith("/")]
    everything = json.dumps(told)
    assert str(TROUBLED.parent) not in everything
    assert str(folder) not in everything
    assert not re.search(r"20\d\d-\d\d|\d\d:\d\d", everything)


def test_the_place_of_the_log_leaves_no_trace(folder: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    copy = elsewhere / TROUBLED.name
    copy.write_bytes(TROUBLED.read_bytes())
    convert(copy, tmp_path / "out.mcap", ConvertOptions())
    assert (tmp_path / "out.mcap").read_bytes() == converted(folder, TROUBLED).path.read_bytes()


def test_the_same_walk_in_two_containers_has_the_same_annotations(
    folder: Path, tmp_path: Path
) -> None:
    trot = first_seconds(TROT)
    entries = [Entry(one.topic, one.type_name, one.log_time, one.data) for one in read_log(trot)]
    log = write_ros1_mcap(tmp_path / "trot.mcap", entries)
    for encoding in ("foxglove", "ros1"):
        convert(log, tmp_path / f"{encoding}.mcap", ConvertOptions(encoding=encoding))
        other = read_written(tmp_path / f"{encoding}.mcap")
        bag = converted(folder, trot, encoding=encoding).written
        for topic in ("/tf", "/dogbot_logtool/tf", *map(arrow_topic, FEET), *map(load_topic, FEET)):
            here, there = (w.of(topic, of_encoding(encoding)) for w in (other, bag))
            assert [(m.log_time, m.data) for _, m in here] == [
                (m.log_time, m.data) for _, m in there
            ]


def test_the_same_walk_of_ros1_and_ros2_has_the_same_annotations(
    folder: Path, tmp_path: Path
) -> None:
    kinds = {ODOMETRY: ODOMETRY_TYPE} | {contact_topic(foot): CONTACTS_TYPE for foot in FEET}
    entries = [
        Entry(
            one.topic,
            one.type_name,
            one.log_time,
            bytes(HUMBLE.cdr_to_ros1(one.data, one.type_name)),
        )
        for one in read_log(WALK)
        if one.topic in kinds
    ]
    # The walk begins with another message, at whose time the first annotations stand.
    entries.insert(0, Entry("/said", TEXT_TYPE, opening_of(WALK), text("go")))
    log = write_bag(tmp_path / "walk.bag", entries)
    convert(log, tmp_path / "out.mcap", ConvertOptions(style="force"))
    ros1 = read_written(tmp_path / "out.mcap")
    ros2 = converted(folder, WALK, style="force", encoding="foxglove").written
    for topic in (*map(arrow_topic, FEET), *map(load_topic, FEET)):
        assert [m.data for _, m in ros1.of(topic, "protobuf")] == [
            m.data for _, m in ros2.of(topic, "protobuf")
        ]
    assert written_poses(ros1, "/tf", "foxglove") == written_poses(
        ros2, "/dogbot_logtool/tf", "foxglove"
    )


# --- Targets --------------------------------------------------------------------------------------


def test_progress_ends_at_the_whole(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    convert(
        TROUBLED,
        tmp_path / "out.mcap",
        ConvertOptions(copy=False),
        lambda done, total: told.append((done, total)),
    )
    assert told[-1][0] == told[-1][1]
    assert told == sorted(told)


# --- An outside checker ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_the_doctor_finds_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    """`pymcap-cli doctor` over all encodings and all compressions, each with both copy modes."""
    from pymcap_cli.cli import app as pymcap_cli  # noqa: PLC0415 - takes long to load

    if kind == "bag":
        log = write_bag(tmp_path / "log.bag", small_walk(0.3))
    else:
        log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.3), extras=True)
    target = tmp_path / "out.mcap"
    encodings = itertools.cycle(ENCODINGS)
    for compression in (*COMPRESSIONS, None):
        for copy in (True, False):
            options = ConvertOptions(
                encoding=next(encodings), compression=compression, copy=copy, overwrite=True
            )
            convert(log, target, options)
            code = pymcap_cli(["doctor", str(target)], result_action="return_value")
            told = capsys.readouterr()
            assert code == 0, told.out + told.err
            assert "passed MCAP doctor checks" in " ".join(told.out.split())
            assert "warning" not in told.out


def test_nothing_but_the_output_is_left(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(jobs=2))
    assert [file.name for file in tmp_path.iterdir()] == ["out.mcap"]
