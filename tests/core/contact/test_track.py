"""What a track knows of a vertical force that is not told all the time."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.contact.track import POINT_RATE_HZ, foot_track
from dogbot_logtool.core.corrections.clock import TimeSource
from tests.core.load.feet import samples_of

STEP = 1_000_000


def test_the_time_between_known_vertical_forces_is_unknown() -> None:
    """From the last known one, or the start, to the next one."""
    force = np.array([9.0, 9.0, 5.0, 6.0, 9.0, 7.0, 8.0])
    samples = samples_of(np.arange(7) / 1e3, force)
    samples.in_world[[2, 3, 5, 6]] = True
    track, _, _ = foot_track(samples, TimeSource.LOG, force_in_world=False)
    whole = track.time[[[0, 6]]]
    assert ((track.vertical_unknown - track.time[0]) // STEP).tolist() == [[0, 2], [3, 5]]
    assert track.vertical_within(whole) == pytest.approx(13e-3)
    assert track.force_within(whole) == pytest.approx(44.5e-3)


def test_contact_points_are_kept_seldom_but_at_every_touchdown() -> None:
    rows = np.arange(1000)
    point = np.stack([rows, 0 * rows, 0 * rows], axis=1).astype(np.float64)
    point[rows % 250 < 13] = np.nan
    samples = replace(samples_of(rows / 1e3, np.zeros(1000)), position=point)
    track, _, _ = foot_track(samples, TimeSource.LOG, force_in_world=True)
    at, places = track.contact_points
    assert {13, 263, 513, 763} <= {int(x) for x in places[:, 0]}
    assert len(at) <= POINT_RATE_HZ + 4
