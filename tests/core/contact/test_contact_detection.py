"""What is computed of each sample of a foot."""

from dataclasses import replace

import numpy as np

from dogbot_logtool.core.contact.contact_detection import foot_signal
from tests.core.load.feet import RULE, samples_of, seconds


def test_only_a_point_that_is_no_mean_is_single() -> None:
    samples = replace(samples_of(seconds(0.012), np.full(4, 50.0)), points=np.array([0, 1, 2, 3]))
    signal = foot_signal(
        samples, samples.time, np.full(4, 50.0), RULE, force_in_world=True, previous=None
    )
    assert signal.single.tolist() == [False, True, False, False]
