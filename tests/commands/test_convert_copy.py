"""The recorded messages, chunks, attachments and metadata in a converted log."""

from collections import Counter
from pathlib import Path

import pytest
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.writer.chunks import Compression
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.commands.conversions import COMPRESSIONS, chunks_of, converted, opening_of
from tests.oracles.annotated_file import Written, described_robots, of_encoding, read_written
from tests.oracles.recorded import DESCRIPTION, FEET, arrow_topic, label_topic, load_topic, read_log
from tests.oracles.ros1_logs import small_walk, write_ros1_mcap
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, TROUBLED, WALK


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
    topics = {"/tf", "/support", "/events", "/gait"}
    topics |= {topic(foot) for topic in (arrow_topic, load_topic, label_topic) for foot in FEET}
    channels = done.written.channels.values()
    assert {channel.topic for channel in channels} - {"/events/spans"} == topics | {DESCRIPTION}
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
    assert (conversion.damage.exit_code, conversion.copied) == (0, 100)
    # Besides one of every message: the robot, the first time's loads (unknown of the three feet
    # without messages), labels, and what happened.
    labels = conversion.annotations[label_topic("front_left")]
    assert 0 < labels <= 10
    events = sum(conversion.annotations[topic] for topic in ("/events", "/events/spans", "/gait"))
    written = read_written(tmp_path / "out.mcap")
    assert len(written.messages) == 100 + 120 + 1 + 4 + labels + events


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
    assert not [loss for loss in conversion.damage.losses if "metadata" in loss.what]
    assert b"w\xffather" in (tmp_path / "out.mcap").read_bytes()
