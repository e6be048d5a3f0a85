"""Logs that were annotated before: what was added is left out, what was recorded is used."""

import json
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Metadata
from mcap.writer import Writer

import dogbot_logtool as dl
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, WALK
from tests.paths import TROUBLED as LONG
from tests.shell import Shell

TROUBLED = first_seconds(LONG)
Once = Callable[[Path, str], tuple[Path, Conversion]]


@pytest.fixture(scope="module")
def once_annotated(tmp_path_factory: pytest.TempPathFactory) -> Once:
    """Return what annotates a log in an encoding, once for all tests that only read the file."""

    @cache
    def annotate(log: Path, encoding: str) -> tuple[Path, Conversion]:
        target = tmp_path_factory.mktemp("annotated") / "once.mcap"
        return target, dl.convert(log, target, encoding=encoding)

    return annotate


def same(expected: Path, actual: Path) -> bool:
    return dl.compare(expected, actual).exit_code == 0


def channels(log: Path) -> list[Channel]:
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return list(summary.channels.values())


def records(log: Path) -> list[Metadata]:
    with log.open("rb") as stream:
        return list(make_reader(stream).iter_metadata())


def check_again(once: Path, first: Conversion, again: Path, encoding: str) -> Conversion:
    """Annotate a log that is annotated, and check that the same comes out."""
    second = dl.convert(once, again, encoding=encoding)
    assert (second.copied, second.annotations) == (first.copied, first.annotations)
    assert "ANNOTATED" in {finding.code for finding in second.findings}
    return second


@pytest.mark.parametrize(
    ("log", "encoding"),
    [*((TROUBLED, encoding) for encoding in ENCODINGS), (WALK, "ros2"), (TROT, "ros1")],
    ids=lambda each: each.name if isinstance(each, Path) else each,
)
def test_annotating_again_gives_the_same(
    tmp_path: Path, once_annotated: Once, log: Path, encoding: str
) -> None:
    (once, first), again = once_annotated(log, encoding), tmp_path / "again.mcap"
    check_again(once, first, again, encoding)
    # A log that is no MCAP has chunks of its own kind.
    assert log is not WALK or once.read_bytes() == again.read_bytes()
    assert same(once, again)
    assert len(channels(again)) == len(channels(once))
    assert [record.name for record in records(again)] == ["dogbot_logtool"]
    dl.convert(again, tmp_path / "third.mcap", encoding=encoding)
    # Chunks that hold only what was recorded are copied as they stand.
    assert (tmp_path / "third.mcap").read_bytes() == again.read_bytes()


def repacked(log: Path, target: Path, chunk_size: int = 1 << 20, *, marked: bool = True) -> Path:
    """Write a log anew as another tool would: new ids, all topics in one chunk, maybe unmarked."""
    with log.open("rb") as stream, target.open("wb") as out:
        reader, writer = make_reader(stream), Writer(out, chunk_size=chunk_size)
        writer.start(profile=reader.get_header().profile)
        numbers: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=not marked):
            assert schema is not None
            if channel.id not in numbers:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                marks = channel.metadata if marked else {}
                numbers[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, number, marks
                )
            times = message.publish_time, message.sequence
            writer.add_message(numbers[channel.id], message.log_time, message.data, *times)
        for record in reader.iter_metadata() if marked else ():
            writer.add_metadata(record.name, record.metadata)
        writer.finish()
    return target


