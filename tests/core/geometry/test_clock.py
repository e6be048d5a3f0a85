import numpy as np

from dogbot_logtool.core.geometry.clock import advancing


def test_only_samples_later_than_all_before_advance() -> None:
    time = np.array([5, 5, 7, 6, 7, 8], np.int64)
    assert advancing(time, None).tolist() == [1, 0, 1, 0, 0, 1]
    assert advancing(time, 7).tolist() == [0, 0, 0, 0, 0, 1]
