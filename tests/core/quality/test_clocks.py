import numpy as np
import pytest

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.corrections.clock import (
    ClockDifference,
    OffsetTrack,
    clock_differences,
    offset_track,
    why_clocks_cannot_be_joined,
)

S = 1_000_000_000
START = 1_700_000_000 * S
FEET = ("/fl", "/fr", "/bl", "/br")


def track(
    behind_s: float = 0.0,
    *,
    jitter_s: float = 0.0,
    drift_s: float = 0.0,
    rate_hz: float = 100.0,
    seconds: float = 20.0,
    pace: float = 1.0,
    burst_s: float = 0.0,
    seed: int = 1,
) -> OffsetTrack:
    """Offsets of a topic whose stamps lie behind by so much, with delays of up to `jitter_s`."""
    random = np.random.default_rng(seed)
    truth = np.arange(round(seconds * rate_hz)) / rate_hz
    stamp = truth * pace - behind_s - drift_s * (truth / seconds - 0.5)
    log = truth + 0.0006 + random.uniform(0.0, jitter_s, len(truth))
    if burst_s:
        log = np.ceil(log / burst_s) * burst_s
    return offset_track(ns(log), ns(stamp))


def ns(seconds: np.ndarray) -> Ints:
    return START + np.round(np.sort(seconds) * 1e9).astype(np.int64)


def odometry_against_feet(odometry: OffsetTrack, **feet: float) -> ClockDifference:
    tracks = {topic: track(seed=row, rate_hz=250.0, **feet) for row, topic in enumerate(FEET)}
    found = clock_differences({**tracks, "/odom": odometry}, FEET)
    assert [each.topic for each in found if each.is_apart and each.topic != "/odom"] == []
    return found[-1]


@pytest.mark.parametrize("behind_s", [0.1, -0.1, 0.2, -0.2, 0.3, -0.3])
@pytest.mark.parametrize("jitter_s", [0.0, 0.004, 0.05])
def test_an_odometry_with_another_clock_is_apart(behind_s: float, jitter_s: float) -> None:
    found = odometry_against_feet(track(behind_s, jitter_s=jitter_s), jitter_s=jitter_s)
    assert found.is_apart
    assert found.behind_s == pytest.approx(behind_s, abs=0.01)


@pytest.mark.parametrize("jitter_s", [0.0, 0.004, 0.05, 0.3])
@pytest.mark.parametrize("pace", [1.0, 0.4, 3.0])
def test_one_clock_with_any_delays_and_pace_is_not_apart(jitter_s: float, pace: float) -> None:
    odometry = track(jitter_s=jitter_s, pace=pace, seed=9)
    assert not odometry_against_feet(odometry, jitter_s=jitter_s, pace=pace).is_apart


def test_clocks_that_drift_apart_are_told() -> None:
    found = odometry_against_feet(track(drift_s=0.3, seconds=60.0), seconds=60.0)
    assert found.is_apart
    assert found.drift_s == pytest.approx(0.3, abs=0.02)


def test_wall_and_simulation_time_cannot_be_joined() -> None:
    tracks = {"/fl": track(1_699_999_990.0), "/odom": track()}
    reason = why_clocks_cannot_be_joined(clock_differences(tracks, ("/fl",)))
    assert "/odom are 1699999990.00 s ahead of" in reason
    assert "wall time and simulation time are mixed" in reason
    near = {"/fl": track(0.3), "/odom": track()}
    assert not why_clocks_cannot_be_joined(clock_differences(near, ("/fl",)))
