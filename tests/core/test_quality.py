import numpy as np
import pytest

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.quality import TopicQuality, topic_quality

MS = 1_000_000
S = 1_000 * MS


def watched(
    log_time: Ints, stamp: Ints | None, *, clock: TimeSource = TimeSource.HEADER
) -> TopicQuality:
    return topic_quality("/foot", log_time, stamp, clock)


def steady(count: int = 1001, interval_ms: int = 10) -> Ints:
    return S + np.arange(count, dtype=np.int64) * interval_ms * MS


def without(*rows: slice) -> Ints:
    kept = np.ones(1001, np.bool_)
    for each in rows:
        kept[each] = False
    return steady()[kept]


def faulty() -> Ints:
    stamp = steady(10)
    stamp[3], stamp[6] = stamp[2], stamp[4]
    return stamp


TWO_GAPS = without(slice(100, 150), slice(600, 606))
ON_LOG: dict[str, object] = {"clock": TimeSource.LOG, "clock_offset_s": None, "rate_hz": 100.0}
BURST = S + np.arange(12, dtype=np.int64) * 20_000


@pytest.mark.parametrize(
    ("log_time", "stamp", "expected"),
    [
        (steady() + 2 * MS, steady(), {"messages": 1001, "gaps": 0, "longest_gap_s": 0.0}),
        (steady() + 2 * MS, steady(), {"rate_hz": 100.0, "clock_offset_s": 0.002}),
        (steady(), steady(), {"interval_s": 0.01, "interval_p95_s": 0.01, "interval_max_s": 0.01}),
        (TWO_GAPS, TWO_GAPS, {"gaps": 2, "gaps_total_s": 0.58, "longest_gap_s": 0.51}),
        (TWO_GAPS, TWO_GAPS, {"rate_hz": 94.4}),
        (steady(interval_ms=500), steady(interval_ms=500), {"gaps": 0}),
        (steady(10), faulty(), {"duplicate_stamps": 1, "backward_stamps": 1, "zero_stamps": 0}),
        (steady(10), faulty(), {"duplicate_log_times": 0, "backward_log_times": 0}),
        (steady(10), np.zeros(10, np.int64), {**ON_LOG, "zero_stamps": 10}),
        (steady(10), None, {**ON_LOG, "zero_stamps": None}),
        (BURST[:2], BURST[:2], {"rate_hz": None}),
        (BURST, BURST, {"rate_hz": None}),
        (steady(9), steady(9), {"rate_hz": None}),
        (3 * steady() - 2 * S, steady(), {"clock_drift_ppm": 2e6}),
        (2 * steady(620) - S, steady(620), {"clock_drift_ppm": 1e6}),
        (2 * steady(480) - S, steady(480), {"clock_drift_ppm": None}),
        (np.array([S, 101 * S]), np.array([S, 101 * S]), {"clock_drift_ppm": None}),
    ],
)
def test_times_of_a_topic(log_time: Ints, stamp: Ints | None, expected: dict[str, object]) -> None:
    quality = watched(log_time, stamp)
    for name, value in expected.items():
        own = getattr(quality, name)
        assert own == (pytest.approx(value, rel=1e-3) if isinstance(value, float) else value), name


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
        assert watched(stamps, stamps).gaps == 0
