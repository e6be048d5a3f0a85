import numpy as np
import pytest

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.quality import (
    TopicQuality,
    mean_rate_hz,
    topic_quality,
    topic_times,
)

MS = 1_000_000
S = 1_000 * MS


def watched(
    log_time: Ints, stamp: Ints | None, *, clock: TimeSource = TimeSource.HEADER
) -> TopicQuality:
    return topic_quality(topic_times("/foot", log_time, stamp), clock)


def steady(count: int = 1001, interval_ms: int = 10) -> Ints:
    return S + np.arange(count, dtype=np.int64) * interval_ms * MS


def test_a_steady_topic() -> None:
    quality = watched(steady() + 2 * MS, steady())
    assert (quality.messages, quality.gaps, quality.longest_gap_s) == (1001, 0, 0.0)
    assert quality.rate_hz == pytest.approx(100.0)
    assert quality.interval_s == {"p50": 0.01, "p95": 0.01, "max": 0.01}
    assert quality.offset_median_s == pytest.approx(0.002)
    assert quality.offset_drift_ppm == pytest.approx(0.0, abs=1e-6)


def test_gaps_are_counted_and_added_up() -> None:
    kept = np.ones(1001, np.bool_)
    kept[100:150] = False
    kept[600:606] = False
    quality = watched(steady()[kept], steady()[kept])
    assert quality.gaps == 2
    assert quality.gaps_total_s == pytest.approx(0.51 + 0.07)
    assert quality.longest_gap_s == pytest.approx(0.51)
    assert quality.rate_hz == pytest.approx(94.4)


def test_a_slow_topic_has_no_gaps() -> None:
    assert watched(steady(interval_ms=500), steady(interval_ms=500)).gaps == 0


def random_times(kind: str, count: int, seed: int) -> Ints:
    """Return times, ns, at which a topic of some kind speaks; it makes no gaps."""
    random = np.random.default_rng(seed)
    number = np.arange(count)
    match kind:
        case "periodic":
            seconds = number * 0.01
        case "jittered":
            seconds = number * 0.02 + random.uniform(0.0, 0.01, count)
        case "noisy":
            seconds = number * 0.1 + random.normal(0.0, 0.02, count)
        case "poisson":
            seconds = np.cumsum(random.exponential(0.1, count))
        case "two speeds":
            seconds = np.cumsum(np.where(number % 500 < 450, 0.01, 1.0))
        case _:
            size = int(kind.partition(" ")[0])
            jitter = random.uniform(0.0, 0.02, count // size + 1)[number // size]
            seconds = (number // size) * 0.2 + jitter + (number % size) * 2e-5
    return S + np.sort(np.round(seconds * S).astype(np.int64))


NO_GAPS = (
    *("periodic", "jittered", "noisy", "poisson", "two speeds"),
    *(f"{size} in a burst" for size in (2, 3, 4, 5, 10, 40, 200)),
)


@pytest.mark.parametrize("kind", NO_GAPS)
@pytest.mark.parametrize("cut", [0, 1, 7])
def test_a_topic_in_its_usual_rhythm_has_no_gaps(kind: str, cut: int) -> None:
    """It may begin in the midst of a burst."""
    for count, seed in ((400, 1), (2400, 2), (20_000, 3)):
        times = random_times(kind, count, seed)[cut:]
        quality = watched(times, times)
        assert (quality.gaps, quality.longest_gap_s) == (0, 0.0)


@pytest.mark.parametrize("kind", NO_GAPS)
def test_planted_gaps_are_found_in_any_rhythm(kind: str) -> None:
    times = random_times(kind, 20_000, 4)
    for row, seconds in ((4000, 20), (12_000, 30), (18_000, 25)):
        times[row:] += seconds * S
    quality = watched(times, times)
    assert quality.gaps == 3
    assert quality.gaps_total_s == pytest.approx(75.0, abs=4.0)
    assert quality.longest_gap_s == pytest.approx(30, abs=1.5)


@pytest.mark.parametrize("share", [0.02, 0.1])
def test_gaps_of_a_steady_topic_are_found_though_they_are_many_or_long(share: float) -> None:
    """One gap may last most of the log, and a tenth of all intervals may be gaps."""
    times = steady(1000)
    rows = np.arange(0, 1000, round(1 / share))[1:]
    for row in rows:
        times[row:] += 80 * MS
    assert watched(times, times).gaps == len(rows)
    long = steady(200)
    long[100:] += 100 * S
    quality = watched(long, long)
    assert quality.gaps == 1
    assert quality.longest_gap_s == pytest.approx(100.01)


def test_messages_on_events_are_never_late() -> None:
    """A latched topic, a few of a log's topics, and text that a node prints when it starts."""
    random = np.random.default_rng(6)
    start = np.cumsum(10.0 ** random.uniform(1.0, 7.0, 60))
    for times in (
        np.array([0.0]),
        np.array([0.0, 0.02e6]),
        np.array([0.0, 1e6, 2e6, 30e9, 61e9]),
        np.concatenate([start, [10e9, 42e9, 90e9]]),
    ):
        stamps = S + np.round(times).astype(np.int64)
        quality = watched(stamps, stamps)
        assert quality.gaps == 0


def test_a_rate_needs_messages_and_time() -> None:
    two = S + np.array([0, 20_291], np.int64)
    assert watched(two, two).rate_hz is None
    burst = S + np.arange(12, dtype=np.int64) * 20_000
    assert watched(burst, burst).rate_hz is None
    assert watched(steady(9), steady(9)).rate_hz is None
    assert watched(steady(10), steady(10)).rate_hz == pytest.approx(100.0)
    assert mean_rate_hz(1, 20_291) is None
    nanoseconds = S + np.arange(200, dtype=np.int64) * 2
    assert (watched(nanoseconds, nanoseconds).rate_hz) is None


@pytest.mark.parametrize("size", [2, 5, 40])
def test_the_rate_of_bursts_is_that_of_all_messages(size: int) -> None:
    times = random_times(f"{size} in a burst", 2400, 5)
    times[1200:] += 60 * S
    quality = watched(times, times)
    assert quality.rate_hz == pytest.approx(2400 / (2400 / size * 0.2 + 60), rel=0.05)


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


def test_two_messages_and_short_logs_tell_no_drift() -> None:
    far_apart = np.array([S, 101 * S])
    assert watched(far_apart, far_apart).offset_drift_ppm is None
    short = steady()[:620]
    assert watched(S + 2 * (short - S), short).offset_drift_ppm is not None
    shorter = steady()[:480]
    assert watched(S + 2 * (shorter - S), shorter).offset_drift_ppm is None
