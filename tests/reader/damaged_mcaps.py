"""MCAP files that are harmed in one place each."""

from collections.abc import Iterator
from typing import Final

from tests.reader import mcap_bytes
from tests.reader.cases import (
    ANY,
    DESCRIBED,
    MCAP,
    RUBBISH,
    SECOND_CHUNK,
    SWAPPED,
    Case,
    built,
    flipped,
    put,
    u64,
)
from tests.reader.mcap_bytes import (
    McapBytes,
    attachment,
    channel,
    record,
    resealed,
    schema,
    small_mcap,
)


def damaged_mcaps() -> Iterator[Case]:
    mcap, data = built(small_mcap())
    for chunked in (True, False):
        late = McapBytes([[MCAP(1, 5, b"a"), MCAP(1, 2**64 - 1, b"b"), MCAP(2, 9, b"c")]])
        case = built(late, chunked=chunked)
        yield Case("late", *case, "after the year 2262", (1,), whole=(False,))
    for name, harmed in {
        "no end": data[:-1],
        "no footer": data[:-37],
        "damaged footer": put(data, len(data) - 30, b"\xff"),
        "damaged header": put(data, 9, b"\xff"),
        "bytes behind the end": data + b"rubbish",
        "another file behind the end": data + small_mcap(chunks=1).build(),
    }.items():
        yield Case(name, mcap, harmed, ANY, number=None)
    for size in range(8, 40):
        everything = tuple(range(12))
        yield Case(f"{size} bytes", mcap, data[:size], ANY, everything, number=None)
    lone = McapBytes([[MCAP(1, 5, b"a"), MCAP(77, 6, b"bb"), MCAP(2, 7, b"c")]])
    _, data = built(lone, summary=False, chunk_crc=False, data_crc=False)
    lone.topics = {**lone.topics, 77: "/lone"}
    for harmed in (data, flipped(data, lone.chunk_starts[0] + 9, 1)):
        yield Case("undescribed", lone, harmed, "nowhere described", (1,), bytes=2)
    mcap, data = built(small_mcap(""), summary=False, chunk_crc=False, data_crc=False)
    first = mcap.chunks[1][0].record()
    harmed = put(data, data.index(first) + 10, b"\xff")
    yield Case("first of a chunk", mcap, harmed, "the index tells another", (4,), bytes=13)


def mcaps_with_a_wrong_summary() -> Iterator[Case]:
    mcap, data = built(small_mcap())
    for shift in (-1, 1, 20, 1 << 40):
        moved = data
        for place in mcap.chunk_starts:
            moved = put(moved, moved.rindex(u64(place)), u64(place + shift))
        what = "the summary is damaged or wrong"
        yield Case(f"offsets {shift}", mcap, resealed(moved, mcap), what)
    _, short = built(two := small_mcap(chunks=2))
    section = short[two.summary_start :]
    section = put(section, section.rindex(u64(two.summary_start)), u64(mcap.summary_start))
    shorter = resealed(data[: mcap.summary_start] + section, mcap)
    yield Case("unnamed chunk", mcap, shorter, ANY)
    true = mcap.written[0].log_time, mcap.written[-1].log_time
    for each in true:
        for shift in (-(10**9), 10**9):
            wrong = put(data, data.rindex(u64(each)), u64(each + shift))
            yield Case("times in statistics", mcap, resealed(wrong, mcap), ANY)
    for stated in ({1: 5, 2: 7}, {1: 6, 2: 900}, {1: 6, 2: 6, 3: 1}):
        case = built(small_mcap(), stated_counts=stated)
        lost = None if sum(stated.values()) > 12 else 0
        yield Case(f"statistics {stated}", *case, "the summary", number=lost)
    described = schema(1) + channel(1, "/left")
    case = built(small_mcap(), stated_counts={1: 12}, described_in_summary=described)
    yield Case("a channel less", *case, ANY)
    log, data = built(small_mcap(), described_in_summary=SWAPPED)
    what = (
        f"2 is described in two ways: as /left and, at byte {log.chunk_starts[0]}, as /right; the "
    )
    yield Case("swapped", log, data, what, tuple(range(12)), either=True, number=0)
    extra = built(small_mcap(), between={1: attachment("notes", b"muddy ground")})
    yield Case("attachment", *extra, "the summary is damaged or wrong")


def mcaps_described_anew() -> Iterator[Case]:
    """Yield files as libraries write them that keep the last description in the summary, or any."""
    for described in (schema(1, data=b"string data\nbool more"), channel(1, "/o")):
        for known in (DESCRIBED, DESCRIBED + described, described + DESCRIBED, None):
            for where in ("described_later", "between"):
                options = {where: {2: described}, "summary": known is not None}
                case = built(small_mcap(), described_in_summary=known, **options)
                is_in_chunk = where == "described_later" and known == DESCRIBED
                whole = (True, True, False) if is_in_chunk else None
                yield Case("described anew", *case, "1 is described in two ways", whole=whole)


