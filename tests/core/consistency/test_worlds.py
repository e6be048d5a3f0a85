"""Where the base is among its feet, of walks whose places are known in closed form."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.consistency.worlds import compare_worlds
from dogbot_logtool.core.contact.track import FootTrack, foot_track
from dogbot_logtool.core.corrections.clock import TimeSource
from tests.core.load.feet import samples_of

CORNERS = ((0.3, 0.15), (0.3, -0.15), (-0.3, 0.15), (-0.3, -0.15))
SPREAD_M = float(np.hypot(0.3, 0.15))
PERIOD_S, DUTY = 0.8, 0.6
SPEED_MPS = 0.5


def ns(seconds: Floats) -> Ints:
    return np.round(seconds * 1e9).astype(np.int64)


def path(seconds: Floats, turn_radps: float) -> tuple[Floats, Floats]:
    """Position and yaw of a base that walks along a circle, or straight on."""
    yaw = turn_radps * seconds
    if turn_radps == 0.0:
        return np.column_stack([SPEED_MPS * seconds, 0.0 * seconds]), yaw
    radius = SPEED_MPS / turn_radps
    return radius * np.column_stack([np.sin(yaw), 1.0 - np.cos(yaw)]), yaw


def base(
    seconds: float,
    turn_radps: float = 0.0,
    shift: Sequence[float] = (0.0, 0.0),
    drift: Sequence[float] = (0.0, 0.0),
) -> BaseHistory:
    """Poses at 100 Hz, displaced, and drifting by so much over the log."""
    time = np.arange(round(seconds * 100.0) + 1) / 100.0
    position, yaw = path(time, turn_radps)
    position = position + np.array(shift) + np.outer(time / seconds, drift)
    flat = np.zeros_like(time)
    return BaseHistory(
        messages=len(time),
        not_usable=0,
        not_advancing=0,
        time=ns(time),
        position=np.column_stack([position, flat + 0.4]),
        angles=np.column_stack([flat, flat, yaw]),
        gaps=timespans.no_spans(),
    )


def foot(corner: Sequence[float], phase: float, seconds: float, turn_radps: float) -> FootTrack:
    """Contact points at 25 Hz; each stance lies about its corner as the base passes over it."""
    time = np.arange(round(seconds * 25.0)) / 25.0
    cycle = time / PERIOD_S - phase
    middle = (np.floor(cycle) + phase + DUTY / 2.0) * PERIOD_S
    position, yaw = path(middle, turn_radps)
    x = position[:, 0] + corner[0] * np.cos(yaw) - corner[1] * np.sin(yaw)
    y = position[:, 1] + corner[0] * np.sin(yaw) + corner[1] * np.cos(yaw)
    point = np.column_stack([x, y, np.zeros_like(x)])
    point[cycle % 1.0 >= DUTY] = np.nan
    none = np.zeros_like(time)
    samples = replace(samples_of(time, none), log_time=ns(time), position=point)
    return foot_track(samples, TimeSource.LOG, force_in_world=True)[0]


def feet(seconds: float = 20.0, turn_radps: float = 0.0) -> list[FootTrack]:
    return [
        foot(corner, phase, seconds, turn_radps)
        for corner, phase in zip(CORNERS, (0.0, 0.5, 0.5, 0.0), strict=True)
    ]


@pytest.mark.parametrize("turn_radps", [0.0, 0.3])
@pytest.mark.parametrize("seconds", [3.0, 20.0, 200.0])
def test_a_walk_in_one_world_agrees(turn_radps: float, seconds: float) -> None:
    worlds = compare_worlds(feet(seconds, turn_radps), base(seconds, turn_radps))
    assert worlds is not None
    assert worlds.agree
    assert worlds.spread_m == pytest.approx(SPREAD_M, abs=0.03)
    assert worlds.distance_m < 0.05
    assert worlds.change_m < 0.06


@pytest.mark.parametrize("shift", [(0.5, 0.0), (0.0, -0.5), (-3.0, 4.0)])
@pytest.mark.parametrize("turn_radps", [0.0, 0.3])
def test_another_world_is_told_by_its_distance(shift: Sequence[float], turn_radps: float) -> None:
    worlds = compare_worlds(feet(20.0, turn_radps), base(20.0, turn_radps, shift))
    assert worlds is not None
    assert not worlds.agree
    assert worlds.distance_m == pytest.approx(float(np.hypot(shift[0], shift[1])), rel=0.1)


def test_a_drift_is_told_before_the_base_is_beyond_its_feet() -> None:
    worlds = compare_worlds(feet(), base(20.0, drift=(0.0, 0.3)))
    assert worlds is not None
    assert worlds.beyond_fraction == 0.0
    assert worlds.change_m == pytest.approx(0.2, abs=0.03)
    assert not worlds.agree


def test_a_small_drift_is_none_of_consequence() -> None:
    worlds = compare_worlds(feet(), base(20.0, drift=(0.0, 0.1)))
    assert worlds is not None
    assert worlds.agree


def test_without_contact_points_or_poses_nothing_is_known() -> None:
    blind = feet()
    for track in blind[1:]:
        track.point[:] = np.nan
    assert compare_worlds(blind, base(20.0)) is None
    assert compare_worlds([], base(20.0)) is None
    elsewhere = base(20.0)
    elsewhere.time[:] += 10**12
    assert compare_worlds(feet(), elsewhere) is None


@pytest.mark.parametrize(("shift", "agree"), [((0.0, 0.0), True), ((3.0, 0.0), False)])
def test_some_feet_only_tell_contact_points(shift: tuple[float, float], agree: bool) -> None:  # noqa: FBT001
    """The base is far from the hind pair, but in its world."""
    tracks = feet(12.0)
    silent = [replace(each, point=np.full_like(each.point, np.nan)) for each in tracks[:2]]
    worlds = compare_worlds([*silent, *tracks[2:]], base(12.0, shift=shift))
    assert worlds is not None
    assert worlds.distance_m == pytest.approx(np.hypot(0.3 + shift[0], shift[1]), abs=0.05)
    assert worlds.agree == agree
