"""The unloaded level of sensors, against forces with known offsets, drift and noise."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.corrections.modes import ALTERNATE
from dogbot_logtool.core.corrections.sensor import SensorLevel, estimate_level
from tests.core.contact.feet_forces import FootForces, walking_foot

NOISE_N = 5.0


def noisy(foot: FootForces, offset: tuple[float, float, float], noise: float = NOISE_N) -> Floats:
    rng = np.random.default_rng(7)
    force: Floats = foot.force + offset + rng.normal(0.0, noise, foot.force.shape)
    return force


def level_of(foot: FootForces, force: Floats) -> SensorLevel:
    return estimate_level(foot.time, force)


@pytest.mark.parametrize("shape", ["humps", "half-sine", "flat"])
@pytest.mark.parametrize("z", [-65.0, -40.0, -5.0, 0.0, 20.0])
def test_offset_and_noise_are_found(z: float, shape: str) -> None:
    foot = walking_foot(shape=shape)
    level = level_of(foot, noisy(foot, (4.0, -7.0, z)))
    assert level.reason == ""
    assert level.offset_n == pytest.approx([4.0, -7.0, z], abs=1.5)
    assert level.noise_n == pytest.approx(NOISE_N, rel=0.15)
    assert not level.zero_in_swing


def test_drift_is_followed() -> None:
    foot = walking_foot(duration_s=240.0, rate_hz=50.0)
    minutes = (foot.time - foot.time[0]) / 6e10
    force = noisy(foot, (0.0, 0.0, -40.0)) + np.stack([0 * minutes, 0 * minutes, 20 * minutes], 1)
    level = level_of(foot, force)
    assert level.drift_n_per_min == pytest.approx(20.0, rel=0.05)
    missed = level.offset_at(foot.time)[:, 2] - (-40.0 + 20.0 * minutes)
    assert np.abs(missed).max() < 4.0


@pytest.mark.parametrize("sway", ["sine", "two loads", "wander"])
def test_shifting_weight_in_a_stand_shows_no_level(sway: str) -> None:
    time = np.arange(0.0, 60.0, 0.01)
    rng = np.random.default_rng(5)
    load = {
        "sine": 400.0 + 250.0 * np.sin(2.0 * np.pi * time / 4.0),
        "two loads": np.where(time % 6.0 < 3.0, 200.0, 600.0),
        "wander": 400.0 + np.cumsum(rng.normal(0.0, 4.0, len(time))),
    }[sway]
    force = np.stack([0.1 * load, 0.0 * load, load], axis=1) + rng.normal(0.0, 5.0, (len(time), 3))
    level = estimate_level((time * 1e9).astype(np.int64), force)
    assert level.reason
    assert level.origin == "default"
    assert not level.offset.any()


@pytest.mark.parametrize("number", [0, 1, 5, 30])
def test_too_few_samples(number: int) -> None:
    foot = walking_foot()
    level = estimate_level(foot.time[:number], foot.force[:number] + 3.0)
    assert level.reason
    assert level.offset_at(foot.time).shape == (len(foot.time), 3)


def test_lone_zeros_are_dropouts_and_no_swing() -> None:
    foot = walking_foot(duration_s=30.0, rate_hz=50.0)
    force = noisy(foot, (0.0, 0.0, -50.0))
    lost = np.random.default_rng(3).random(len(force)) < 0.05
    lost[100:103] = True
    force[lost] = 0.0
    level = level_of(foot, force)
    assert not level.zero_in_swing
    assert level.drops_out
    assert level.offset_n[2] == pytest.approx(-50.0, abs=2.5)


def test_two_loads_that_alternate_keep_what_they_may_be() -> None:
    foot = walking_foot(shape="flat")
    level = level_of(foot, noisy(foot, (0.0, 0.0, 0.4 * float(foot.load.max())), noise=1.0))
    assert level.reason == ALTERNATE
    assert level.alternative is not None
    assert level.alternative.offset_n[2] == pytest.approx(0.4 * float(foot.load.max()), abs=1.5)
