"""Levels that move, of strides whose forces are known in closed form."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.corrections.moving_level import follow_level
from dogbot_logtool.core.corrections.sensor import SensorLevel, estimate_level

RATE_HZ = 200.0
PERIOD_S, DUTY, LOAD_N = 0.8, 0.6, 100.0


def walked(seconds: float, noise_n: float = 1.0) -> tuple[Floats, Floats]:
    """Return s, and (n, 3) N: a foot that is loaded by a half sine once a stride."""
    time = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    stance = (time / PERIOD_S) % 1.0 / DUTY
    load = np.where(stance < 1.0, LOAD_N * np.sin(np.pi * np.minimum(stance, 1.0)) ** 0.5, 0.0)
    noise = np.random.default_rng(2).normal(0.0, noise_n, (len(time), 3))
    return time, np.outer(load, (0.1, 0.0, 1.0)) + noise


def followed(
    time: Floats, force: Floats, *, below: bool = False
) -> tuple[SensorLevel, SensorLevel]:
    """Return the level of all samples, and the one that is followed."""
    sign = -1.0 if below else 1.0
    stamp: Ints = np.round(time * 1e9).astype(np.int64)
    level = estimate_level(stamp, sign * force)
    return level, follow_level(stamp, sign * force, level)


def test_a_level_that_stays_is_left_alone() -> None:
    level, same = followed(*walked(30.0))
    assert same is level


@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("step_n", [-60.0, -15.0, 40.0])
@pytest.mark.parametrize("at_s", [10.1, 10.6])
def test_a_sensor_that_is_zeroed(at_s: float, step_n: float, below: bool) -> None:  # noqa: FBT001
    """In a stance, and in a swing."""
    time, force = walked(20.0)
    zeroed = force + np.outer(time >= at_s, (0.0, 0.0, step_n))
    _, level = followed(time, zeroed, below=below)
    sign = -1.0 if below else 1.0
    assert level.moved_n == pytest.approx(abs(step_n), abs=1.5)
    assert level.drift_n_per_min is None
    assert level.loaded_n == pytest.approx(LOAD_N * 0.9, rel=0.1)
    at = np.array([5.0, 9.0, 12.0, 18.0])
    read = level.offset_at(np.round(at * 1e9).astype(np.int64))[:, 2]
    assert sign * read == pytest.approx([0.0, 0.0, step_n, step_n], abs=1.0)


def test_a_step_is_where_it_is_seen() -> None:
    time, force = walked(20.0)
    _, level = followed(time, force + np.outer(time >= 10.6, (0.0, 0.0, -60.0)))
    at: Ints = np.array([10_595_000_000, 10_600_000_000], np.int64)
    assert np.isin(at, level.knots).all()
    assert level.offset_at(at)[:, 2] == pytest.approx([0.0, -60.0], abs=1.0)
