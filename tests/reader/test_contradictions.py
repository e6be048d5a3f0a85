"""Logs whose summary or index says otherwise than their data: said, and the data is believed."""

import struct
from collections import Counter
from pathlib import Path

import pytest

from dogbot_logtool.reader.opening import open_log
from tests.reader.bag_bytes import CODECS as BAG_CODECS
from tests.reader.bag_bytes import SECOND, Connection, small_bag, time
from tests.reader.mcap_bytes import (
    CODECS,
    McapBytes,
    attachment,
    channel,
    resealed,
    schema,
    small_mcap,
)
from tests.reader.reading import Reading, read_bytes, written_bag, written_mcap

DESCRIBED = schema(1) + channel(1, "/left") + channel(2, "/right")
SWAPPED = schema(1) + channel(1, "/right") + channel(2, "/left")


def read_without_summary(folder: Path, mcap: McapBytes) -> Reading:
    plain = McapBytes(mcap.chunks, mcap.topics, mcap.compression)
    plain.described_later, plain.between = mcap.described_later, mcap.between
    plain.summary = False
    return read_bytes(folder, plain.build())


def counted(reading: Reading) -> dict[str, int]:
    return dict(Counter(message.topic for message in reading.messages))


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("message_index", [False, True])
def test_channels_swapped_in_the_summary(
    tmp_path: Path, compression: str, *, message_index: bool
) -> None:
    mcap = small_mcap(compression)
    mcap.message_index = message_index
    mcap.described_in_summary = SWAPPED
    reading = read_bytes(tmp_path, mcap.build())
    assert list(reading.messages) == written_mcap(mcap)
    for number, data, summary in ((1, "/left", "/right"), (2, "/right", "/left")):
        what = f"channel {number} is described in two ways: as {data} and, at byte "
        assert what in reading.sentences
        assert f"as {summary}; the former was used" in reading.sentences


@pytest.mark.parametrize(
    ("described", "what"),
    [
        (schema(1, data=b"string data\nbool more"), "schema 1 is described in two ways: as std_ms"),
        (schema(1, "std_msgs/Empty"), "as std_msgs/String and, at byte "),
        (channel(1, "/other"), "channel 1 is described in two ways: as /left and, at byte "),
        (schema(2) + channel(1, "/left", 2), "as /left with schema 1 and, at byte "),
        (channel(2, "/left") + channel(1, "/right"), "channel 2 is described in two ways"),
    ],
)
@pytest.mark.parametrize("where", ["in a chunk", "between chunks"])
@pytest.mark.parametrize("message_index", [False, True])
def test_a_description_that_changes_in_mid_file(
    tmp_path: Path, described: bytes, what: str, where: str, *, message_index: bool
) -> None:
    mcap = small_mcap()
    mcap.message_index = message_index
    later = {2: described}
    mcap.described_later = later if where == "in a chunk" else {}
    mcap.between = later if where == "between chunks" else {}
    # As a library writes it, that keeps the last description.
    for in_summary in (DESCRIBED, DESCRIBED + described, described + DESCRIBED):
        mcap.chunk_starts.clear()
        mcap.described_in_summary = in_summary
        reading = read_bytes(tmp_path, mcap.build())
        assert what in reading.sentences
        assert reading.messages == read_without_summary(tmp_path, mcap).messages
        assert list(reading.messages) == written_mcap(mcap)


def test_a_contradiction_names_its_chunk(tmp_path: Path) -> None:
    mcap = small_mcap()
    mcap.described_later = {2: channel(1, "/other")}
    mcap.described_in_summary = DESCRIBED
    reading = read_bytes(tmp_path, mcap.build())
    place = mcap.chunk_starts[2]
    assert reading.sentences == (
        f"channel 1 is described in two ways: as /left and, at byte {place}, as /other; "
        "the former was used"
    )
    assert [loss.offset for loss in reading.losses] == [place]
    assert [chunk.whole for chunk in reading.chunks] == [True, True, False]


def test_descriptions_that_are_repeated_are_no_contradiction(tmp_path: Path) -> None:
    mcap = small_mcap()
    mcap.described_later = dict.fromkeys((1, 2), DESCRIBED)
    mcap.between = dict.fromkeys((0, 1, 2), DESCRIBED)
    reading = read_bytes(tmp_path, mcap.build())
    assert list(reading.messages) == written_mcap(mcap)
    assert not reading.losses


@pytest.mark.parametrize("message_index", [False, True])
def test_a_channel_that_the_summary_leaves_out(tmp_path: Path, *, message_index: bool) -> None:
    mcap = small_mcap()
    mcap.message_index = message_index
    mcap.described_in_summary = schema(1) + channel(1, "/left")
    mcap.stated_counts = {1: 12}
    reading = read_bytes(tmp_path, mcap.build())
    assert list(reading.messages) == written_mcap(mcap)
    assert reading.losses


