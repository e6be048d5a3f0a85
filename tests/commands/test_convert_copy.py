"""The recorded messages, chunks, attachments and metadata in a converted log."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.writer.chunks import Compression
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.commands.conversions import COMPRESSIONS, chunks_of, converted, opening_of
from tests.oracles import base_walks
from tests.oracles.annotated_file import ENCODED, described_robots, read_written
from tests.oracles.recorded import (
    DESCRIPTION,
    FEET,
    Recorded,
    arrow_topic,
    label_topic,
    load_topic,
    read_log,
)
from tests.oracles.ros1_logs import small_walk, write_ros1_mcap
from tests.oracles.small_logs import CONTACTS, first_seconds, write_log
from tests.paths import TROT, TROUBLED, WALK
from tests.reader.mcap_bytes import CHUNK, DATA_END, FOOTER, MAGIC, record, text

COPIES: list[tuple[Path, Compression | None, str]] = [
    (TROUBLED, "zstd", "ros1"),
    (TROUBLED, "lz4", "ros1"),
    (WALK, None, "ros2"),
]


def rows(log: Path, profile: str) -> Counter[Recorded]:
    """The messages of a log or an output; rosbags names the types of ROS 1 as those of ROS 2."""
    found = read_log(log)
    if profile == "ros1":
        found = [replace(one, type_name=one.type_name.replace("/msg/", "/")) for one in found]
    return Counter(found)


@pytest.mark.parametrize(
    ("log", "compression", "profile"), COPIES, ids=[f"{log.stem}-{c}" for log, c, _ in COPIES]
)
def test_recorded_messages_are_copied_byte_for_byte(
    log: Path, compression: Compression | None, profile: str
) -> None:
    done = converted(log, compression=compression)
    assert rows(log, profile) <= rows(done.path, profile)
    annotated = sum(done.conversion.annotations.values())
    assert done.conversion.copied == len(read_log(log)) == len(done.written.messages) - annotated
    assert described_robots(done.written) == [(opening_of(log), "dogbot")]
    name = "" if compression == "none" else (compression or "zstd")
    assert set(done.written.chunk_compressions) == {name}
    assert done.written.profile == profile


@pytest.mark.parametrize(
    ("compression", "encoding"), list(zip(COMPRESSIONS, ENCODINGS, strict=True))
)
def test_without_copy_there_are_annotations_only(compression: Compression, encoding: str) -> None:
    log = first_seconds(TROUBLED)
    looks = {"compression": compression, "encoding": encoding}
    done, encoded = converted(log, copy=False, **looks), ENCODED[encoding]
    topics = {"/tf", "/support", "/events", "/gait"}
    topics |= {topic(foot) for topic in (arrow_topic, load_topic, label_topic) for foot in FEET}
    written = done.written
    assert written.topics.keys() - {"/events/spans"} == topics | {DESCRIPTION}
    assert {each for topic in topics for each in written.encodings(topic)} == {encoded}
    assert written.encodings(DESCRIPTION) == {"ros1" if encoding == "ros1" else "cdr"}
    assert described_robots(written) == [(opening_of(log), "dogbot")]
    assert written.profile == ("" if encoding == "foxglove" else encoding)
    assert done.conversion.copied == 0
    with_copy = converted(log, **looks).written
    for topic in topics - {"/tf"}:
        alone = [m.data for _, m in written.of(topic, encoded)]
        assert alone == [m.data for _, m in with_copy.of(topic, encoded)]


def test_chunks_of_an_mcap_are_copied_as_they_stand() -> None:
    recorded, done = chunks_of(WALK), converted(WALK)
    written = chunks_of(done.path)
    assert [chunk for chunk in written if chunk in recorded] == recorded
    assert done.written.statistics is not None
    assert done.written.statistics.chunk_count == len(written) > len(recorded)
    assert len(done.written.chunk_compressions) == len(written)


def test_output_has_chunks_of_about_a_megabyte() -> None:
    chunks = chunks_of(converted(TROT).path)
    assert all(chunk.uncompressed_crc for chunk in chunks)
    sizes = [chunk.uncompressed_size for chunk in chunks]
    assert max(sizes) < (1 << 20) + 10_000
    assert sum(sizes) / len(sizes) > 1 << 18


def test_mcap_extras_are_copied_with_the_messages(tmp_path: Path) -> None:
    log, target = tmp_path / "log.mcap", tmp_path / "out.mcap"
    write_ros1_mcap(log, small_walk(), extras=True)
    convert(log, target, ConvertOptions(compression="none"))
    recorded, written = read_written(log), read_written(target)
    assert written.attachments == recorded.attachments
    assert len(written.attachments) == 2
    assert written.metadata[:-1] == recorded.metadata
    with target.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert list(reader.iter_attachments()) == recorded.attachments
        assert list(reader.iter_metadata()) == written.metadata
    own = [c for c in written.channels.values() if c.metadata == {"callerid": "/tests"}]
    assert len(own) == 2
    assert {m.sequence for m in written.messages} == {0, 3}
    convert(log, target, ConvertOptions(copy=False, overwrite=True))
    written = read_written(target)
    assert written.attachments == []
    assert [metadata.name for metadata in written.metadata] == ["dogbot_logtool"]


def test_a_chunk_without_messages(tmp_path: Path) -> None:
    """One before every chunk, and one behind them, in a file without an index."""
    log, target = tmp_path / "log.mcap", tmp_path / "out.mcap"
    write_ros1_mcap(log, small_walk(0.2), compression=CompressionType.NONE, chunk_size=10_000)
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    data, data_end = log.read_bytes(), record(DATA_END, bytes(4))
    starts = [index.chunk_start_offset for index in summary.chunk_indexes]
    parts = pairwise([0, *starts, data.rindex(data_end[:9])])
    empty = record(CHUNK, bytes(28) + text("") + bytes(8))
    body = b"".join(data[start:end] + empty for start, end in parts)
    log.write_bytes(body + data_end + record(FOOTER, bytes(20)) + MAGIC)
    done = convert(log, target, ConvertOptions())
    assert (done.damage.exit_code, done.copied) == (0, 100)
    assert len(read_written(target).messages) == 100 + sum(done.annotations.values())


def test_metadata_that_is_no_text_is_copied_byte_for_byte(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert b"weather" in data
    log.write_bytes(data.replace(b"weather", b"w\xffather"))
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert not [loss for loss in conversion.damage.losses if "metadata" in loss.what]
    assert b"w\xffather" in (tmp_path / "out.mcap").read_bytes()


# --- Chosen topics --------------------------------------------------------------------------------

CONTACT_TOPICS = {"/feet/left/contact": CONTACTS, "/feet/right/contact": CONTACTS}


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    return write_log(tmp_path / "walk.mcap", CONTACT_TOPICS, odometry=["/odom"], samples=200)


@pytest.mark.parametrize(
    ("topics", "copied", "said"),
    [
        (("!/feet/*",), {"/odom"}, "400 messages of topics left out of the copy: /feet/left/con"),
        (("/odom", "/feet/*", "!*/right/*"), {"/odom", "/feet/left/contact"}, "200 messages of"),
        (("!/camera/*",), {"/odom", *CONTACT_TOPICS}, "--topics !/camera/* fits no topic of the"),
    ],
)
def test_topics_are_left_out_and_annotations_stay(
    walk: Path, tmp_path: Path, topics: tuple[str, ...], copied: set[str], said: str
) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    convert(walk, whole, ConvertOptions())
    done = convert(walk, part, ConvertOptions(topics=topics))
    written = read_written(part)
    missing = {"/odom", *CONTACT_TOPICS} - copied
    expected = {name: n for name, n in read_written(whole).topics.items() if name not in missing}
    assert written.topics == expected
    assert done.copied == 200 * len(copied)
    (text,) = [finding.text for finding in done.findings if finding.code == "COPY"]
    assert text.startswith(said)
    told = written.metadata[-1].metadata
    named = [told.get("topics", ""), *(f"!{each}" for each in told.get("without", "").split())]
    assert " ".join(named).split() == [*topics]


def test_transforms_that_are_left_out_are_written_anew(tmp_path: Path) -> None:
    path = base_walks.write(tmp_path / "walk.mcap", "tf2_msgs/TFMessage", "/tf")
    done = convert(path, tmp_path / "part.mcap", ConvertOptions(topics=("!/tf",)))
    assert done.annotations["/tf"] > 100
