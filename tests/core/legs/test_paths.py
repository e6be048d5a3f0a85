"""The way of a foot, by transforms and by joints."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.kinematics import Joint
from dogbot_logtool.core.frames.transforms import TransformBuffer, frame_track
from dogbot_logtool.core.legs.joints import JointSamples, JointTable, JointTrack, joint_tracks
from dogbot_logtool.core.legs.paths import LegChain, chain_to, foot_path

STEP = 10_000_000
STATICS = TransformBuffer()
NONE = TransformBuffer()
PARENTS = {"shank": "thigh", "thigh": "base"}


def quaternion(angle: Floats) -> Floats:
    """Turns about +y, (n, 4)."""
    none = np.zeros_like(angle)
    return np.column_stack([none, np.sin(angle / 2.0), none, np.cos(angle / 2.0)])


def angles(time: Ints) -> tuple[Floats, Floats]:
    seconds = time / 1e9
    return 0.5 * np.sin(4.0 * seconds), 0.6 + 0.3 * np.cos(4.0 * seconds)


def expected(time: Ints) -> Floats:
    """Thigh and shank of 0.2 m, the point 0.05 m below the shank's origin at the knee."""
    hip, knee = angles(time)
    x = -0.2 * np.sin(hip) - 0.05 * np.sin(hip + knee)
    z = -0.2 * np.cos(hip) - 0.05 * np.cos(hip + knee)
    return np.column_stack([x, np.zeros_like(x), z])


def buffer_of(time: Ints) -> TransformBuffer:
    hip, knee = angles(time)
    tracks = {}
    for child, parent, angle, down in (
        ("thigh", "base", hip, 0.0),
        ("shank", "thigh", knee, -0.2),
    ):
        place = np.tile([0.0, 0.0, down], (len(time), 1))
        track = frame_track(parent, time, time, place, quaternion(angle))
        assert track is not None
        tracks[child] = track
    return TransformBuffer(tracks)


def chain() -> LegChain:
    found = chain_to(PARENTS, "shank", "base", (0.0, 0.0, -0.05), touches=True)
    assert found is not None
    return found


def test_transforms_tell_the_way_of_a_foot() -> None:
    time = STEP * np.arange(600)
    path = foot_path(chain(), {}, buffer_of(time), STATICS)
    assert path is not None
    assert np.array_equal(path.time, time)
    assert path.position == pytest.approx(expected(time), abs=1e-6)


def test_a_path_ends_where_one_of_its_frames_does() -> None:
    time = STEP * np.arange(300)
    frames = dict(buffer_of(time).frames)
    assert foot_path(chain(), {}, TransformBuffer({"shank": frames["shank"]}), STATICS) is None
    frames["thigh"] = frames["thigh"].pick(slice(10, 290))
    path = foot_path(chain(), {}, TransformBuffer(frames), STATICS)
    assert path is not None
    assert np.array_equal(path.time, time[10:290])


def test_nothing_connects_a_foot_with_another_base() -> None:
    assert chain_to(PARENTS, "shank", "trunk", (0.0, 0.0, 0.0), touches=False) is None
    assert chain_to({"a": "b", "b": "a"}, "a", "base", (0.0, 0.0, 0.0), touches=False) is None


def joints() -> LegChain:
    axis = (0.0, 1.0, 0.0)
    held = {
        "thigh": Joint("hip", "base", "thigh", "revolute", axis=axis),
        "shank": Joint("knee", "thigh", "shank", "revolute", (0.0, 0.0, -0.2), axis=axis),
    }
    found = chain_to(PARENTS, "shank", "base", (0.0, 0.0, -0.05), touches=True, joints=held)
    assert found is not None
    return found


def track_of(time: Ints, **positions: Floats) -> dict[str, JointTrack]:
    position = np.column_stack(list(positions.values()))
    none = np.full_like(position, np.nan)
    samples = JointSamples(time, time, position, none, none)
    return joint_tracks([JointTable("/j", tuple(positions), samples)], TimeSource.LOG, {})


def test_joints_tell_the_same_way() -> None:
    time = STEP * np.arange(300)
    hip, knee = angles(time)
    later = time[::3]
    tracks = track_of(time, hip=hip) | track_of(later, knee=angles(later)[1])
    path = foot_path(joints(), tracks, NONE, STATICS)
    assert path is not None
    assert path.position == pytest.approx(expected(path.time), abs=5e-4)
    assert knee is not None


def test_a_joint_that_rests_and_one_that_is_missing() -> None:
    time = STEP * np.arange(300)
    hip, _ = angles(time)
    path = foot_path(joints(), track_of(time, hip=hip, knee=0.0 * hip), NONE, STATICS)
    assert path is not None
    straight = np.column_stack([-0.25 * np.sin(hip), np.zeros(300), -0.25 * np.cos(hip)])
    assert path.position == pytest.approx(straight, abs=1e-6)
    assert foot_path(joints(), track_of(time, hip=hip), NONE, STATICS) is None


def test_a_silence_of_one_joint_is_no_way_of_the_foot() -> None:
    time = STEP * np.arange(300)
    hip, knee = angles(time)
    kept = (time < STEP * 100) | (time > STEP * 140)
    tracks = track_of(time, hip=hip) | track_of(time[kept], knee=knee[kept])
    path = foot_path(joints(), tracks, NONE, STATICS)
    assert path is not None
    assert not ((path.time > STEP * 100) & (path.time < STEP * 140)).any()
    assert path.broken.sum() == 1
