import numpy as np
import pytest

from dogbot_logtool.core.corrections.clock import advancing, usual_interval_s


def test_only_samples_later_than_all_before_advance() -> None:
    time = np.array([5, 5, 7, 6, 7, 8], np.int64)
    assert advancing(time).tolist() == [1, 0, 1, 0, 0, 1]


def test_messages_in_bursts_are_as_dense_as_they_are_many() -> None:
    steady = np.arange(200) * 10_000_000
    bursts = -(-steady // 100_000_000) * 100_000_000
    assert usual_interval_s(steady) == pytest.approx(0.01)
    assert usual_interval_s(bursts) == pytest.approx(0.01, rel=0.02)


def test_silences_and_losses_do_not_lengthen_the_usual_interval() -> None:
    steady = np.arange(400) * 10_000_000
    kept = (np.arange(400) % 7 != 0) & ((np.arange(400) < 100) | (np.arange(400) > 250))
    assert usual_interval_s(steady[kept]) == pytest.approx(0.01)
    assert usual_interval_s(steady[:1]) is None