def mcaps_with_damaged_chunks(compression: str) -> Iterator[Case]:
    mcap, data = built(small_mcap(compression), data_crc=False)
    start, end = mcap.chunk_starts[1], mcap.chunk_ends[1]
    middle = (True, False, True)
    for summary in (False, True):
        log, plain = built(small_mcap(compression), data_crc=False, summary=summary)
        what = f"the chunk at byte {start} was left out: its checksum does not hold"
        yield Case("checksum", log, flipped(plain, start + 9 + 24, 1), what, SECOND_CHUNK)
    for field in (0, 1, 9, 17):
        what = f"the header of the chunk at byte {start}"
        yield Case(f"head {field}", mcap, flipped(data, start + field, 2), what, whole=middle)
    for field in (25, 37):
        harmed = flipped(data, start + field, 2)
        yield Case(f"head {field}", mcap, harmed, ANY, SECOND_CHUNK, either=True, number=None)
    for wrong in (0, 1, 50, 2**40):
        log, sealed = built(small_mcap(compression))
        at = sealed.index(u64(start), log.summary_start)
        sizes = at + 20 + int.from_bytes(sealed[at + 16 : at + 20], "little") + 12
        for place in (sizes + len(compression), sizes + len(compression) + 8):
            harmed = resealed(put(sealed, place, u64(wrong)), log)
            yield Case(f"size {wrong} in the summary", log, harmed, ANY)
    what = f"the index of the chunk at byte {start} is wrong; it was read without it"
    yield Case("time in index", mcap, flipped(data, end + 9 + 6, 1), what, whole=middle)
    for offset in (10**6, 2**63 - 1, 2**63, 2**64 - 1):
        yield Case("offset in index", mcap, put(data, end + 9 + 6 + 8, u64(offset)), what)
    for named in ("", "lz4", "none"):
        for crc in (True, False) if named != compression else ():
            case = built(small_mcap(compression), chunk_crc=crc, indexed_as=named)
            yield Case(f"{compression} indexed as {named}", *case, ANY)


def mcaps_with_damaged_records(compression: str) -> Iterator[Case]:
    mcap, data = built(small_mcap(compression), data_crc=False, summary=False)
    start = mcap.chunk_starts[1]
    for place in (0, 1, 3):
        harmed = flipped(data, start + place, 0x11)
        yield Case(f"record {place}", mcap, harmed, ANY, SECOND_CHUNK, either=True, number=None)
    what = "was left out: its lengths contradict each other"
    harmed = put(data, start + 9 + 16, bytes(24 + len(compression)))
    yield Case("nothing in a chunk", mcap, harmed, what, SECOND_CHUNK, number=None)
    for rubbish in RUBBISH:
        harmed = data[:start] + rubbish + data[start:]
        what = f"the {len(rubbish)} bytes from byte {start} on are no record"
        yield Case("rubbish", mcap, harmed, what, number=None, bytes=len(rubbish))


def mcaps_without_chunks() -> Iterator[Case]:
    """Yield files whose messages stand outside of chunks."""
    log, data = built(small_mcap(), chunked=False, summary=False, data_crc=False)
    whole = log.chunks[1][2].record()
    at = data.index(whole)
    for by in (-3, 4, 60, 1 << 20, 1 << 62):
        harmed = put(data, at + 1, u64(len(whole) - 9 + by))
        # A length that no record has is no head, and so the record before it may be too short.
        lost = (5, 6) if by == 1 << 62 else (6,)
        size = len(lost) * len(whole)
        yield Case(f"length {by}", log, harmed, ANY, lost, number=None, bytes=size)
    for opcode in (0x10, 0x7F):
        harmed = data[:at] + record(opcode, b"\xff" * 30) + data[at:]
        # One that no version of MCAP has may be damage.
        yield Case(f"opcode {opcode}", log, harmed, ANY, number=None)
    other = channel(1, "/other")
    yield Case("described anew", log, data[:at] + other + data[at:], "channel 1 is described in tw")
    unknown = schema(1) + channel(1, "/left", 7)
    harmed = data.replace(schema(1) + channel(1, "/left"), unknown)
    yield Case("schema", log, harmed, "schema 7 of /left is nowhere described")
    harmed = data.replace(channel(2, "/right"), b"")
    what = "messages of channels that are nowhere described"
    right = tuple(n for n, message in enumerate(log.written) if message.topic == "/right")
    yield Case("channel", log, harmed, what, right, bytes=6 * 13)


def mcaps_described_late() -> Iterator[Case]:
    """Yield files of messages in front of their channel's description, if there is one."""
    times = range(10**9, 10**9 + 20)
    left, right = ([MCAP(n, t, b"x" * (t % 10)) for t in times[10 * n - 10 :][:10]] for n in (1, 2))
    log = McapBytes([left, right], {1: "/left"}, chunked=False, summary=False, data_crc=False)
    data = log.build()
    log.topics = {1: "/left", 2: "/right"}
    at = data.index(left[5].record())
    data = data[:at] + record(0x80, b"\xff" * 30) + data[at:]  # an application's own record
    end = data.index(right[-1].record()) + len(right[-1].record())
    described = data[:end] + channel(2, "/right") + data[end:]
    yield Case("described late", log, described, ANY, bytes=0)
    what = "10 messages of channels that are nowhere described"
    yield Case("never described", log, data, what, tuple(range(10, 20)))


DAMAGED: Final = (
    *damaged_mcaps(),
    *mcaps_described_anew(),
    *mcaps_described_late(),
    *mcaps_with_a_wrong_summary(),
    *(case for each in mcap_bytes.CODECS for case in mcaps_with_damaged_chunks(each)),
    *(case for each in mcap_bytes.CODECS for case in mcaps_with_damaged_records(each)),
    *mcaps_without_chunks(),
)
