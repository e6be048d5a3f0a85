"""Forces and places of feet, told by frames: against poses that are known in closed form."""

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.wrench_frame import (
    FrameCounts,
    FramePoint,
    forces_in_world,
    points_from_frames,
)
from dogbot_logtool.core.rotations import rotate
from tests.core.frames.turning import MS, about_x, about_z, at, spinning

HEADER = TimeSource.HEADER


def link_samples(time: Ints) -> Samples:
    """Forces of 50 N straight up in the world, as the link of `spinning` sees them."""
    seconds = time / 1e9
    up = np.tile([0.0, 0.0, 50.0], (len(time), 1))
    in_base = rotate(about_z(-seconds), up)
    force = rotate(about_x(np.full(len(time), -0.3)), in_base)
    yes, points = np.ones(len(time), np.bool_), np.full((len(time), 3), np.nan)
    foot = np.zeros(len(time), np.int64)
    return Samples(foot, time, time, yes, force, ~yes, foot, points, points)


def test_forces_are_turned_where_transforms_tell() -> None:
    samples = link_samples(at(*range(0, 400, 7)))
    buffer = spinning(at(*range(20, 400, 20)))
    turned, counts = forces_in_world(samples, ["leg"], buffer, "world", HEADER)
    inside = (samples.stamp >= 20 * MS) & (samples.stamp <= 380 * MS)
    assert turned.in_world.tolist() == inside.tolist()
    vertical = np.tile([0.0, 0.0, 50.0], (int(inside.sum()), 1))
    np.testing.assert_allclose(turned.force[inside], vertical, atol=1e-9)
    np.testing.assert_array_equal(turned.force[~inside], samples.force[~inside])
    assert counts == FrameCounts(turned=int(inside.sum()), not_turned=int((~inside).sum()))


def test_a_foot_without_a_link_passes_as_it_is() -> None:
    samples = link_samples(at(0, 10))
    passed, counts = forces_in_world(samples, [None], spinning(at(0, 20)), "world", HEADER)
    np.testing.assert_array_equal(passed.force, samples.force)
    assert not passed.in_world.any()
    assert counts == FrameCounts()


def test_sensors_stand_where_their_frames_are() -> None:
    samples = link_samples(at(0, 10, 50))
    point = FramePoint("leg", (0.0, 0.0, -0.1))
    placed, counts = points_from_frames(samples, [point], spinning(at(0, 20)), "world", HEADER)
    angle = np.array([0.0, 0.01])
    # One metre beside the base, and a tenth along the bent leg.
    beside, down = 1.0 + 0.1 * np.sin(0.3), -0.1 * np.cos(0.3)
    expected = np.stack(
        [2.0 * angle - beside * np.sin(angle), beside * np.cos(angle), np.full(2, down)], axis=1
    )
    np.testing.assert_allclose(placed.position[:2], expected, atol=1e-12)
    assert placed.points.tolist() == [1, 1, 0]
    assert np.isnan(placed.position[2]).all()
    assert counts == FrameCounts(placed=2, not_placed=1)
