import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.stances import (
    StanceSamples,
    contact_travel,
    loading_rate,
    quantile,
    reduce_stance,
    trapezoid,
)


def stance(force: Floats, step: float, x: Floats | None = None) -> StanceSamples:
    """A stance whose first sample is the one before touchdown and last the one after lift-off."""
    count = len(force)
    along = np.zeros(count) if x is None else x
    friction = np.where(force >= 10.0, 0.2, np.nan)
    time: Floats = (np.arange(count, dtype=np.float64) - 1.0) * step
    return StanceSamples(time, force, 0.9 * force, along, np.zeros(count), friction)


def test_a_half_sine_has_its_closed_form_figures() -> None:
    time = np.linspace(0.0, 0.5, 501)
    force = 100.0 * np.sin(np.pi * time / 0.5)
    force[0] = force[-1] = 0.0
    row = reduce_stance(stance(force, 0.001))
    assert row.peak_n == pytest.approx(100.0, rel=1e-5)
    assert row.mean_n == pytest.approx(200.0 / np.pi, rel=0.003)
    assert row.vertical_impulse_ns == pytest.approx(0.9 * 100.0 * 0.5 * 2.0 / np.pi, rel=1e-4)
    # A sine rises from 20 to 80 % in (asin 0.8 - asin 0.2) / pi of the half period.
    rise = (np.arcsin(0.8) - np.arcsin(0.2)) / np.pi * 0.5
    assert row.loading_rate_nps == pytest.approx(60.0 / rise, rel=1e-3)
    assert row.friction_use == pytest.approx(0.2)
    # In the first 50 ms the sine reaches sin(pi / 10); its median is sin(pi / 4).
    assert row.impact_ratio == pytest.approx(np.sin(np.pi / 10) / np.sin(np.pi / 4), rel=0.02)


def test_an_impact_stands_out_of_the_stance() -> None:
    force = np.array([0.0, 300.0, 100.0, 100.0, 100.0, 100.0, 100.0, 0.0])
    assert reduce_stance(stance(force, 0.04)).impact_ratio == pytest.approx(3.0)


def test_an_unknown_direction_leaves_only_the_magnitude() -> None:
    samples = stance(np.array([0.0, 50.0, 60.0, 0.0]), 0.01)
    samples = samples._replace(vertical=np.array([0.0, 50.0, np.nan, 0.0]))
    row = reduce_stance(samples)
    assert row.peak_n == 60.0
    assert np.isnan([row.peak_vertical_n, row.mean_vertical_n, row.vertical_impulse_ns]).all()


def test_the_impulse_uses_real_sample_times() -> None:
    time = np.array([0.0, 0.001, 0.5, 1.0])
    assert trapezoid(2.0 * time, time) == pytest.approx(1.0)


def test_a_ramp_has_its_slope_as_loading_rate() -> None:
    time: Floats = np.arange(20, dtype=np.float64) * 0.01
    force = np.minimum(time * 500.0, 50.0)
    assert loading_rate(time, force) == pytest.approx(500.0)


def test_a_load_that_jumps_within_one_interval_has_no_known_rate() -> None:
    time: Floats = np.arange(5, dtype=np.float64) * 0.01
    assert np.isnan(loading_rate(time, np.array([0.0, 80.0, 80.0, 80.0, 80.0])))


def test_a_ripple_on_the_rise_is_not_the_first_peak() -> None:
    time: Floats = np.arange(12, dtype=np.float64) * 0.01
    force = np.array([0.0, 10.0, 20.0, 19.0, 30.0, 50.0, 70.0, 90.0, 100.0, 90.0, 80.0, 70.0])
    # 20 at sample 2, 80 half-way between samples 6 and 7.
    assert loading_rate(time, force) == pytest.approx(60.0 / 0.045)


def test_travel_is_measured_between_tenth_and_nine_tenths() -> None:
    time = np.linspace(0.0, 1.0, 11)
    assert contact_travel(time, 0.5 * time, 0.0 * time, 1.0) == pytest.approx(0.4)


def test_travel_needs_contact_points_on_both_sides() -> None:
    time = np.linspace(0.0, 1.0, 11)
    late = np.where(time > 0.3, 0.0, np.nan)
    assert np.isnan(contact_travel(time, late, late, 1.0))


def test_quantiles_are_interpolated() -> None:
    assert quantile(np.array([0.0, 10.0]), 0.25) == 2.5
    assert quantile(np.array([7.0]), 0.95) == 7.0
