"""Spikes of known place and size, among stances in closed form."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.loads import has_lone_spikes, without_spikes
from tests.core.load.feet import DUTY, PERIOD_S, WEIGHT_N, foot, seconds, vertical

TIME = seconds(16.0)
TRUE_PEAK_N = 0.25 * WEIGHT_N / DUTY * np.pi / 2.0


def spiked(at_s: list[float], times: float, samples: int = 1) -> FootHistory:
    """A foot whose force is a multiple of its true peak at some times."""
    force: Floats = vertical(TIME, 0.0).copy()
    for second in at_s:
        row = int(np.searchsorted(TIME, second))
        force[row : row + samples] = times * TRUE_PEAK_N
    return foot(TIME, force)


def peaks(record: FootHistory) -> Floats:
    stances = without_spikes(record.stances)
    found: Floats = stances.figures.peak_n[stances.whole]
    return found


def stance_time(stride: int, phase: float) -> float:
    return (stride + phase * DUTY) * PERIOD_S


@pytest.mark.parametrize("times", [2.1, 5.0, 100.0])
def test_lone_spikes_are_counted_and_kept_out_of_the_peaks(times: float) -> None:
    record = spiked([stance_time(3, 0.3), stance_time(7, 0.6), stance_time(12, 0.45)], times)
    assert record.stances.figures.peak_n.max() == pytest.approx(times * TRUE_PEAK_N)
    assert peaks(record) == pytest.approx(TRUE_PEAK_N, rel=1e-3)
    assert int(has_lone_spikes(record.stances).sum()) == 3


def test_two_spikes_in_a_stance_are_two() -> None:
    record = spiked([stance_time(3, 0.3), stance_time(3, 0.6)], 4.0)
    assert record.stances.figures.spikes.sum() == 2.0
    assert peaks(record) == pytest.approx(TRUE_PEAK_N, rel=1e-3)


def test_vertical_peaks_leave_spikes_out_too() -> None:
    stances = without_spikes(spiked([stance_time(3, 0.3)], 4.0).stances)
    assert stances.figures.peak_vertical_n.max() == pytest.approx(TRUE_PEAK_N, rel=1e-3)


def test_an_impact_that_recurs_at_one_phase_is_a_peak() -> None:
    record = spiked([stance_time(stride, 0.08) for stride in range(1, 19)], 3.0)
    assert not has_lone_spikes(record.stances).any()
    assert peaks(record).max() == pytest.approx(3.0 * TRUE_PEAK_N)


def test_a_spike_beside_recurring_impacts_is_lone() -> None:
    impacts = [stance_time(stride, 0.08) for stride in range(1, 19) if stride != 9]
    record = spiked([*impacts, stance_time(9, 0.7)], 3.0)
    assert int(has_lone_spikes(record.stances).sum()) == 1


def test_what_lasts_longer_than_a_sample_is_no_spike() -> None:
    record = spiked([stance_time(3, 0.3)], 3.0, samples=2)
    assert not has_lone_spikes(record.stances).any()


def test_a_sound_foot_has_no_spikes() -> None:
    record = spiked([], 0.0)
    assert record.stances.figures.spikes.sum() == 0.0
    assert peaks(record) == pytest.approx(TRUE_PEAK_N, rel=1e-3)


def test_impacts_of_touchdowns_need_not_recur() -> None:
    stance = spiked([], 0.0).stances
    starts = (stance.touchdown[[3, 9]] - 1_000_000_000) / 1e9
    assert not has_lone_spikes(spiked(starts.tolist(), 3.0).stances).any()
