"""Falls and what only looks like one: known heights, attitudes and loads."""

from collections.abc import Sequence

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.falls import fallen_spans, find_tipping
from dogbot_logtool.core.base.poses import BaseHistory, find_jumps
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


def base(height: Knots, roll: Knots) -> BaseHistory:
    time, zero = times(), np.zeros_like(times())
    return BaseHistory(
        time=np.round(time * 1e9).astype(np.int64),
        position=np.stack([zero, zero, curve(height)], axis=1),
        angles=np.stack([curve(roll), zero, zero], axis=1),
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


UPRIGHT: Knots = ((0.0, 0.0),)
TOPPLES: Knots = ((4.0, 0.0), (4.8, 1.5))
TWICE: Knots = ((2.0, 0.0), (2.5, 1.5), (4.0, 1.5), (5.0, 0.0), (7.0, 0.0), (7.5, 1.5))
CARRIED: Knots = ((1.9, 200.0), (2.0, 0.0))
PUT_DOWN: Knots = (*CARRIED, (5.4, 0.0), (5.5, 200.0))
LIFTED: Knots = ((2.0, 0.45), (3.0, 1.2), (5.0, 1.2), (5.4, 0.45))


@pytest.mark.parametrize(
    ("name", "height", "roll", "load", "onsets"),
    [
        ("collapses", [(4.0, 0.45), (4.3, 0.1)], UPRIGHT, LOADED, [4.0]),
        ("topples over", [(4.0, 0.45), (4.8, 0.15)], TOPPLES, LOADED, [4.0]),
        ("topples over, height unknown", [(0.0, np.nan)], TOPPLES, LOADED, [4.0]),
        ("falls twice", STANDS, TWICE, LOADED, [2.0, 7.0]),
        ("sits down", [(3.0, 0.45), (5.0, 0.14)], UPRIGHT, LOADED, []),
        ("sits down fast, upright", [(3.0, 0.6), (4.2, 0.18)], UPRIGHT, LOADED, []),
        ("stands up", [(3.0, 0.14), (5.0, 0.45)], UPRIGHT, LOADED, []),
        ("lies, then is turned upright", STANDS, [(3.0, 1.5), (4.0, 0.0)], LOADED, []),
        ("crouches", [(2.0, 0.45), (2.5, 0.22), (4.0, 0.22), (4.5, 0.45)], UPRIGHT, LOADED, []),
        ("is carried on its side", [(2.0, 0.45), (3.0, 1.0)], TOPPLES, CARRIED, []),
        ("is lifted and put down fast", LIFTED, UPRIGHT, PUT_DOWN, []),
        ("is localised anew", [(4.0, 0.45), (4.005, 0.05)], UPRIGHT, LOADED, []),
        ("leans by 50 degrees", STANDS, [(3.0, 0.0), (4.0, np.radians(50.0))], LOADED, []),
        ("climbs down", [(2.0, 1.45), (8.0, 0.45)], UPRIGHT, LOADED, []),
    ],
)
def test_falls_begin_with_the_descent_and_nothing_else_is_one(
    name: str, height: Knots, roll: Knots, load: Knots, onsets: list[float]
) -> None:
    history, over_feet = base(height, roll=roll), curve(height)
    history.position[:, 2] = np.nan_to_num(over_feet, nan=0.45)
    spans = fallen_spans(history, [foot(load)], over_feet, find_jumps(history).spans)
    assert spans[:, 0] / 1e9 == pytest.approx(onsets, abs=0.1), name


SWAYS: Knots = [(each / 2.0, 0.02 * (-1.0) ** each) for each in range(18)]


@pytest.mark.parametrize(
    ("name", "roll", "forward_rad", "tips"),
    [
        ("tips as the log ends", [*SWAYS, (9.0, 0.02), (10.0, 0.4)], 0.0, ("roll", 0.4)),
        ("about its own axis", [(9.0, 0.0), (10.0, 0.4)], np.pi / 2.0, ("pitch", -0.4)),
        ("still", [(0.0, 0.0)], 0.0, None),
        ("returns", [(8.5, 0.0), (9.0, 0.4), (9.5, 0.0)], 0.0, None),
        ("usual", [(1.0, 0.0), (1.5, 0.5), (2.0, 0.0), (9.0, 0.0), (10.0, 0.4)], 0.0, None),
        ("a ramp", [(8.5, 0.0), (9.3, 0.3)], 0.0, None),
    ],
)
def test_tipping_leaves_the_usual_range_and_goes_on(
    name: str, roll: Knots, forward_rad: float, tips: tuple[str, float] | None
) -> None:
    found = find_tipping(base(STANDS, roll=roll), forward_rad)
    assert (found and (found.angle, round(found.last_rad, 6))) == tips, name
    assert found is None or found.since / 1e9 == pytest.approx(9.0, abs=0.3)
