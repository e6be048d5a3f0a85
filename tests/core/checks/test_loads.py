"""What is said of feet whose forces do not add up to the weight, against known causes."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats
from tests.core.checks.voided import metrics
from tests.oracles.straight_walk import SETTINGS, WEIGHT_N, Walk, foot_samples, measure


def walk_with(scales: tuple[float, ...], settings: StatsSettings = SETTINGS) -> Stats:
    """A trot whose feet report their forces times a factor each."""
    walk = Walk()
    time = walk.times()
    feet = [
        foot_samples(foot, time, scale * walk.force(foot, time), walk.points(foot, time))
        for foot, scale in enumerate(scales)
    ]
    return measure(feet, walk.odometry(), settings)


def voided(stats: Stats) -> set[str]:
    found = (each for each in findings_of(stats) if each.code == "IMPULSE_IS_NOT_WEIGHT")
    return {pattern for each in found for pattern in each.voids}


def said(stats: Stats, code: str) -> str:
    return " ".join(each.text for each in findings_of(stats) if each.code == code)


@pytest.mark.parametrize("steps", [2, 3, 10])
def test_summed_physics_steps_are_named(steps: int) -> None:
    stats = walk_with((float(steps),) * 4)
    assert f"{steps} physics steps" in said(stats, "IMPULSE_IS_NOT_WEIGHT")
    assert "feet.*_bw" in voided(stats)


def test_a_wrong_mass_is_named_with_the_mass_that_the_feet_carry() -> None:
    text = said(walk_with((1.4,) * 4), "IMPULSE_IS_NOT_WEIGHT")
    assert "the feet carry 28.1 kg, and the mass given is 20 kg" in text
    assert "physics" not in text


def test_a_mass_that_was_only_assumed_is_called_so() -> None:
    stats = walk_with((1.1,) * 4, replace(SETTINGS, mass_is_assumed=True))
    text = said(stats, "IMPULSE_IS_NOT_WEIGHT")
    assert "assumed for the guessed robot" in text
    assert voided(stats) == set()


def test_a_dead_foot_is_named() -> None:
    text = said(walk_with((1.0, 1.0, 1.0, 0.0)), "IMPULSE_IS_NOT_WEIGHT")
    assert "the load on back_right is missing" in text


def test_forces_that_are_hardly_vertical_are_named() -> None:
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    feet = [replace(each, force=np.roll(each.force, 1, axis=1)) for each in feet]
    text = said(measure(feet, walk.odometry()), "IMPULSE_IS_NOT_WEIGHT")
    assert "link's frame" in text


def test_four_percent_is_no_finding() -> None:
    assert said(walk_with((1.04,) * 4), "IMPULSE_IS_NOT_WEIGHT") == ""
    assert said(walk_with((1.06,) * 4), "IMPULSE_IS_NOT_WEIGHT") != ""


def test_an_estimated_weight_is_said() -> None:
    stats = walk_with((1.0,) * 4, replace(SETTINGS, mass_kg=None))
    assert stats.loads.weight_n == pytest.approx(WEIGHT_N, rel=0.01)
    assert f"{stats.loads.weight_n:.4g} N" in said(stats, "MASS_UNKNOWN")


def test_a_given_mass_that_is_missed_leaves_the_direction_of_forces_in_doubt() -> None:
    sound, missed = walk_with((1.0,) * 4), walk_with((1.1,) * 4)
    assumed = walk_with((1.1,) * 4, replace(SETTINGS, mass_is_assumed=True))
    kept = [foot for stats in (sound, assumed) for foot in metrics(stats).feet.values()]
    assert all(foot.braking_impulse_ns is not None for foot in kept)
    assert all(foot.braking_impulse_ns is None for foot in metrics(missed).feet.values())
    assert "feet.*.braking_impulse_ns" in voided(missed)


@pytest.mark.parametrize(("scale", "is_said"), [(1.0, False), (1.15, False), (1.4, True)])
def test_magnitudes_far_from_the_weight_are_said(scale: float, is_said: bool) -> None:  # noqa: FBT001
    settings = replace(SETTINGS, wrench_frame=WrenchFrame.LINK)
    stats = walk_with((scale,) * 4, settings)
    assert stats.loads.magnitude_over_weight == pytest.approx(scale, rel=0.05)
    assert bool(said(stats, "IMPULSE_IS_NOT_WEIGHT")) is is_said
    assert (stats.loads.weight_n is None) is is_said
