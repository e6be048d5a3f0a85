import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.quality import TopicQuality, TopicWatch

MS = 1_000_000
S = 1_000 * MS


def watched(
    log_time: Ints,
    stamp: Ints | None,
    *,
    clock: TimeSource = TimeSource.HEADER,
    cuts: tuple[int, ...] = (),
) -> TopicQuality:
    watch = TopicWatch("/foot")
    for rows in np.split(np.arange(len(log_time)), cuts):
        watch.add(log_time[rows], None if stamp is None else stamp[rows], ("odom",))
    return watch.finish(clock)


def steady(count: int = 1001, interval_ms: int = 10) -> Ints:
    return S + np.arange(count, dtype=np.int64) * interval_ms * MS


def test_a_steady_topic() -> None:
    quality = watched(steady() + 2 * MS, steady())
    assert (quality.messages, quality.gaps, quality.longest_gaps) == (1001, 0, ())
    assert quality.rate_hz == pytest.approx(100.0)
    assert quality.median_rate_hz == pytest.approx(100.0)
    assert quality.interval_s == {"p50": 0.01, "p95": 0.01, "p99": 0.01, "max": 0.01}
    assert (quality.first, quality.last) == (S, 11 * S)
    assert quality.offset_median_s == pytest.approx(0.002)
    assert quality.offset_drift_ppm == pytest.approx(0.0, abs=1e-6)
    assert quality.frame_ids == ("odom",)


def test_gaps_are_counted_placed_and_added_up() -> None:
    kept = np.ones(1001, np.bool_)
    kept[100:150] = False
    kept[600:606] = False
    quality = watched(steady()[kept], steady()[kept], cuts=(3, 99, 100))
    assert quality.gaps == 2
    assert quality.gaps_total_s == pytest.approx(0.51 + 0.07)
    assert [(gap.start - S) // MS for gap in quality.longest_gaps] == [990, 5990]
    assert quality.rate_hz == pytest.approx(94.4)
    assert quality.median_rate_hz == pytest.approx(100.0)


def test_a_slow_topic_has_no_gaps() -> None:
    assert watched(steady(interval_ms=500), steady(interval_ms=500)).gaps == 0


def test_faults_of_stamps_are_counted() -> None:
    stamp = steady(10)
    stamp[3] = stamp[2]
    stamp[6] = stamp[4]
    quality = watched(steady(10), stamp)
    assert (quality.duplicate_stamps, quality.backward_stamps, quality.zero_stamps) == (1, 1, 0)
    assert (quality.duplicate_log_times, quality.backward_log_times) == (0, 0)


def test_zero_stamps_put_a_topic_on_log_time() -> None:
    quality = watched(steady(10), np.zeros(10, np.int64))
    assert quality.clock is TimeSource.LOG
    assert quality.zero_stamps == 10
    assert quality.offset_median_s is None
    assert quality.rate_hz == pytest.approx(100.0)


def test_messages_without_header_are_on_log_time() -> None:
    quality = watched(steady(10), None)
    assert quality.clock is TimeSource.LOG
    assert quality.zero_stamps is None


def test_a_slow_simulation_drifts() -> None:
    stamp = steady()
    quality = watched(S + 2 * (stamp - S), stamp)
    assert quality.offset_drift_ppm == pytest.approx(1e6, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(0, 300), max_size=5))
def test_batches_do_not_matter(cuts: list[int]) -> None:
    random = np.random.default_rng(5)
    stamp = S + np.cumsum(random.integers(0, 80 * MS, 300))
    log_time = stamp + random.integers(0, 3 * MS, 300)
    assert watched(log_time, stamp, cuts=tuple(sorted(cuts))) == watched(log_time, stamp)
