import numpy as np
import pytest

from dogbot_logtool.core.geometry.clock import StampWatch, UnusableStamps, advancing


def test_sound_stamps_pass_in_any_batches() -> None:
    watch = StampWatch("/foot")
    watch.watch(np.array([5, 5, 6], np.int64))
    watch.watch(np.empty(0, np.int64))
    watch.watch(np.array([6, 9], np.int64))


@pytest.mark.parametrize("stamps", [[0], [5, 0, 6]])
def test_zero_stamps_are_unusable(stamps: list[int]) -> None:
    with pytest.raises(UnusableStamps, match="/foot are zero"):
        StampWatch("/foot").watch(np.array(stamps, np.int64))


def test_stamps_that_go_backwards_are_unusable_across_batches_too() -> None:
    watch = StampWatch("/foot")
    watch.watch(np.array([5, 7], np.int64))
    with pytest.raises(UnusableStamps, match="/foot go backwards"):
        watch.watch(np.array([6], np.int64))


def test_only_samples_later_than_all_before_advance() -> None:
    time = np.array([5, 5, 7, 6, 7, 8], np.int64)
    assert advancing(time, None).tolist() == [1, 0, 1, 0, 0, 1]
    assert advancing(time, 7).tolist() == [0, 0, 0, 0, 0, 1]
