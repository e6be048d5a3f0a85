"""Poses of frames over time, and of links that slide, stay or follow."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.frames.transforms import FrameTrack, Poses, frame_track, lookup
from dogbot_logtool.core.rotations import rotate
from tests.truth.geometry import about_axis

MS = 1_000_000


def at(*milliseconds: float) -> Ints:
    return np.array([round(each * MS) for each in milliseconds], np.int64)


def tracks_of(
    parent: str,
    child: str,
    time: Ints,
    log_time: Ints,
    shift: Floats,
    turn: Floats,
    *,
    static: bool = False,
) -> dict[str, FrameTrack]:
    track = frame_track(parent, time, log_time, shift, turn, static=static)
    return {child: track} if track else {}


def spinning(time: Ints, log_time: Ints | None = None) -> dict[str, FrameTrack]:
    """A base that turns about z at 1 rad/s and moves along x at 2 m/s; a link bent by 0.3 rad."""
    seconds = time / 1e9
    log_time = time if log_time is None else log_time
    shift = np.stack([2.0 * seconds, 0.0 * seconds, 0.0 * seconds], axis=1)
    bend, beside = about_axis(0, np.array([0.3])), np.array([[0.0, 1.0, 0.0]])
    base = tracks_of("/world", "base_link", time, log_time, shift, about_axis(2, seconds))
    return base | tracks_of("base_link", "leg", at(0), at(0), beside, bend, static=True)


def look(tracks: dict[str, FrameTrack], time: Ints, world: str = "world") -> Poses:
    return lookup(tracks, "leg", world, time, time)


def test_poses_are_interpolated_along_the_chain() -> None:
    poses = look(spinning(at(0, 20, 40, 60)), at(33))
    angle = 0.033
    assert poses.known.all()
    assert poses.translation[0] == pytest.approx([0.066 - np.sin(angle), np.cos(angle), 0.0])
    # The link's z axis: bent about x by 0.3 rad, then turned about z.
    axis = rotate(poses.rotation, np.array([[0.0, 0.0, 1.0]]))[0]
    tilt = np.sin(0.3)
    assert axis == pytest.approx([tilt * np.sin(angle), -tilt * np.cos(angle), np.cos(0.3)])


def test_nothing_is_extrapolated_and_no_gap_is_bridged() -> None:
    tracks = spinning(at(20, 40, 240, 260))
    known = look(tracks, at(10, 20, 30, 40, 140, 240, 250, 270)).known
    assert known.tolist() == [False, True, True, True, False, True, True, False]


def test_what_was_recorded_long_before_or_after_is_not_used() -> None:
    tracks = spinning(at(0, 20, 40), at(0, 20, 2100))
    known = lookup(tracks, "leg", "world", at(10, 30, 30, 10), at(10, 30, 101, 2010)).known
    assert known.tolist() == [True, False, True, False]


def test_a_loop_of_frames_ends() -> None:
    still = np.zeros((1, 3)), about_axis(2, np.zeros(1))
    tracks = tracks_of("a", "b", at(0), at(0), *still) | tracks_of("b", "a", at(0), at(0), *still)
    assert not lookup(tracks, "a", "world", at(0), at(0)).known.any()


def test_what_cannot_be_a_transform_is_left_out() -> None:
    shift = np.zeros((6, 3))
    shift[1, 0] = np.nan
    turn = about_axis(2, np.zeros(6))
    turn[2] = 0.0
    time, log_time = at(0, 10, 20, 30, 30, 25), at(0, 10, 20, 30, 40, 50)
    tracks = tracks_of("world", "base", time, log_time, shift, turn)
    assert tracks["base"].time.tolist() == at(0, 30).tolist()


def test_the_latest_static_transform_holds() -> None:
    shift = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    tracks = tracks_of(
        "base", "leg", at(7, 7), at(7, 8), shift, about_axis(2, np.zeros(2)), static=True
    )
    assert lookup(tracks, "leg", "base", at(0), at(0)).translation[0].tolist() == [2.0, 0.0, 0.0]


def test_huge_numbers_are_no_error() -> None:
    still = about_axis(2, np.zeros(2))
    shift = np.full((2, 3), 1e308) * np.array([[1.0], [-1.0]])
    tracks = tracks_of("world", "leg", at(0, 20), at(0, 20), shift, still)
    assert look(tracks, at(10)).known.all()
