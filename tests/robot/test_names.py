"""Which feet names tell of: real sets of topics, and what must not change the answer."""

import tomllib
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.robot.names import FootSet, label_names, name_feet

TABLE = tomllib.loads(Path(__file__).with_name("names.toml").read_text(encoding="utf-8"))
SIDES = ("left", "right")
CLEAR, UNSURE = TABLE["clear"], TABLE["unsure"]
"""Feet that are taken, and feet that are offered first."""


def topics(row: dict[str, Any]) -> list[str]:
    return [*row.get("others", ()), *row["feet"].values()]


def told(feet: FootSet | None) -> dict[str, str]:
    return {foot.name: foot.topic for foot in feet.feet} if feet else {}


@pytest.mark.parametrize("name", CLEAR)
def test_clear_feet_are_found(name: str) -> None:
    row = CLEAR[name]
    chosen, _ = name_feet(topics(row), contacts_only=row["contacts_only"])
    assert told(chosen) == row["feet"]
    assert list(told(chosen)) == list(row["feet"])


@pytest.mark.parametrize("name", UNSURE)
def test_feet_that_are_not_sure_are_offered(name: str) -> None:
    row = UNSURE[name]
    chosen, offered = name_feet(topics(row), contacts_only=row["contacts_only"])
    assert chosen is None
    assert told(offered[0]) == row["feet"]
    assert {topic for one in offered for topic in one.topics} == set(topics(row))


@pytest.mark.parametrize("name", TABLE["several"])
def test_sensors_of_one_foot_are_told_by_names(name: str) -> None:
    row = TABLE["several"][name]
    chosen, _ = name_feet([*row["left"], *row["right"]], contacts_only=row["contacts_only"])
    assert chosen is not None
    for side in SIDES:
        assert sorted(f.topic for f in chosen.feet if f.sensor_of == side) == row[side]


@pytest.mark.parametrize("name", TABLE["none"])
def test_what_is_no_foot_is_neither_chosen_nor_offered(name: str) -> None:
    row = TABLE["none"][name]
    chosen, offered = name_feet(topics(row), contacts_only=row["contacts_only"])
    assert (chosen, offered) == (None, ())


def test_labels_are_read_together() -> None:
    """Of six legs in lettered rows, B is the middle one, and no back."""
    told = label_names([f"{row}{side}_tip" for row in "ABC" for side in "LR"])
    assert [foot.name for foot in told] == [f"{side}_{row}" for row in "abc" for side in SIDES]
    assert {foot.leg_position for foot in told} == {None}


PREFIXES = (
    "/rl_controller",
    "/robot_1",
    "/feedback/left_lab",
    "/back",
    "/fl",
    "/left_leg_controller",
    "/my_arm/x",
    "/FrontEnd",
)
SUFFIXES = ("/data", "_raw", "/state", "/topic_2", "/rr", "/left", "/front")


@given(
    name=st.sampled_from(sorted(CLEAR)),
    prefix=st.lists(st.sampled_from(PREFIXES), max_size=3).map("".join),
    suffix=st.sampled_from(("", *SUFFIXES)),
    order=st.randoms(use_true_random=False),
)
def test_what_all_names_share_changes_nothing(
    name: str, prefix: str, suffix: str, order: Random
) -> None:
    row = CLEAR[name]

    def longer(topic: str) -> str:
        return f"{prefix}{'/' if prefix and topic[0] != '/' else ''}{topic}{suffix}"

    names = [longer(topic) for topic in topics(row)]
    order.shuffle(names)
    chosen, _ = name_feet(names, contacts_only=row["contacts_only"])
    assert told(chosen) == {leg: longer(topic) for leg, topic in row["feet"].items()}


@given(st.lists(st.text(max_size=20), max_size=8), st.booleans())
def test_any_names_will_do(names: list[str], contacts_only: bool) -> None:  # noqa: FBT001
    chosen, offered = name_feet(names, contacts_only=contacts_only)
    sets = [*([chosen] if chosen else []), *offered]
    for one in sets:
        assert one.topics <= set(names)
        assert all(name.replace("_", "").isalnum() for name in told(one))
        assert len(told(one)) == len(one.feet)


@pytest.mark.parametrize(
    "pattern", ["/leg_{}", "/left/left/left_lf_lf_front_left_front_left_{}", "/x{}/left_foot"]
)
def test_many_names_come_to_an_end(pattern: str) -> None:
    """Comparing each name with each other one would take hours."""
    name_feet([pattern.format(number) for number in range(6_000)], contacts_only=True)