@pytest.mark.parametrize("stated", [{1: 5, 2: 7}, {1: 12}, {1: 6, 2: 900}, {1: 6, 2: 6, 3: 1}])
def test_wrong_statistics_are_said_and_not_repeated(tmp_path: Path, stated: dict[int, int]) -> None:
    mcap = small_mcap()
    mcap.stated_counts = stated
    reading = read_bytes(tmp_path, mcap.build())
    assert list(reading.messages) == written_mcap(mcap)
    assert reading.counts == {"/left": 6, "/right": 6}
    assert "the summary counts" in reading.sentences


def test_message_counts_that_hold_only_in_sum(tmp_path: Path) -> None:
    """The chunk index tells the channels' places the wrong way round, in two chunks."""
    mcap = small_mcap(chunks=2, each=3)
    data = mcap.build()
    for row in range(2):
        first = mcap.chunk_ends[row]
        size = int.from_bytes(data[first + 1 : first + 9], "little") + 9
        places = [struct.pack("<Q", first), struct.pack("<Q", first + size)]
        at = [data.rindex(place) for place in places]
        for where, place in zip(at, reversed(places), strict=True):
            data = data[:where] + place + data[where + 8 :]
    assert counted(read_bytes(tmp_path, data)) == {"/left": 3, "/right": 3}
    reading = read_bytes(tmp_path, resealed(data, mcap))
    assert list(reading.messages) == written_mcap(mcap)
    assert f"the chunk at byte {mcap.chunk_starts[0]} holds 2 messages of channel 1 " in (
        reading.sentences
    )


@pytest.mark.parametrize("shift", [-(10**9), 10**9])
@pytest.mark.parametrize("field", ["start", "end"])
def test_wrong_times_in_the_statistics(tmp_path: Path, shift: int, field: str) -> None:
    mcap = small_mcap()
    data = mcap.build()
    times = [m.log_time for m in written_mcap(mcap)]
    true = min(times) if field == "start" else max(times)
    at = data.rindex(struct.pack("<Q", true))
    reading = read_bytes(
        tmp_path, resealed(data[:at] + struct.pack("<Q", true + shift) + data[at + 8 :], mcap)
    )
    assert reading.times == (min(times), max(times))
    assert reading.losses


def test_a_time_span_has_all_its_messages_whatever_the_chunk_index_says(tmp_path: Path) -> None:
    mcap = small_mcap()
    data = mcap.build()
    times = [message.log_time for message in mcap.chunks[1]]
    at = data.rindex(struct.pack("<QQ", times[0], times[-1]))
    assert at > mcap.summary_start
    wrong = struct.pack("<QQ", times[0] - 30_000_000, times[-1] - 40_000_000)
    path = tmp_path / "log.mcap"
    path.write_bytes(resealed(data[:at] + wrong + data[at + 16 :], mcap))
    log = open_log(path)
    batches = [log.read(span).cropped(times[0], times[-1]) for span in log.spans(*times[::3])]
    log.close()
    assert [each for batch in batches for each in batch.messages.log_time.tolist()] == times
    assert [loss.offset for batch in batches for loss in batch.losses]


@pytest.mark.parametrize("crc", [True, False])
@pytest.mark.parametrize(
    ("compression", "named"), [("zstd", ""), ("zstd", "lz4"), ("zstd", "none"), ("", "lz4")]
)
def test_chunk_indexes_that_name_another_compression(
    tmp_path: Path, compression: str, named: str, *, crc: bool
) -> None:
    mcap = small_mcap(compression)
    mcap.chunk_crc, mcap.indexed_as = crc, named
    reading = read_bytes(tmp_path, mcap.build())
    assert list(reading.messages) == written_mcap(mcap)
    assert reading.losses
    # Where the wrong name would move the data behind the chunk's end, the summary is not used.
    for start in mcap.chunk_starts if compression else ():
        what = f"wrong about the compression or size of the chunk at byte {start}; the chunk's own"
        assert what in reading.sentences
    assert all(loss.messages == 0 for loss in reading.losses)


@pytest.mark.parametrize("compression", CODECS)
@pytest.mark.parametrize("field", ["stored size", "size"])
@pytest.mark.parametrize("wrong", [0, 1, 50, 2**40])
def test_a_chunk_index_with_a_wrong_size(
    tmp_path: Path, compression: str, field: str, wrong: int
) -> None:
    mcap = small_mcap(compression)
    data = mcap.build()
    start = mcap.chunk_starts[1]
    at = data.index(struct.pack("<Q", start), mcap.summary_start)
    (offsets,) = struct.unpack_from("<I", data, at + 16)
    sizes = at + 20 + offsets + 8 + 4 + len(compression) + (8 if field == "size" else 0)
    changed = data[:sizes] + struct.pack("<Q", wrong) + data[sizes + 8 :]
    reading = read_bytes(tmp_path, resealed(changed, mcap))
    assert list(reading.messages) == written_mcap(mcap)
    assert reading.losses


