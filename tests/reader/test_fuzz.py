"""Harmed logs: nothing but sentences, nothing made up, nothing missing unsaid."""

import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dogbot_logtool.errors import LogtoolError
from tests.reader.bag_bytes import BagBytes
from tests.reader.cases import Case
from tests.reader.mutation import CASES, KINDS, Mutation, floor, read_harmed
from tests.reader.reading import Reading, read_bytes, read_file

ANY_CASE = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
CUT_EVERY = [17, pytest.param(5, marks=pytest.mark.slow)]
"""Bytes; the cases differ in where their records end."""
FLIP_EVERY = 7
"""Bits: one of each byte at least. `make fuzz` tries others."""
FLIPPED = ("mcap none", "mcap lz4", "mcap zstd", "mcap zstd without summary", "mcap without chunks")
NUMBERS = st.integers(0, (1 << 16) - 1)
MUTATIONS = st.lists(
    st.builds(Mutation, st.sampled_from(KINDS), NUMBERS, NUMBERS, NUMBERS), min_size=1, max_size=4
)


@ANY_CASE
@pytest.mark.parametrize("every", CUT_EVERY)
def test_cut_anywhere(tmp_path: Path, case: Case, every: int) -> None:
    path = tmp_path / "log"
    path.write_bytes(case.data)
    for size in range(len(case.data) - 1, -1, -every):
        os.truncate(path, size)
        if isinstance(case.log, BagBytes) and 100 < size < 4000:
            continue  # the padding of the bag's header
        try:
            reading = read_file(path)
        except LogtoolError:
            assert size < 13
            continue
        got = len(reading.messages)
        assert list(reading.messages) == case.log.written[:got], size
        assert got >= floor(case, size), size
        assert reading.losses, size


@ANY_CASE
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(mutations=MUTATIONS)
def test_random_harm_makes_nothing_up_and_hides_nothing(
    tmp_path: Path, case: Case, mutations: list[Mutation]
) -> None:
    read_harmed(tmp_path, case, mutations)


def test_a_false_message_that_takes_the_end_of_the_data_is_left_out(tmp_path: Path) -> None:
    """A message's head from a chunk, once more behind the last chunk's index."""
    case = next(case for case in CASES if case.name == "mcap none without summary")
    read_harmed(tmp_path, case, [Mutation("duplicate", 56009, 30, 52235)])


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [case for case in CASES if case.name in FLIPPED], ids=lambda case: case.name
)
def test_a_flipped_bit_in_any_byte_is_harmless_or_said(tmp_path: Path, case: Case) -> None:
    sound = read_bytes(tmp_path, case.data)
    for bit in range(0, 8 * len(case.data), FLIP_EVERY):
        reading = read_harmed(tmp_path, case, [Mutation("flip", bit // 8, 1, bit % 8)])
        assert reading
        if not reading.losses:
            assert outcome(reading) == outcome(sound), bit
        if reading.lost is not None:
            missing = len(case.log.written) - len(reading.messages)
            assert reading.lost == max(missing, 0), bit


def outcome(reading: Reading) -> object:
    """Return all that is read, but for positions in the file."""
    topics = tuple(sorted(reading.topics))
    return replace(reading, topics=topics, chunks=(), rows=())
