"""Vectors at a bounded rate, and their clock."""

import numpy as np
import pytest

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.quality.clocks import OffsetRecorder, OffsetTrack
from dogbot_logtool.core.recorded.vectors import VectorHistory, VectorRecorder, VectorSamples

S = 1_000_000_000
LATE = 3_000_000


def samples(seconds: Floats, behind: int = LATE, *, stamped: bool = True) -> VectorSamples:
    log_time = 100 * S + np.round(seconds * 1e9).astype(np.int64)
    stamp = log_time - behind if stamped else np.zeros_like(log_time)
    return VectorSamples(log_time, stamp, np.stack([seconds, seconds**2, -seconds], axis=1))


def clock_of_base(behind: int) -> OffsetTrack:
    recorder = OffsetRecorder()
    log_time = 100 * S + np.arange(0, 10 * S, S // 100)
    recorder.add(log_time, log_time - behind)
    return recorder.finish()


def recorded(
    given: VectorSamples, base: OffsetTrack | None, clock: TimeSource = TimeSource.HEADER
) -> VectorHistory:
    recorder = VectorRecorder("/v", averages=False)
    recorder.add(given)
    return recorder.finish(clock, base)


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


def test_log_time_is_log_time() -> None:
    found = recorded(samples(AT), clock_of_base(LATE), TimeSource.LOG)
    assert found.on_log_time
    np.testing.assert_array_equal(found.time, samples(AT).log_time)


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
    assert found.not_advancing == 1
    assert (np.diff(found.time) > 0).all()


@pytest.mark.parametrize("averages", [False, True])
def test_batches_make_no_difference(*, averages: bool) -> None:
    given = samples(np.arange(50_000) / 1000.0)
    whole = VectorRecorder("/v", averages=averages, block_rows=700)
    whole.add(given)
    parts = VectorRecorder("/v", averages=averages, block_rows=700)
    for start in range(0, 50_000, 333):
        parts.add(given.pick(np.arange(start, min(start + 333, 50_000))))
    one, other = (each.finish(TimeSource.HEADER, None) for each in (whole, parts))
    np.testing.assert_array_equal(one.time, other.time)
    np.testing.assert_array_equal(one.vector, other.vector)


def test_a_thousand_a_second_become_a_hundred() -> None:
    recorder = VectorRecorder("/v", averages=True)
    seconds = np.arange(10_000) / 1000.0
    given = samples(seconds)
    recorder.add(given)
    found = recorder.finish(TimeSource.HEADER, None)
    assert len(found.time) == 1000
    np.testing.assert_allclose(found.vector[:, 0], (found.time - given.stamp[0]) / 1e9, atol=1e-6)