def test_an_attachment_that_the_summary_does_not_name(tmp_path: Path) -> None:
    extra = attachment("notes", b"muddy ground")
    mcap = small_mcap()
    mcap.between = {1: extra}
    data = mcap.build()
    reading = read_bytes(tmp_path, data)
    assert [data[e.offset : e.offset + e.size] for e in reading.extras] == [extra]
    assert list(reading.messages) == written_mcap(mcap)
    assert "the summary contradicts itself or the chunks" in reading.sentences


BAG_DESCRIBED = [Connection(0, "/left"), Connection(1, "/right")]


@pytest.mark.parametrize("compression", BAG_CODECS)
def test_connections_swapped_in_a_bags_index(tmp_path: Path, compression: str) -> None:
    bag = small_bag(compression)
    bag.in_index_section = [Connection(0, "/right"), Connection(1, "/left")]
    reading = read_bytes(tmp_path, bag.build())
    place = bag.chunk_starts[0]
    assert reading.sentences == "; ".join(
        f"connection {number} is described in two ways: as {one} of type std_msgs/String and, at "
        f"byte {place}, as {other} of type std_msgs/String; the former was used"
        for number, one, other in ((0, "/right", "/left"), (1, "/left", "/right"))
    )


@pytest.mark.parametrize(
    "connection",
    [
        Connection(0, "/other"),
        Connection(0, "/left", "std_msgs/Empty"),
        Connection(0, "/left", definition="string data\nbool more\n"),
    ],
)
@pytest.mark.parametrize("indexed", [False, True])
def test_a_connection_that_changes_in_mid_file(
    tmp_path: Path, connection: Connection, *, indexed: bool
) -> None:
    bag = small_bag()
    bag.described_later = {2: connection.record()}
    bag.indexed = indexed
    reading = read_bytes(tmp_path, bag.build())
    assert list(reading.messages) == written_bag(bag)
    assert "connection 0 is described in two ways: as /left of type" in reading.sentences
    if indexed:
        bag = small_bag()
        bag.in_index_section = [*BAG_DESCRIBED, connection]
        reading = read_bytes(tmp_path, bag.build())
        assert list(reading.messages) == written_bag(bag)
        assert "it describes a connection in two ways" in reading.sentences


def test_message_counts_of_a_bag_that_hold_only_in_sum(tmp_path: Path) -> None:
    bag = small_bag(chunks=2, each=3)
    data = bag.build()
    for right, wrong in (((0, 2, 1, 1), (0, 1, 1, 2)), ((1, 2, 0, 1), (1, 1, 0, 2))):
        stated = struct.pack("<4I", *right)
        assert data.count(stated) == 1
        data = data.replace(stated, struct.pack("<4I", *wrong))
    reading = read_bytes(tmp_path, data)
    assert list(reading.messages) == written_bag(bag)
    what = f"the chunk at byte {bag.chunk_starts[0]} holds 2 messages of channel 0 where the log's"
    assert what in reading.sentences


@pytest.mark.parametrize("compression", BAG_CODECS)
def test_a_time_span_has_all_its_messages_whatever_a_bags_index_says(
    tmp_path: Path, compression: str
) -> None:
    bag = small_bag(compression)
    data = bag.build()
    times = [message.log_time for message in bag.chunks[1]]
    for name, true, wrong in (
        (b"start_time=", times[0], times[0] - 30_000_000),
        (b"end_time=", times[-1], times[0] - 20_000_000),
    ):
        assert data.count(name + time(true)) == 1
        data = data.replace(name + time(true), name + time(wrong))
    path = tmp_path / "log.bag"
    path.write_bytes(data)
    log = open_log(path)
    batches = [log.read(span).cropped(times[0], times[-1]) for span in log.spans(*times[::3])]
    losses = [*log.losses, *(loss for batch in batches for loss in batch.losses)]
    log.close()
    assert [each for batch in batches for each in batch.messages.log_time.tolist()] == times
    assert losses


@pytest.mark.parametrize("shift", [-SECOND, SECOND])
@pytest.mark.parametrize(("chunk", "field"), [(0, "start_time"), (2, "end_time")])
def test_wrong_first_and_last_times_in_a_bags_index(
    tmp_path: Path, chunk: int, field: str, shift: int
) -> None:
    bag = small_bag()
    data = bag.build()
    times = [message.log_time for messages in bag.chunks for message in messages]
    mine = [message.log_time for message in bag.chunks[chunk]]
    true = mine[0] if field == "start_time" else mine[-1]
    name = field.encode() + b"="
    reading = read_bytes(tmp_path, data.replace(name + time(true), name + time(true + shift)))
    assert reading.times == (min(times), max(times))
    assert list(reading.messages) == written_bag(bag)
    assert reading.losses
