"""The way of the contact point counts between loaded samples only, each stance on its own."""

import numpy as np
import pytest

from dogbot_logtool.core.contact.contact_way import loaded_ways


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
