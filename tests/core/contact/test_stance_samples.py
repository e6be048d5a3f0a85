"""What is computed of each sample of a foot."""

from dataclasses import replace

import numpy as np

from dogbot_logtool.core.contact.stance_samples import FootSignal, stance_samples
from tests.core.load.feet import samples_of, seconds


def test_only_a_point_that_is_no_mean_is_single() -> None:
    samples = replace(samples_of(seconds(0.012), np.full(4, 50.0)), points=np.array([0, 1, 2, 3]))
    signal = FootSignal(samples, samples.time, np.full(4, 50.0), np.full(4, 50.0))
    found = stance_samples(signal, np.array([1]), np.array([3]), 10.0)
    assert found.single.tolist() == [False, True, False, False]
