"""Bags and MCAP files that are harmed: what is read, lost and said of each."""

from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest

from dogbot_logtool.reader.containers.log import EarlierAnnotations, wrong_statistics
from dogbot_logtool.reader.opening import open_log
from tests.reader import damaged_bags, damaged_mcaps
from tests.reader.bag_bytes import small_bag, time
from tests.reader.cases import AS_LOST, MCAP, Case, built, put, u64
from tests.reader.mcap_bytes import channel, resealed, small_mcap
from tests.reader.reading import Read, read_bytes

LATEST = 2**63 - 1


@pytest.mark.parametrize(
    "case",
    [*damaged_bags.DAMAGED, *damaged_mcaps.DAMAGED],
    ids=lambda case: f"{type(case.log).__name__} {case.name}",
)
def test_a_damaged_log(tmp_path: Path, case: Case) -> None:
    reading = read_bytes(tmp_path, case.data)
    sent = case.log.written
    got = [message for number, message in enumerate(sent) if number not in case.lost]
    found = list(reading.messages)
    if case.either and found != got:
        assert {(m.log_time, m.payload) for m in got} <= {(m.log_time, m.payload) for m in found}
        assert {(m.log_time, m.payload) for m in found} <= {(m.log_time, m.payload) for m in sent}
    else:
        assert found == got
    assert reading.losses or found == sent
    assert case.says is not None
    assert case.says in reading.sentences
    if case.number is not None:
        assert reading.lost == (len(case.lost) if case.number == AS_LOST else case.number)
    spans = [(loss.start_time, loss.end_time) for loss in reading.losses if loss.messages != 0]
    for number in () if case.either or not spans else case.lost:
        time_ns = min(sent[number].log_time, LATEST)
        assert any((start or 0) <= time_ns <= (end or LATEST) for start, end in spans)
    if case.bytes is not None:
        assert sum(loss.bytes for loss in reading.losses) == case.bytes
    if case.whole is not None:
        assert tuple(chunk.whole for chunk in reading.chunks) == case.whole
    if found == sent and case.index_is_true:
        times = [message.log_time for message in found]
        assert reading.times == (min(times), max(times))
        assert +Counter(reading.counts) == Counter(message.topic for message in found)


def test_a_time_span_has_all_its_messages_whatever_the_index_says(tmp_path: Path) -> None:
    log, data = built(small_bag())
    times = [message.log_time for message in log.chunks[1]]
    for field, true, stated in (
        (b"start_time=", times[0], times[0] - 30_000_000),
        (b"end_time=", times[-1], times[0] - 20_000_000),
    ):
        data = data.replace(field + time(true), field + time(stated))
    path = tmp_path / "log"
    path.write_bytes(data)
    with closing(open_log(path)) as opened:
        batches = [opened.read(span) for span in opened.spans(*times[::3])]
    cropped = [batch.cropped(times[0], times[-1]) for batch in batches]
    assert [each for batch in cropped for each in batch.messages.log_time.tolist()] == times
    assert any(batch.losses for batch in batches)


def test_messages_in_and_outside_chunks(tmp_path: Path) -> None:
    log, data = built(small_mcap(), summary=False, data_crc=False)
    for start in (*log.chunk_starts[:2], log.data_end):
        message = MCAP(1, 7, b"bare").record()
        reading = read_bytes(tmp_path, data[:start] + message + data[start:])
        assert sorted(reading.messages) == sorted([*log.written, Read("/left", 7, b"bare")])
        assert not reading.losses


@pytest.mark.parametrize("name", [b"/\xff\xfe", b"/a\0b", b"", b"/" + b"long" * 10_000])
def test_names_that_are_no_text(tmp_path: Path, name: bytes) -> None:
    log, data = built(small_mcap(), chunked=False, summary=False, data_crc=False)
    reading = read_bytes(tmp_path, data.replace(channel(1, "/left"), channel(1, name)))
    assert [message[1:] for message in reading.messages] == [each[1:] for each in log.written]
    assert not reading.losses
    data = small_bag().build().replace(b"/left", b"/\xff\0\nt")
    reading = read_bytes(tmp_path, data)
    assert sorted(reading.counts.values()) == [6, 6]
    assert not reading.losses


def test_a_chunk_whose_index_names_only_earlier_annotations_is_read(tmp_path: Path) -> None:
    """The index of the second chunk says that its messages of channel 1 are of channel 3."""
    mcap = small_mcap("lz4")
    mcap.topics = {1: "/left", 2: "/annotation", 3: "/other_annotation"}
    mcap.stated_counts = {1: 4, 2: 6, 3: 2}
    data = mcap.build()
    at = data.index(u64(mcap.chunk_starts[1]), mcap.summary_start)
    where = at + 20 if data[at + 20] == 1 else at + 30
    path = tmp_path / "log"
    path.write_bytes(resealed(put(data, where, b"\3"), mcap))
    with closing(open_log(path)) as opened:
        log = opened.without(EarlierAnnotations(frozenset({2, 3})))
        batches = [log.read(span) for span in log.spans()]
    recorded = [each.log_time for chunk in mcap.chunks for each in chunk if each.channel == 1]
    assert [each for batch in batches for each in batch.messages.log_time.tolist()] == recorded
    (loss,) = wrong_statistics(log, {1: len(recorded)}, [])
    assert loss.what == "the log's statistics count 4 messages of /left, but 6 were found"
