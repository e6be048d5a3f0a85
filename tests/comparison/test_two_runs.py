"""Runs with known differences: which are found, and none that are not there."""

import numpy as np
import pytest

from dogbot_logtool.comparison.walks import (
    MetricDifference,
    RunStrides,
    metric_differences,
)

STEP_S = 0.002


def run(
    seed: int, *, strides: int = 40, duty: float = 0.6, peak_n: float = 150.0, name: str = ""
) -> RunStrides:
    """Make a run of two feet whose strides vary by 2 %, at sampled times."""
    random = np.random.default_rng(seed)
    period = random.normal(0.8, 0.016, 2 * strides)
    stance = np.round(duty * period / STEP_S) * STEP_S
    swing = np.round((period - stance) / STEP_S) * STEP_S
    columns = {
        "start_s": np.arange(2.0 * strides),
        "stance_s": stance,
        "swing_s": swing,
        "duty_factor": stance / (stance + swing),
        "peak_force_n": random.normal(peak_n, 0.05 * peak_n, 2 * strides),
        "length_m": np.full(2 * strides, np.nan),
    }
    return RunStrides(
        name or str(seed), ("left",) * strides + ("right",) * strides, columns, STEP_S
    )


def differing(first: RunStrides, second: RunStrides) -> list[MetricDifference]:
    return [each for each in metric_differences([first], [second]) if each.differs]


@pytest.mark.parametrize("seed", range(3))
def test_runs_of_one_kind_do_not_differ(seed: int) -> None:
    assert differing(run(seed), run(seed + 100)) == []


def test_a_duty_factor_changed_by_five_per_cent_is_found() -> None:
    found = differing(run(1), run(2, duty=0.63))

    assert {each.metric for each in found} == {"duty_factor", "stance_s", "swing_s"}
    duty = next(each for each in found if each.metric == "duty_factor")
    assert duty.difference == pytest.approx(0.03, abs=0.003)
    assert duty.interval[0] < 0.03 < duty.interval[1]


def test_the_largest_effect_comes_first() -> None:
    found = metric_differences([run(1)], [run(2, duty=0.75, peak_n=165.0)])
    effects = [abs(each.effect) for each in found if each.differs]
    assert effects == sorted(effects, reverse=True)
    assert [each.differs for each in found] == sorted((e.differs for e in found), reverse=True)


def test_a_difference_below_the_sampling_interval_is_none() -> None:
    constant = {"stance_s": np.full(40, 0.5), "swing_s": np.full(40, 0.3)}
    later = {"stance_s": np.full(40, 0.502), "swing_s": np.full(40, 0.298)}
    sides = [RunStrides("", ("left",) * 40, columns, 0.004) for columns in (constant, later)]
    assert differing(*sides) == []


def test_a_step_beyond_it_is_one() -> None:
    constant = {"stance_s": np.full(40, 0.5), "swing_s": np.full(40, 0.3)}
    later = {"stance_s": np.full(40, 0.52), "swing_s": np.full(40, 0.28)}
    sides = [RunStrides("", ("left",) * 40, columns, 0.004) for columns in (constant, later)]
    assert {each.metric for each in differing(*sides)} == {"stance_s", "swing_s"}


def test_too_few_strides_and_unknown_figures_are_not_compared() -> None:
    assert metric_differences([run(1, strides=4)], [run(2)]) == []
    assert "length_m" not in {each.metric for each in metric_differences([run(1)], [run(2)])}


def test_feet_of_one_side_only_are_not_compared() -> None:
    other = RunStrides("", ("nose",) * 80, run(2).columns, STEP_S)
    assert metric_differences([run(1)], [other]) == []


def test_groups_are_as_their_strides_together() -> None:
    one, other = run(3, strides=20), run(4, strides=20)
    (left, *_) = metric_differences([one, other], [run(5)])
    assert left.strides == (40, 40)


def test_it_is_the_same_every_time() -> None:
    assert metric_differences([run(1)], [run(2)]) == metric_differences([run(1)], [run(2)])
