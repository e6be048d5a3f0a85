"""Small logs, ways to harm them, and what must hold for whatever then comes out."""

import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from dogbot_logtool.errors import LogtoolError
from tests.reader import bag_bytes, mcap_bytes
from tests.reader.bag_bytes import BagBytes, small_bag
from tests.reader.cases import Case, built
from tests.reader.mcap_bytes import small_mcap
from tests.reader.reading import Read, Reading, read_bytes

KINDS: Final = ("flip", "set", "delete", "insert", "duplicate", "zero", "truncate")


class Mutation(NamedTuple):
    """One harm, of one of `KINDS`; places and sizes are taken modulo what is there."""

    kind: str
    place: int
    size: int = 1
    value: int = 0

    def apply(self, data: bytes) -> bytes:
        if not data:
            return data
        place, other = self.place % len(data), self.value % len(data)
        size = 1 + self.size % 600
        rubbish = random.Random(self.value).randbytes(size)  # noqa: S311 - not for secrets
        new, removed = {
            "flip": (bytes([data[place] ^ 1 << self.value % 8]), 1),
            "set": (rubbish, size),
            "delete": (b"", size),
            "insert": (rubbish, 0),
            "duplicate": (data[other : other + size], 0),
            "zero": (bytes(size), size),
            "truncate": (b"", len(data)),
        }[self.kind]
        return data[:place] + new + data[place + removed :]


UNCHECKED: Final = ("bag none", "bag none unindexed", "mcap without chunks")
"""Logs in which no checksums vouch for the payloads."""


def cases() -> Iterator[Case]:
    for codec in bag_bytes.CODECS:
        for indexed, end in ((True, ""), (False, " unindexed")):
            yield Case(f"bag {codec}{end}", *built(small_bag(codec), indexed=indexed))
    for codec in mcap_bytes.CODECS:
        for summary, end in ((True, ""), (False, " without summary")):
            mcap = built(small_mcap(codec), summary=summary)
            yield Case(f"mcap {codec or 'none'}{end}", *mcap)
    yield Case("mcap without chunks", *built(small_mcap(""), chunked=False))


CASES: Final = tuple(cases())


def read_harmed(folder: Path, case: Case, mutations: Sequence[Mutation]) -> Reading | None:
    """Harm, read and check a log; None if it was refused in a sentence.

    What is promised:

    - nothing but a `LogtoolError` is ever raised;
    - where checksums vouch for payloads, every message that comes out is one that went in.
      Messages of an uncompressed chunk that the file's end cuts off cannot be verified, and come
      out all the same; so do those of a chunk whose damaged head says that it has no checksum,
      or of a file in which no chunk's head is left. Topics are told by records outside the
      chunks, too, and nothing vouches for those in a bag's index section or in a summary that is
      damaged itself;
    - if anything is missing or different, it is said. What no checksum covers cannot be seen:
      payloads in an uncompressed bag, and in an MCAP without chunks beyond its overall checksum.
    """
    data = case.data
    for mutation in mutations:
        data = mutation.apply(data)
    try:
        reading = read_bytes(folder, data)
    except LogtoolError as error:
        assert "\n" not in str(error)  # noqa: PT017 - an error is one of two good outcomes
        return None
    check(case, mutations, reading)
    return reading


def check(case: Case, mutations: Sequence[Mutation], reading: Reading) -> None:
    if case.name not in UNCHECKED:
        written = {message[1:] for message in case.log.written}
        is_bag = isinstance(case.log, BagBytes)
        vouched_for = reading.messages if is_bag else _under_checksums(reading)
        strange = [message for message in vouched_for if message[1:] not in written]
        assert not strange, (strange, reading.sentences)
        if not is_bag and len(mutations) == 1:
            assert set(vouched_for) <= set(case.log.written), reading.sentences
        assert reading.losses or set(reading.messages) == set(case.log.written)
    for loss in reading.losses:
        assert loss.what
        assert loss.bytes >= 0
        assert loss.messages is None or loss.messages >= 0


def _under_checksums(reading: Reading) -> list[Read]:
    """Return the messages of an MCAP that must be true.

    Those are all but the ones of chunks whose damaged heads say that there is no checksum, and of
    chunks that are cut off or of which no head is left.
    """
    messages: list[Read] = []
    for loaded, rows in zip(reading.chunks, reading.rows, strict=True):
        head = bytes(loaded.stored[:37])
        is_whole = len(loaded.stored) >= 9 + int.from_bytes(head[1:9], "little")
        if loaded.chunk.is_record and is_whole and head[33:37] != bytes(4):
            messages.extend(reading.messages[rows])
    return messages


def floor(case: Case, size: int) -> int:
    """Return how many messages of a log that is cut after some bytes must come out."""
    log = case.log
    if case.name.startswith(("bag none", "mcap none", "mcap without")):
        return sum(end <= size for end in log.message_ends)
    whole = sum(end <= size for end in log.chunk_ends)
    return sum(len(chunk) for chunk in log.chunks[:whole])


def random_mutation(chance: random.Random, size: int = 1 << 16) -> Mutation:
    """Return a mutation somewhere in a file of a size."""
    return Mutation(
        chance.choice(KINDS),
        chance.randrange(size),
        chance.choice([0, 1, 2, 3, 7, 8, 30, 100, 599]),
        chance.randrange(1 << 16),
    )
