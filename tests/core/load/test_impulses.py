"""Mean forces over a window, of loads whose means are known in closed form."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.loads import mean_impulses
from tests.core.load.feet import RATE_HZ, foot, seconds

HALF_S = 0.1
"""Half of the window."""
LONG_S = 4.0


def nanoseconds(*time_s: float) -> Ints:
    """Times since the first sample, as stamps."""
    return 1_000_000_000 + np.round(np.array(time_s) * 1e9).astype(np.int64)


def means(*feet: FootHistory, at: tuple[float, ...], impulse: str = "vertical_impulse") -> Floats:
    return mean_impulses(feet, impulse, nanoseconds(*at), round(HALF_S * 1e9))


def constant(force: tuple[float, float, float], begin_s: float = 0.0) -> FootHistory:
    time = seconds(LONG_S - begin_s) + begin_s
    return foot(time, np.tile(force, (len(time), 1)))


def test_the_mean_of_a_constant_force_is_that_force() -> None:
    feet = constant((0.0, 0.0, 40.0)), constant((0.0, 0.0, 70.0))
    found = means(*feet, at=(0.5, 1.013, 3.9))
    np.testing.assert_allclose(found, [[40.0, 70.0]] * 3, rtol=1e-9)


def test_the_vertical_force_and_all_of_it() -> None:
    leaning = constant((30.0, 0.0, 40.0))
    assert means(leaning, at=(2.0,)) == pytest.approx(40.0)
    assert means(leaning, at=(2.0,), impulse="force_impulse") == pytest.approx(50.0)


@pytest.mark.parametrize(("at_s", "share"), [(0.8, 0.0), (0.95, 0.25), (1.0, 0.5), (1.2, 1.0)])
def test_a_step_is_the_share_of_the_window_behind_it(at_s: float, share: float) -> None:
    time = seconds(LONG_S)
    stepping = foot(time, np.where(time >= 1.0, 100.0, 0.0))
    # Between the two samples at the step, the force is taken to rise evenly.
    rise = 0.5 / RATE_HZ / (2.0 * HALF_S) if 0.0 < share < 1.0 else 0.0
    assert means(stepping, at=(at_s,)) == pytest.approx(100.0 * (share + rise))


def test_the_mean_of_a_ramp_is_its_value_amid_the_window() -> None:
    time = seconds(LONG_S)
    # Between two samples, the force counts as even: a parabola lacks up to h^2 / 8.
    lacking = 20.0 / RATE_HZ**2 / 8.0 / (2.0 * HALF_S)
    found = means(foot(time, 20.0 * time), at=(0.5, 1.713, 3.1))
    np.testing.assert_allclose(found[:, 0], [10.0, 34.26, 62.0], rtol=0.0, atol=1.01 * lacking)


def test_each_foot_has_a_first_sample_of_its_own() -> None:
    feet = constant((0.0, 0.0, 40.0)), constant((0.0, 0.0, 70.0), begin_s=2.0)
    found = means(*feet, at=(1.0, 2.0, 3.0))
    np.testing.assert_allclose(found, [[40.0, 0.0], [40.0, 35.0], [40.0, 70.0]], rtol=1e-9)


def test_nothing_is_added_before_and_after_the_track() -> None:
    found = means(constant((0.0, 0.0, 40.0)), at=(-1.0, 0.0, LONG_S, LONG_S + 1.0))
    np.testing.assert_allclose(found[:, 0], [0.0, 20.0, 20.0, 0.0], rtol=1e-9)


def test_a_foot_without_a_track_has_no_force() -> None:
    silent = foot(np.empty(0), np.empty(0))
    found = means(constant((0.0, 0.0, 40.0)), silent, at=(1.0, 2.0))
    np.testing.assert_allclose(found, [[40.0, 0.0]] * 2, rtol=1e-9)


def test_no_times_have_no_means() -> None:
    assert means(constant((0.0, 0.0, 40.0)), at=()).shape == (0, 1)
