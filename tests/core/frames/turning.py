"""A base that turns and moves at constant rates, as a transform buffer."""

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.frames.transforms import TransformBuffer, frame_track

MS = 1_000_000


def about_z(angle: Floats) -> Floats:
    zero = np.zeros_like(angle)
    return np.stack([zero, zero, np.sin(angle / 2.0), np.cos(angle / 2.0)], axis=1)


def about_x(angle: Floats) -> Floats:
    zero = np.zeros_like(angle)
    return np.stack([np.sin(angle / 2.0), zero, zero, np.cos(angle / 2.0)], axis=1)


def at(*milliseconds: float) -> Ints:
    return np.array([round(each * MS) for each in milliseconds], np.int64)


def buffer_of(
    parent: str,
    child: str,
    time: Ints,
    log_time: Ints,
    shift: Floats,
    turn: Floats,
    *,
    static: bool = False,
) -> TransformBuffer:
    track = frame_track(parent, time, log_time, shift, turn, static=static)
    return TransformBuffer({child: track} if track else {})


def spinning(time: Ints, log_time: Ints | None = None) -> TransformBuffer:
    """A base that turns about z at 1 rad/s and moves along x at 2 m/s; a link bent by 0.3 rad."""
    seconds = time / 1e9
    log_time = time if log_time is None else log_time
    shift = np.stack([2.0 * seconds, 0.0 * seconds, 0.0 * seconds], axis=1)
    bend, beside = about_x(np.array([0.3])), np.array([[0.0, 1.0, 0.0]])
    base = buffer_of("/world", "base_link", time, log_time, shift, about_z(seconds))
    return base.then(buffer_of("base_link", "leg", at(0), at(0), beside, bend, static=True))
