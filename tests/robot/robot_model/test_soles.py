"""Soles are where feet touch the ground."""

from collections.abc import Mapping

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import TransformBuffer
from dogbot_logtool.robot.frames.world_frames import WorldFrames
from dogbot_logtool.robot.robot_model.skeleton import Point
from dogbot_logtool.robot.robot_model.soles import find_soles


def samples(position: Floats) -> Samples:
    count = len(position)
    time = np.arange(count) * 2_000_000
    return Samples(
        foot=np.zeros(count, np.int64),
        log_time=time,
        stamp=time,
        in_contact=np.isfinite(position[:, 0]),
        force=np.tile([0.0, 0.0, 50.0], (count, 1)),
        in_world=np.zeros(count, np.bool_),
        points=np.ones(count, np.int64),
        position=position,
        normal=np.tile([0.0, 0.0, 1.0], (count, 1)),
    )


def found(position: Floats) -> Mapping[int, Point]:
    frames = WorldFrames(
        links=("base_link",),
        points=(None,),
        world="world",
        base="base_link",
        odometry_places_base=True,
        moving={},
        statics=TransformBuffer(),
        clock=TimeSource.HEADER,
    )
    return find_soles([samples(position)], frames, TransformBuffer(), in_base={0})


def points(x: Floats) -> Floats:
    return np.stack([x, np.zeros(len(x)), np.full(len(x), -0.3)], axis=1)


@pytest.mark.parametrize("count", [7, 200, 201, 1001, 40001])
def test_a_foot_that_rolls_touches_in_the_middle(count: int) -> None:
    rolled = points(np.linspace(-0.05, 0.05, count))
    assert found(rolled)[0] == pytest.approx((0.0, 0.0, -0.3), abs=0.001)


def test_few_or_scattered_points_are_no_sole() -> None:
    assert found(points(np.zeros(4))) == {}
    assert found(points(np.linspace(-0.5, 0.5, 500))) == {}
    assert found(points(np.full(500, np.nan))) == {}
    assert found(points(np.full(500, 2.0))) == {}
