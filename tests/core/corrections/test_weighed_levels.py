"""What a known weight says of what sensors read without load."""

from dogbot_logtool.core.corrections.sensor import SensorLevel
from dogbot_logtool.core.corrections.weighed_levels import (
    TURNED,
    turned_levels,
    weighed_levels,
)

WEIGHT_N = 200.0


def alternating(offset_n: float) -> SensorLevel:
    """One of four feet that carry 50 N each, on a sensor that reads an offset besides."""
    other = SensorLevel(zero_in_swing=True, mean_n=50.0, mean_recorded_n=50.0 + offset_n)
    return SensorLevel(zero_in_swing=True, reason="two loads alternate", alternative=other)


def test_the_lower_load_is_none_if_only_so_all_add_up_to_the_weight() -> None:
    levels = weighed_levels((alternating(20.0),) * 4, WEIGHT_N)
    assert [level.reason for level in levels] == [""] * 4


def test_loads_that_add_up_to_the_weight_as_they_are_stay() -> None:
    levels = (alternating(0.0),) * 4
    assert weighed_levels(levels, WEIGHT_N) == levels


def test_nothing_is_decided_without_a_weight_or_against_it() -> None:
    levels = (alternating(20.0),) * 4
    assert weighed_levels(levels, None) == levels
    assert weighed_levels(levels, 300.0) == levels


def two_ways(
    mean_n: float, other_n: float, *, raises: bool = True, lead: float = 2.0
) -> SensorLevel:
    """One of four feet on a sensor that may be mounted either way round."""
    other = SensorLevel(zero_in_swing=True, mean_n=other_n, raises=not raises, lead=lead)
    return SensorLevel(
        mean_n=mean_n, origin="estimated",
        mean_recorded_n=mean_n, raises=raises, lead=lead, opposite=other,
    )  # fmt: skip


def test_the_way_round_that_adds_up_to_the_weight_is_right() -> None:
    right = turned_levels([two_ways(50.0, 80.0)] * 4, WEIGHT_N)
    turned = turned_levels([two_ways(80.0, 50.0)] * 4, WEIGHT_N)
    assert [level.raises for level in (*right, *turned)] == [True] * 4 + [False] * 4
    assert [level.mean_n for level in (*right, *turned)] == [50.0] * 8


def test_a_foot_is_mounted_as_the_others_are() -> None:
    feet = [two_ways(50.0, 80.0)] * 3 + [two_ways(80.0, 50.0, raises=False)]
    assert [level.mean_n for level in turned_levels(feet, None)] == [50.0] * 4


def test_levels_that_look_alike_both_ways_are_not_known() -> None:
    feet = turned_levels([two_ways(50.0, 60.0, lead=0.5)] * 4, None)
    assert [level.refuted for level in feet] == [TURNED] * 4


def test_a_wrong_mass_turns_no_clear_level() -> None:
    clear = [two_ways(50.0, 60.0, lead=9.0)] * 4
    assert turned_levels(clear, 240.0) == tuple(clear)
    assert weighed_levels(tuple(clear), 160.0) == tuple(clear)
