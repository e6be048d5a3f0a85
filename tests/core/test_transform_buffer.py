import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.transform_buffer import (
    ForcesToWorld,
    TransformBuffer,
)

MS = 1_000_000


def about_z(angle: Floats) -> Floats:
    zero = np.zeros_like(angle)
    return np.stack([zero, zero, np.sin(angle / 2.0), np.cos(angle / 2.0)], axis=1)


def about_x(angle: Floats) -> Floats:
    zero = np.zeros_like(angle)
    return np.stack([np.sin(angle / 2.0), zero, zero, np.cos(angle / 2.0)], axis=1)


def at(*milliseconds: float) -> Ints:
    return np.array([round(each * MS) for each in milliseconds], np.int64)


def spinning(buffer: TransformBuffer, time: Ints) -> None:
    """A base that turns about z at 1 rad/s and moves along x at 2 m/s; a link bent by 0.3 rad."""
    seconds = time / 1e9
    shift = np.stack([2.0 * seconds, 0.0 * seconds, 0.0 * seconds], axis=1)
    buffer.add("/world", "base_link", time, shift, about_z(seconds))
    bend = about_x(np.array([0.3]))
    buffer.add("base_link", "/leg", at(0), np.array([[0.0, 1.0, 0.0]]), bend, static=True)


def test_poses_are_interpolated_along_the_chain() -> None:
    buffer = TransformBuffer()
    spinning(buffer, at(0, 20, 40, 60))
    poses = buffer.lookup("leg", "world", at(33))
    angle = 0.033
    assert poses.known.all()
    assert poses.translation[0] == pytest.approx([0.066 - np.sin(angle), np.cos(angle), 0.0])
    # The link's z axis: bent about x by 0.3 rad, then turned about z.
    axis = rotate(poses.rotation, np.array([[0.0, 0.0, 1.0]]))[0]
    tilt = np.sin(0.3)
    assert axis == pytest.approx([tilt * np.sin(angle), -tilt * np.cos(angle), np.cos(0.3)])


def test_nothing_is_extrapolated_and_no_gap_is_bridged() -> None:
    buffer = TransformBuffer()
    spinning(buffer, at(20, 40, 240, 260))
    known = buffer.lookup("leg", "world", at(10, 20, 30, 40, 140, 240, 250, 270)).known
    assert known.tolist() == [False, True, True, True, False, True, True, False]


def test_frames_that_are_not_connected_are_not_known() -> None:
    buffer = TransformBuffer()
    spinning(buffer, at(0, 20))
    assert buffer.chain("leg", "elsewhere") is None
    poses = buffer.lookup("leg", "elsewhere", at(10))
    assert not poses.known.any()
    assert np.isnan(poses.rotation).all()


def test_a_loop_of_frames_ends() -> None:
    buffer = TransformBuffer()
    for parent, child in (("a", "b"), ("b", "a")):
        buffer.add(parent, child, at(0), np.zeros((1, 3)), about_z(np.zeros(1)))
    assert buffer.chain("a", "world") is None


def test_what_cannot_be_a_transform_is_refused_and_counted() -> None:
    buffer = TransformBuffer()
    shift = np.zeros((4, 3))
    shift[1, 0] = np.nan
    turn = about_z(np.zeros(4))
    turn[2] = 0.0
    buffer.add("world", "base", at(0, 10, 20, 30), shift, turn)
    buffer.add("world", "base", at(30), np.zeros((1, 3)), about_z(np.zeros(1)))
    buffer.add("other", "base", at(40), np.zeros((1, 3)), about_z(np.zeros(1)))
    assert buffer.refused == 4
    assert buffer.lookup("base", "world", at(15)).known.all()


def test_what_is_forgotten_is_not_needed() -> None:
    buffer = TransformBuffer()
    spinning(buffer, at(*range(0, 1000, 20)))
    before = buffer.lookup("leg", "world", at(505, 900))
    buffer.forget_before(505 * MS)
    after = buffer.lookup("leg", "world", at(505, 900))
    np.testing.assert_array_equal(before.rotation, after.rotation)
    assert not buffer.lookup("leg", "world", at(400)).known.any()


def link_samples(time: Ints) -> Samples:
    """Forces of 50 N straight up in the world, as the link of `spinning` sees them."""
    seconds = time / 1e9
    up = np.tile([0.0, 0.0, 50.0], (len(time), 1))
    in_base = rotate(about_z(-seconds), up)
    force = rotate(about_x(np.full(len(time), -0.3)), in_base)
    yes, points = np.ones(len(time), np.bool_), np.zeros((len(time), 3))
    foot = np.zeros(len(time), np.int64)
    return Samples(foot, time, time, yes, force, ~yes, foot, points, points)


def turned(cuts: list[int], transforms_first: list[bool]) -> tuple[Samples, ForcesToWorld]:
    samples, times = link_samples(at(*range(0, 400, 7))), at(*range(20, 400, 20))
    buffer = TransformBuffer()
    forces = ForcesToWorld(buffer, ["leg"], "world")
    edges = [0, *sorted(cuts), 400]
    done: list[Samples] = []
    for start, end, first in zip(edges[:-1], edges[1:], transforms_first, strict=True):
        fresh = times[(times >= start * MS) & (times < end * MS)]
        rows = (samples.stamp >= start * MS) & (samples.stamp < end * MS)
        if first:
            spinning(buffer, fresh)
        done += forces.add(samples.pick(rows))
        if not first:
            spinning(buffer, fresh)
    done += forces.finish()
    force = np.concatenate([each.force for each in done])
    in_world = np.concatenate([each.in_world for each in done])
    whole = samples.pick(np.arange(len(force)))
    return Samples(
        whole.foot,
        whole.log_time,
        whole.stamp,
        whole.in_contact,
        force,
        in_world,
        whole.points,
        whole.position,
        whole.normal,
    ), forces


def test_link_forces_are_turned_into_the_world_where_transforms_tell() -> None:
    samples, forces = turned([], [True])
    inside = (samples.stamp >= 20 * MS) & (samples.stamp <= 380 * MS)
    assert samples.in_world.tolist() == inside.tolist()
    vertical = np.tile([0.0, 0.0, 50.0], (int(inside.sum()), 1))
    np.testing.assert_allclose(samples.force[inside], vertical, atol=1e-9)
    np.testing.assert_array_equal(
        samples.force[~inside], link_samples(samples.stamp[~inside]).force
    )
    assert (forces.turned, forces.not_turned) == (int(inside.sum()), int((~inside).sum()))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(0, 400), max_size=5), st.lists(st.booleans(), min_size=6, max_size=6))
def test_it_does_not_matter_which_batch_holds_which_message(
    cuts: list[int], transforms_first: list[bool]
) -> None:
    whole, _ = turned([], [True])
    split, _ = turned(cuts, transforms_first[: len(cuts) + 1])
    np.testing.assert_array_equal(whole.in_world, split.in_world)
    np.testing.assert_array_equal(whole.force, split.force)


def test_a_foot_without_a_link_passes_as_it_is() -> None:
    forces = ForcesToWorld(TransformBuffer(), [None], "world")
    given_samples = link_samples(at(0, 10))
    (passed,) = forces.add(given_samples)
    np.testing.assert_array_equal(passed.force, given_samples.force)
    assert not passed.in_world.any()
    assert forces.not_turned == 2