@pytest.mark.parametrize("chunk_size", [20_000, 1 << 26], ids=["small", "one chunk"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_chunks_may_hold_both(
    tmp_path: Path, once_annotated: Once, encoding: str, chunk_size: int
) -> None:
    (once, first), again = once_annotated(TROUBLED, encoding), tmp_path / "again.mcap"
    mixed = repacked(once, tmp_path / "mixed.mcap", chunk_size)
    assert not check_again(mixed, first, again, encoding).damage.losses
    assert len(channels(again)) == len(channels(once))
    assert same(once, again)
    log = open_log(mixed)
    found = [chunk.counts.keys() for chunk in log.chunks if chunk.counts]
    log.close()
    ours = {channel.id for channel in channels(mixed) if channel.metadata.get("dogbot_logtool")}
    assert any(ids & ours and ids - ours for ids in found)


def test_a_recorded_topic_that_ours_joins_is_kept(tmp_path: Path) -> None:
    """A live script's arrows have our topics and types; only ours are marked."""
    live, once, again = (tmp_path / f"{name}.mcap" for name in ("live", "once", "again"))
    dl.convert(TROUBLED, live, encoding="ros1", style="classic")
    recorded = repacked(live, tmp_path / "recorded.mcap", marked=False)
    first = dl.convert(recorded, once, encoding="ros1")
    topics = Counter(channel.topic for channel in channels(once))
    assert topics["/marker_basic_front_left_foot"] == 2
    check_again(once, first, again, "ros1")
    assert same(once, again)


def test_a_cut_file_is_told_by_its_marks(tmp_path: Path, once_annotated: Once) -> None:
    """The record that tells how it was made is at the end."""
    once, _ = once_annotated(TROUBLED, "foxglove")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(once.read_bytes()[:-20_000])
    assert dl.convert(cut, tmp_path / "again.mcap").damage.losses
    assert len(channels(tmp_path / "again.mcap")) == len(channels(once))


def test_what_was_lost_and_left_out_before_is_not_forgotten(tmp_path: Path) -> None:
    log, once, again = (tmp_path / name for name in ("cut.bag", "once.mcap", "again.mcap"))
    log.write_bytes(TROUBLED.read_bytes()[:-50_000])
    assert dl.convert(log, once, start=1.0).damage.losses
    assert not dl.convert(once, again).damage.losses
    (record,) = records(again)
    assert record.metadata["damage"]
    assert (record.metadata["input"], record.metadata["start_s"]) == ("cut.bag", "1.0")
    assert same(once, again)
    # A part of an annotated log is a part of that log.
    dl.convert(once, tmp_path / "part.mcap", end=2.0)
    (record,) = records(tmp_path / "part.mcap")
    assert (record.metadata["input"], record.metadata["start_s"]) == ("once.mcap", "")


@pytest.mark.parametrize("command", ["convert", "stats", "report", "layout"])
def test_annotations_alone_are_no_log(shell: Shell, command: str) -> None:
    dl.convert(TROUBLED, shell.folder / "x.mcap", copy=False)
    done = shell(command, "x.mcap")
    assert (done.code, done.out, shell.files()) == (1, "", ["x.mcap"])
    assert "x.mcap: holds only annotations" in done.err
    assert f"use the log that it was made from, {TROUBLED.name}" in done.err


@pytest.mark.parametrize("copy", [True, False])
def test_info_tells_annotations_from_what_was_recorded(shell: Shell, *, copy: bool) -> None:
    done = dl.convert(TROUBLED, shell.folder / "x.mcap", encoding="ros1", copy=copy)
    told = shell("info", "x.mcap", "--json").json
    count = sum(done.annotations.values())
    assert told["messages"] == done.copied + count
    ours = [topic for topic in told["topics"] if topic["use"] == "annotation"]
    names = {topic["topic"] for topic in ours}
    # Where the log has a topic of the same type, ours joins it.
    assert set(done.annotations) - names == ({"/tf"} if copy else set())
    assert sum(topic["messages"] for topic in ours) == sum(done.annotations[n] for n in names)
    (finding,) = (each for each in told["findings"] if each["code"] == "ANNOTATED")
    assert f"its {count:,} annotations are left out" in finding["text"]
    # Frames of annotations are shown, and not heeded.
    plain, both = (shell("info", x, "--frames", "--json").json for x in (TROUBLED, "x.mcap"))
    assert not copy or plain["frames"]["added"] == both["frames"]["added"]
    assert "base_link" in json.dumps(both["frames"])
