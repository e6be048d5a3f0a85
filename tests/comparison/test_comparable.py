"""What keeps runs from being compared."""

from typing import Any

import pytest

from dogbot_logtool.comparison.walks import doubts, why_not_comparable


def log(
    gait: str | None = "trot",
    speed: float | None = 0.5,
    mass: float | None = 20.0,
    strides: int = 30,
    feet: tuple[str, ...] = ("left", "right"),
) -> dict[str, Any]:
    return {
        "log": {"path": "a.bag"},
        "settings": {"mass_kg": mass},
        "base": {"forward_speed_mps": speed},
        "feet": {foot: {"strides": strides} for foot in feet},
        "gait": {"name": gait},
        "quality": {"checks": [{"name": "one world", "outcome": "passed"}]},
    }


def test_runs_of_one_kind_are_comparable() -> None:
    assert why_not_comparable([log()], [log(speed=0.55), log(speed=0.45)]) == []


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (log("walk"), "the gaits differ: trot against walk"),
        (log(None), "the gaits differ: trot against not known"),
        (log(speed=0.8), "the speeds differ: 0.50 m/s against 0.80 m/s"),
        (log(mass=25.0), "the masses differ: 20 kg, 25 kg"),
        (log(mass=None), "the masses differ: 20 kg"),
        (log(strides=4), "side 2 has 8 strides of 2 feet: too few"),
        (log(feet=("left", "nose")), "the robots have different feet"),
    ],
)
def test_a_difference_is_named(other: dict[str, Any], says: str) -> None:
    assert why_not_comparable([log()], [other]) == [says]


def test_an_unknown_speed_keeps_nothing_from_being_compared() -> None:
    assert why_not_comparable([log(speed=None)], [log()]) == []


def test_checks_that_failed_are_doubts() -> None:
    bad = log()
    bad["quality"]["checks"].append({"name": "one clock", "outcome": "failed"})
    assert list(doubts([log(), bad])) == ["a.bag: one clock does not hold"]
