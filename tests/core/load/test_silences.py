"""Where feet fall silent, whatever the batches."""

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.load.loads import Loads, LoadState
from dogbot_logtool.core.load.silences import (
    LastContact,
    MessageRate,
    follow_silences,
    message_rate,
)

MS: Final = 1_000_000
RATE: Final = MessageRate(due_ns=10 * MS, gap_ns=50 * MS)


def samples(times_ms: list[int], foot: int = 0) -> Samples:
    count = len(times_ms)
    nothing = np.zeros((count, 3))
    return replace(
        no_samples(),
        foot=np.full(count, foot),
        log_time=np.array(times_ms, np.int64) * MS,
        stamp=np.array(times_ms, np.int64) * MS + 5,
        in_contact=np.zeros(count, np.bool_),
        force=nothing,
        in_world=np.zeros(count, np.bool_),
        points=np.zeros(count, np.int64),
        position=nothing,
        normal=nothing,
    )


def told(batches: list[list[int]], end_ms: int, opening_ms: int = 0) -> list[int]:
    """The times, ms, from which one foot is unknown."""
    before: tuple[LastContact, ...] | None = None
    found: list[int] = []
    for number, batch in enumerate(batches):
        later = [time for each in batches[number + 1 :] for time in each]
        end = batch[-1] if batch else opening_ms
        end = end if later else end_ms
        rows, before = follow_silences([samples(batch)], before, (RATE,), opening_ms * MS, end * MS)
        assert set(rows.state.tolist()) <= {LoadState.UNKNOWN}
        assert np.isnan(rows.force).all()
        found += (rows.log_time // MS).tolist()
    return sorted(found)


def test_a_gap_begins_when_the_next_message_is_due() -> None:
    assert told([[10, 20, 30, 200, 210]], 215) == [40]


def test_a_foot_that_speaks_throughout_is_never_unknown() -> None:
    assert told([list(range(0, 1000, 10))], 1000) == []


def test_a_dead_foot_is_unknown_from_the_first_time_and_once() -> None:
    assert told([[]], 1000) == [0]
    before: tuple[LastContact, ...] | None = None
    rows: list[Loads] = []
    for end in (100, 500, 900):
        row, before = follow_silences([samples([])], before, (RATE,), 0, end * MS)
        rows.append(row)
    assert [len(row.foot) for row in rows] == [1, 0, 0]


def test_a_foot_that_dies_is_unknown_to_the_end() -> None:
    assert told([[0, 10, 20]], 500) == [30]
    assert told([[0, 10, 20], []], 500) == [30]


def test_a_foot_that_begins_late_is_unknown_before() -> None:
    assert told([[300, 310]], 320) == [0]


@given(st.sets(st.integers(0, 1000), min_size=1), st.lists(st.integers(0, 1000), max_size=3))
def test_batches_do_not_matter(times: set[int], cuts: list[int]) -> None:
    edges = [0, *sorted(cuts), 1001]
    batches = [
        sorted(time for time in times if first <= time < end) for first, end in pairwise(edges)
    ]
    if batches[0]:
        assert told(batches, 1200) == told([sorted(times)], 1200)


def test_a_slow_sensor_is_not_silent() -> None:
    slow = message_rate(np.arange(20) * 200 * MS)
    assert (slow.due_ns, slow.gap_ns) == (200 * MS, 1000 * MS)
    fast = message_rate(np.arange(20) * 2 * MS)
    assert (fast.due_ns, fast.gap_ns) == (2 * MS, 50 * MS)


def test_silence_may_be_a_swing() -> None:
    assert message_rate(np.arange(20) * 2 * MS, 3000 * MS).gap_ns == 3000 * MS


@pytest.mark.parametrize("seed", [1, 2])
def test_the_rate_is_the_same_whichever_part_of_the_log_tells_it(seed: int) -> None:
    jitter_ns = np.random.default_rng(seed).integers(-20_000, 20_000, 200)
    times = 2_000_000 * np.arange(200) + jitter_ns
    assert message_rate(times).due_ns == 2_000_000
