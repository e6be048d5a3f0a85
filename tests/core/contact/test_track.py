"""What a track knows of a vertical force that is not told all the time."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.stance_samples import FootSignal
from dogbot_logtool.core.contact.track import POINT_RATE_HZ, FootTrack, foot_track
from tests.core.load.feet import samples_of

STEP = 1_000_000
NAN = np.nan


def track_of(time: Ints, force: Floats, vertical: Floats, point: Floats) -> FootTrack:
    samples = replace(samples_of(time / 1e9, force), position=point)
    return foot_track(FootSignal(samples, np.arange(len(time)), time, force, vertical), 1e8)


def test_the_time_between_known_vertical_forces_is_unknown() -> None:
    """From the last known one, or the start, to the next one."""
    vertical = np.array([NAN, NAN, 5.0, 6.0, NAN, 7.0, 8.0])
    time = (100 + np.arange(len(vertical), dtype=np.int64)) * STEP
    track = track_of(time, np.full(7, 50.0), vertical, np.full((7, 3), NAN))
    assert ((track.vertical_unknown // STEP) - 100).tolist() == [[0, 2], [3, 5]]
    assert track.vertical_within(time[[[0, 6]]]) == pytest.approx(13e-3)
    assert track.force_within(time[[[0, 6]]]) == pytest.approx(0.3)


def test_contact_points_are_kept_seldom_but_at_every_touchdown() -> None:
    time = np.arange(1000, dtype=np.int64) * STEP
    point = np.zeros((1000, 3))
    point[:, 0] = np.arange(1000)
    point[np.arange(1000) % 250 < 13] = NAN
    zero = np.zeros(1000)
    at, places = track_of(time, zero, zero, point).contact_points
    assert {13, 263, 513, 763} <= {int(x) for x in places[:, 0]}
    assert len(at) <= POINT_RATE_HZ + 4
