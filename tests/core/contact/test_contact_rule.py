"""Which thresholds a sensor gets, and when it can tell no contact."""

from dataclasses import replace

import pytest

from dogbot_logtool.core.contact.contact_rule import FootSensor, contact_rule
from dogbot_logtool.core.corrections.modes import WIDE
from dogbot_logtool.core.corrections.sensor import SensorLevel

WEIGHT_N = 200.0
UNKNOWN = replace(
    SensorLevel(zero_in_swing=True),
    zero_in_swing=False,
    reason=WIDE,
    loaded_n=60.0,
    lightest_n=3.0,
    heaviest_n=70.0,
)


def test_loads_that_come_and_go_around_an_unknown_level_tell_no_contact() -> None:
    assert "comes and goes" in contact_rule(UNKNOWN, WEIGHT_N).unusable


@pytest.mark.parametrize("changed", [{"reason": ""}, {"lightest_n": 40.0}])
def test_known_levels_and_steady_loads_tell_it(changed: dict[str, float]) -> None:
    assert contact_rule(replace(UNKNOWN, **changed), WEIGHT_N).unusable == ""  # type: ignore[arg-type]


def test_a_load_that_varies_less_than_a_contact_is_steady() -> None:
    def sensor(level: SensorLevel) -> FootSensor:
        return FootSensor(level, contact_rule(level, WEIGHT_N))

    assert sensor(replace(UNKNOWN, lightest_n=65.0)).is_steady
    assert not sensor(UNKNOWN).is_steady


def test_swings_much_shorter_than_usual_are_filled() -> None:
    rule = contact_rule(
        replace(SensorLevel(zero_in_swing=True), swing_s=0.8, interval_s=0.02), WEIGHT_N
    )
    assert rule.debounce_s == pytest.approx(0.03)
    assert rule.fill_s == pytest.approx(0.05)


@pytest.mark.parametrize(("loaded_n", "told"), [(20.0, ""), (19.99, "more than half")])
def test_contact_may_need_half_of_the_usual_load_and_no_more(loaded_n: float, told: str) -> None:
    rule = contact_rule(replace(SensorLevel(zero_in_swing=True), loaded_n=loaded_n), WEIGHT_N)
    assert rule.on_n == 10.0
    assert rule.unusable == "" if not told else told in rule.unusable
