"""Falls and what only looks like one: known heights, attitudes and loads."""

from collections.abc import Sequence

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.falls import fallen_spans, find_tipping
from dogbot_logtool.core.base.jumps import find_jumps
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.corrections.clock import TimeSource

RATE_HZ = 100.0
SECONDS = 10.0
Knots = Sequence[tuple[float, float]]


def times() -> Floats:
    return np.arange(round(SECONDS * RATE_HZ) + 1) / RATE_HZ


def curve(knots: Knots) -> Floats:
    at, value = np.array(knots).T
    return np.asarray(np.interp(times(), at, value))


def base(height: Knots, roll: Knots = ((0.0, 0.0),), pitch: Knots = ((0.0, 0.0),)) -> BaseHistory:
    time, zero = times(), np.zeros_like(times())
    return BaseHistory(
        messages=len(time),
        not_usable=0,
        not_advancing=0,
        time=np.round(time * 1e9).astype(np.int64),
        position=np.stack([zero, zero, curve(height)], axis=1),
        angles=np.stack([curve(roll), curve(pitch), zero], axis=1),
        gaps=timespans.no_spans(),
    )


def foot(load: Knots) -> FootHistory:
    force = curve(load)
    count = len(force)
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    stamp = np.round(times() * 1e9).astype(np.int64)
    rule = ContactRule(10.0, 0.0, 0.02)
    return foot_history(
        Samples(
            foot=np.zeros(count, np.int64),
            log_time=stamp,
            stamp=stamp,
            in_contact=force > 0.0,
            force=up * force[:, None],
            in_world=np.zeros(count, np.bool_),
            points=np.ones(count, np.int64),
            position=0.0 * up,
            normal=up,
        ),
        rule,
        TimeSource.LOG,
        force_in_world=True,
    )


LOADED: Knots = ((0.0, 200.0),)
STANDS: Knots = ((0.0, 0.45),)


def falls(history: BaseHistory, load: Knots = LOADED, *, with_height: bool = True) -> list[float]:
    height = history.position[:, 2] if with_height else np.full(len(history.time), np.nan)
    spans = fallen_spans(history, [foot(load)], height, find_jumps(history).spans)
    return [each / 1e9 for each in spans[:, 0].tolist()]


def test_a_collapse_is_a_fall_from_the_time_it_begins() -> None:
    assert falls(base([(4.0, 0.45), (4.3, 0.1)])) == pytest.approx([4.0], abs=0.05)


@pytest.mark.parametrize("with_height", [True, False])
def test_toppling_over_is_a_fall_whether_the_height_is_known_or_not(*, with_height: bool) -> None:
    history = base([(4.0, 0.45), (4.8, 0.15)], roll=[(4.0, 0.0), (4.8, 1.5)])
    assert falls(history, with_height=with_height) == pytest.approx([4.0], abs=0.1)


def test_the_second_fall_counts_too() -> None:
    roll = [(2.0, 0.0), (2.5, 1.5), (4.0, 1.5), (5.0, 0.0), (7.0, 0.0), (7.5, 1.5)]
    assert falls(base(STANDS, roll=roll)) == pytest.approx([2.0, 7.0], abs=0.1)


@pytest.mark.parametrize(
    ("name", "height", "roll", "load"),
    [
        ("sits down", [(3.0, 0.45), (5.0, 0.14)], [(0.0, 0.0)], LOADED),
        ("sits down fast, upright", [(3.0, 0.6), (4.2, 0.18)], [(0.0, 0.0)], LOADED),
        ("stands up", [(3.0, 0.14), (5.0, 0.45)], [(0.0, 0.0)], LOADED),
        ("lies, then is turned upright", STANDS, [(3.0, 1.5), (4.0, 0.0)], LOADED),
        ("crouches", [(2.0, 0.45), (2.5, 0.22), (4.0, 0.22), (4.5, 0.45)], [(0.0, 0.0)], LOADED),
        (
            "is carried on its side",
            [(2.0, 0.45), (3.0, 1.0)],
            [(4.0, 0.0), (4.5, 1.5)],
            [(1.9, 200.0), (2.0, 0.0)],
        ),
        (
            "is lifted and put down fast",
            [(2.0, 0.45), (3.0, 1.2), (5.0, 1.2), (5.4, 0.45)],
            [(0.0, 0.0)],
            [(1.9, 200.0), (2.0, 0.0), (5.4, 0.0), (5.5, 200.0)],
        ),
        ("is localised anew", [(4.0, 0.45), (4.005, 0.05)], [(0.0, 0.0)], LOADED),
        ("leans by 50 degrees", STANDS, [(3.0, 0.0), (4.0, np.radians(50.0))], LOADED),
        ("climbs down", [(2.0, 1.45), (8.0, 0.45)], [(0.0, 0.0)], LOADED),
    ],
)
def test_what_is_no_fall(name: str, height: Knots, roll: Knots, load: Knots) -> None:
    assert falls(base(height, roll=roll), load) == [], name


def test_a_recording_that_ends_as_the_robot_tips_says_so_and_has_no_fall() -> None:
    sway = [(each / 2.0, 0.02 * (-1.0) ** each) for each in range(18)]
    history = base(STANDS, roll=[*sway, (9.0, 0.02), (10.0, 0.4)])
    assert falls(history) == []
    tipping = find_tipping(history, "+x")
    assert tipping is not None
    assert (tipping.angle, round(tipping.last_rad, 6)) == ("roll", 0.4)
    assert tipping.since / 1e9 == pytest.approx(9.0, abs=0.3)


def test_tipping_is_about_the_robots_own_axis() -> None:
    tipping = find_tipping(base(STANDS, roll=[(9.0, 0.0), (10.0, 0.4)]), "+y")
    assert tipping is not None
    assert (tipping.angle, round(tipping.last_rad, 6)) == ("pitch", -0.4)


@pytest.mark.parametrize(
    "roll",
    [
        [(0.0, 0.0)],
        [(8.5, 0.0), (9.0, 0.4), (9.5, 0.0)],
        [(1.0, 0.0), (1.5, 0.5), (2.0, 0.0), (9.0, 0.0), (10.0, 0.4)],
        [(8.5, 0.0), (9.3, 0.3)],
    ],
)
def test_what_is_no_tipping(roll: Knots) -> None:
    """Still, a lean that returns, one that is usual, and one that stays (a ramp)."""
    assert find_tipping(base(STANDS, roll=roll), "+x") is None
