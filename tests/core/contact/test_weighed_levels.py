"""What a known weight says of what sensors read without load."""

from dataclasses import replace

from dogbot_logtool.core.contact.sensor_level import SensorLevel, zero_reading
from dogbot_logtool.core.contact.weighed_levels import weighed_levels

WEIGHT_N = 200.0


def alternating(offset_n: float) -> SensorLevel:
    """One of four feet that carry 50 N each, on a sensor that reads an offset besides."""
    other = replace(zero_reading(), mean_n=50.0, mean_recorded_n=50.0 + offset_n)
    return replace(zero_reading(), reason="two loads alternate", alternative=other)


def test_the_lower_load_is_none_if_only_so_all_add_up_to_the_weight() -> None:
    levels = weighed_levels([alternating(20.0)] * 4, WEIGHT_N)
    assert [level.reason for level in levels] == [""] * 4


def test_loads_that_add_up_to_the_weight_as_they_are_stay() -> None:
    levels = [alternating(0.0)] * 4
    assert weighed_levels(levels, WEIGHT_N) == tuple(levels)


def test_nothing_is_decided_without_a_weight_or_against_it() -> None:
    levels = [alternating(20.0)] * 4
    assert weighed_levels(levels, None) == tuple(levels)
    assert weighed_levels(levels, 300.0) == tuple(levels)
