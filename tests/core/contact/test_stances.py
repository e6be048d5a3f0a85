import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.stance_samples import StanceSamples
from dogbot_logtool.core.contact.stances import reduce_stances


def stance(force: Floats, time: Floats | float, x: Floats | None = None) -> StanceSamples:
    """A stance whose first sample is the one before touchdown and last the one after lift-off.

    Times are given, s, or how far apart they are.
    """
    count = len(force)
    if isinstance(time, float):
        time = (np.arange(count, dtype=np.float64) - 1.0) * time
    return StanceSamples(
        first=np.array([0]),
        touchdown=np.array([1]),
        end=np.array([count - 1]),
        stance=np.zeros(count, np.int64),
        time=time,
        force=force,
        vector=force[:, None] * np.array([-0.1, 0.2, 0.9]),
        point=np.zeros(count, np.complex128) if x is None else x.astype(np.complex128),
        single=np.ones(count, np.bool_),
        friction=np.where(force >= 10.0, 0.2, np.nan),
    )


def figures(samples: StanceSamples) -> dict[str, float]:
    """Of a single stance."""
    return {name: float(value[0]) for name, value in reduce_stances(samples)._asdict().items()}


def loading_rate(force: Floats, step: float) -> float:
    """Of a load that ends with the last one given."""
    return figures(stance(np.append(force, 0.0), step))["loading_rate_nps"]


def test_a_half_sine_has_its_closed_form_figures() -> None:
    time = np.linspace(0.0, 0.5, 501)
    force = 100.0 * np.sin(np.pi * time / 0.5)
    force[0] = force[-1] = 0.0
    row = figures(stance(force, 0.001))
    assert row["peak_force_n"] == pytest.approx(100.0, rel=1e-5)
    assert row["mean_force_n"] == pytest.approx(200.0 / np.pi, rel=0.003)
    assert row["vertical_impulse_ns"] == pytest.approx(0.9 * 100.0 * 0.5 * 2.0 / np.pi, rel=1e-4)
    # A sine rises from 20 to 80 % in (asin 0.8 - asin 0.2) / pi of the half period.
    rise = (np.arcsin(0.8) - np.arcsin(0.2)) / np.pi * 0.5
    assert row["loading_rate_nps"] == pytest.approx(60.0 / rise, rel=1e-3)
    assert row["friction_use"] == pytest.approx(0.2)
    # In the first 50 ms the sine reaches sin(pi / 10); its median is sin(pi / 4).
    impact = np.sin(np.pi / 10) / np.sin(np.pi / 4)
    assert row["impact_ratio"] == pytest.approx(impact, rel=0.02)


def test_an_impact_stands_out_of_the_stance() -> None:
    force = np.array([0.0, 300.0, 100.0, 100.0, 100.0, 100.0, 100.0, 0.0])
    assert figures(stance(force, 0.04))["impact_ratio"] == pytest.approx(3.0)


def test_an_unknown_direction_leaves_only_the_magnitude() -> None:
    samples = stance(np.array([0.0, 50.0, 60.0, 0.0]), 0.01)
    samples.vector[2] = np.nan
    row = figures(samples)
    assert row["peak_force_n"] == 60.0
    vertical = [row[name] for name in row if "vertical" in name]
    assert len(vertical) == 4
    assert np.isnan(vertical).all()


def test_a_ramp_has_its_slope_as_loading_rate() -> None:
    time: Floats = np.arange(20, dtype=np.float64) * 0.01
    assert loading_rate(np.minimum(time * 500.0, 50.0), 0.01) == pytest.approx(500.0)


def test_a_load_that_jumps_within_one_interval_has_no_known_rate() -> None:
    assert np.isnan(loading_rate(np.array([0.0, 80.0, 80.0, 80.0, 80.0]), 0.01))


def test_a_ripple_on_the_rise_is_not_the_first_peak() -> None:
    force = np.array([0.0, 10.0, 20.0, 19.0, 30.0, 50.0, 70.0, 90.0, 100.0, 90.0, 80.0, 70.0])
    # 20 at sample 2, 80 half-way between samples 6 and 7.
    assert loading_rate(force, 0.01) == pytest.approx(60.0 / 0.045)


def travel(x: Floats) -> float:
    """Of points at times from 0 to 1 s in a stance that ends then."""
    time = np.concatenate([[-0.1], np.linspace(0.0, 1.0, len(x))])
    points = np.concatenate([[np.nan], x])
    return figures(stance(np.ones(len(time)), time, points))["contact_travel_m"]


def test_travel_is_measured_between_tenth_and_nine_tenths() -> None:
    assert travel(0.5 * np.linspace(0.0, 1.0, 11)) == pytest.approx(0.4)
    # The ends lie between samples now.
    assert travel(0.5 * np.linspace(0.0, 1.0, 13)) == pytest.approx(0.4)


def test_travel_needs_contact_points_on_both_sides() -> None:
    time = np.linspace(0.0, 1.0, 11)
    assert np.isnan(travel(np.where(time > 0.3, 0.0, np.nan)))
    assert np.isnan(travel(np.where(time < 0.7, 0.0, np.nan)))
    assert travel(np.where((time < 0.2) | (time > 0.7), time, np.nan)) == pytest.approx(0.8)
