"""The way of the contact point counts between loaded samples only, each stance on its own."""

import numpy as np
import pytest

from dogbot_logtool.core.contact.contact_way import loaded_ways, quick_ways


def test_a_jump_without_load_is_no_way() -> None:
    time = np.array([0.0, 0.01, 0.02, 0.03, 0.04, 0.05])
    x = np.array([0.0, 0.0, 0.04, 0.04, 0.05, 0.05])
    loaded = np.array([True, False, True, True, True, True])
    reach, begins, ends = loaded_ways(time, x, np.zeros(6), loaded, np.zeros(6, np.int64), 1)
    assert reach == pytest.approx([0.01])
    assert begins == pytest.approx([0.03])
    assert ends == pytest.approx([0.04])


def test_stances_do_not_add_up_and_nothing_is_known_of_those_without_samples() -> None:
    time = np.array([0.0, 0.01, 0.0, 0.01])
    x, stance = np.array([0.0, 0.3, 9.0, 9.1]), np.array([0, 0, 2, 2])
    reach, begins, _ = loaded_ways(time, x, np.zeros(4), np.ones(4, np.bool_), stance, 3)
    assert reach == pytest.approx([0.3, np.nan, 0.1], nan_ok=True)
    assert np.isnan(begins[1])


def test_the_quickest_way_is_told_with_its_middle_part() -> None:
    """A point creeps at 0.02 m/s, and goes 10 mm more between 0.30 and 0.34 s, of the second."""
    time = np.arange(0.0, 0.8, 0.004)
    creep = 0.02 * time
    slid = 0.01 * np.clip((time - 0.3) / 0.04, 0.0, 1.0)
    x, y = np.concatenate([creep, creep]), np.concatenate([np.zeros_like(time), slid])
    stance = np.repeat([0, 1], len(time))
    both, counts = np.concatenate([time, time]), np.ones(len(stance), np.bool_)
    way, begins, ends = quick_ways(both, x, y, counts, stance, 3)
    assert way == pytest.approx([0.0, np.hypot(0.01, 0.0012), np.nan], abs=1e-4, nan_ok=True)
    assert begins[1] == pytest.approx(0.304, abs=0.005)
    assert ends[1] == pytest.approx(0.336, abs=0.005)


def test_jumps_and_means_of_several_points_are_no_way() -> None:
    time = np.arange(0.0, 0.4, 0.01)
    x = np.where(time < 0.2, 0.0, 0.05)
    counts, stance = np.ones(len(time), np.bool_), np.zeros(len(time), np.int64)
    assert quick_ways(time, x, x, counts, stance, 1).metres == pytest.approx([0.0])
    eased = np.clip((time - 0.1) / 0.1, 0.0, 1.0) * 0.03
    assert quick_ways(time, eased, x, counts, stance, 1).metres[0] > 0.015
    several = np.zeros(len(time), np.bool_)
    assert np.isnan(quick_ways(time, eased, x, several, stance, 1).metres).all()
