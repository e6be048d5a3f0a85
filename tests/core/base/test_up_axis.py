"""Poses that lean while the robot walks on, and those of robots that fell."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.base.axes import leaning_walk_rad
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Stances
from tests.core.base.test_falls import base, foot


def stepping(period_s: float, until_s: float = 10.0, duty: float = 0.6) -> FootHistory:
    """Stand on a foot once a period, until it rests or hangs."""
    steps = np.arange(0.05, until_s, period_s)
    knots = [
        (at + part, load)
        for at in steps.tolist()
        for part, load in ((0.0, 0.0), (0.02, 90.0), (duty * period_s, 90.0))
    ]
    ends = [(at + duty * period_s + 0.02, 0.0) for at in steps.tolist()]
    return foot(sorted(knots + ends))


@pytest.mark.parametrize("turn", [((0.0, 1.57),), ((0.0, 0.0), (10.0, 3.1))])
def test_a_walk_on_a_back_that_leans(turn: tuple[tuple[float, float], ...]) -> None:
    feet = [stepping(0.8)] * 4
    assert leaning_walk_rad(base(((0.0, 0.4),), turn), feet) == pytest.approx(turn[-1][1], abs=0.01)


def test_steep_slopes_are_walked() -> None:
    assert leaning_walk_rad(base(((0.0, 0.4),), ((0.0, 0.6),)), [stepping(0.8)] * 4) is None


@pytest.mark.parametrize("after", [stepping(0.8, 5.0), stepping(0.8)])
def test_a_fall_is_none(after: FootHistory) -> None:
    """The robot lies still, or its legs go on."""
    fallen = base(((0.0, 0.4),), ((5.0, 0.0), (5.5, 1.5)))
    assert leaning_walk_rad(fallen, [after] * 4) is None


def test_legs_that_kick_otherwise_do_not_walk() -> None:
    kicking = base(((0.0, 0.4),), ((3.0, 0.0), (6.0, 1.5)))
    before, after = stepping(0.8, 5.0), stepping(0.3)
    foot_of_both = replace(after, stances=_joined(before, after))
    assert leaning_walk_rad(kicking, [foot_of_both] * 4) is None


def _joined(before: FootHistory, after: FootHistory) -> Stances:
    later = after.stances.touchdown > 5.5e9
    both = before.stances, after.stances
    touchdown, liftoff = (
        np.concatenate([getattr(both[0], name), getattr(both[1], name)[later]])
        for name in ("touchdown", "liftoff")
    )
    return replace(before.stances, touchdown=touchdown, liftoff=liftoff)


def test_no_poses_lean_nowhere() -> None:
    assert leaning_walk_rad(base(((0.0, 0.4),)).without_poses(), [stepping(0.8)]) is None
