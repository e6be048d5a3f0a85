"""What a track knows of a vertical force that is not told all the time."""

import numpy as np
import pytest

from dogbot_logtool.core.contact.track import TrackRecorder
from dogbot_logtool.core.geometry.arrays import Floats, Ints

STEP = 10_000_000
NAN = np.nan


def unknown_in(vertical: Floats, cut: int) -> Ints:
    time = (100 + np.arange(len(vertical), dtype=np.int64)) * STEP
    recorder = TrackRecorder()
    for rows in (slice(None, cut), slice(cut, None)):
        force = np.full(len(time[rows]), 50.0)
        recorder.add(time[rows], force, vertical[rows], np.full((len(force), 3), NAN))
    return recorder.finish(0.1e9).vertical_unknown // STEP - 100


@pytest.mark.parametrize("cut", range(8))
def test_the_time_between_known_vertical_forces_is_unknown(cut: int) -> None:
    """From the last known one, or the start, to the next one."""
    found = unknown_in(np.array([NAN, NAN, 5.0, 6.0, NAN, 7.0, 8.0]), cut)
    assert found.tolist() == [[0, 2], [3, 5]]
