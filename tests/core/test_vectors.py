"""Vectors at a bounded rate, and their clock."""

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.corrections.clock import OffsetTrack, TimeSource, offset_track
from dogbot_logtool.core.vectors import VectorHistory, VectorSamples, vector_history

S = 1_000_000_000
LATE = 3_000_000


def samples(seconds: Floats, behind: int = LATE, *, stamped: bool = True) -> VectorSamples:
    log_time = 100 * S + np.round(seconds * 1e9).astype(np.int64)
    stamp = log_time - behind if stamped else np.zeros_like(log_time)
    vector = np.stack([seconds, seconds**2, -seconds], axis=1)
    return VectorSamples(log_time, stamp, vector, vector)


def clock_of_base(behind: int) -> OffsetTrack:
    log_time = 100 * S + np.arange(0, 10 * S, S // 100)
    return offset_track(log_time, log_time - behind)


def recorded(
    given: VectorSamples, base: OffsetTrack | None, clock: TimeSource = TimeSource.HEADER
) -> VectorHistory:
    return vector_history("/v", given, (), clock, base)


AT = np.arange(400) / 50.0


def test_stamps_of_the_clock_of_the_base_are_used() -> None:
    found = recorded(samples(AT), clock_of_base(LATE))
    assert not found.on_log_time
    np.testing.assert_array_equal(found.time, samples(AT).stamp)


def test_without_stamps_log_times_are_put_on_the_clock_of_the_base() -> None:
    behind = 40 * S
    found = recorded(samples(AT, stamped=False), clock_of_base(behind))
    assert found.on_log_time
    np.testing.assert_array_equal(found.time, samples(AT).log_time - behind)


def test_stamps_of_another_clock_are_not_used() -> None:
    found = recorded(samples(AT, 7 * S), clock_of_base(LATE))
    assert found.on_log_time
    np.testing.assert_array_equal(found.time, samples(AT).log_time - LATE)


def test_a_bad_stamp_costs_its_own_message() -> None:
    given = samples(AT)
    given.stamp[[0, 200]] = 0
    given.stamp[100] += 500 * S
    found = recorded(given, clock_of_base(LATE))
    assert len(found.time) == 397


def test_what_is_no_number_is_refused() -> None:
    given = samples(AT)
    given.vector[[3, 5, 9]] = [[np.nan, 0, 0], [0, np.inf, 0], [0, 0, 1e300]]
    found = recorded(given, None)
    assert (found.messages, found.refused) == (400, 3)
    assert len(found.time) == 397
    assert np.isfinite(found.vector).all()


def test_log_times_that_step_back_are_left_out() -> None:
    given = samples(AT)
    given.log_time[7] -= S
    found = recorded(given, None)
    assert len(found.time) == 399
    assert (np.diff(found.time) > 0).all()


def test_a_thousand_a_second_become_a_hundred() -> None:
    seconds = np.arange(10_000) / 1000.0
    given = samples(seconds)
    found = vector_history("/v", given, (), TimeSource.HEADER, None)
    assert len(found.time) == 1000
    np.testing.assert_allclose(found.vector[:, 0], (found.time - given.stamp[0]) / 1e9, atol=1e-6)
