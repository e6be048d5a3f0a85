"""Quaternions (x, y, z, w) as columns."""

import numpy as np

from dogbot_logtool.core.arrays import Floats


def normalised(quaternion: Floats) -> Floats:
    """Scale quaternions to unit length; (n, 4), none of them zero."""
    # Scaled first, so that squares neither overflow nor vanish.
    scaled = quaternion / np.abs(quaternion).max(axis=1, keepdims=True)
    unit: Floats = scaled / np.sqrt((scaled * scaled).sum(axis=1, keepdims=True))
    return unit


def multiply(first: Floats, second: Floats) -> Floats:
    """Hamilton product, row by row: the rotation `second`, followed by `first`; (n, 4)."""
    x1, y1, z1, w1 = first.T
    x2, y2, z2, w2 = second.T
    return np.stack(
        [
            w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
            w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
            w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
        ],
        axis=1,
    )


def conjugate(quaternion: Floats) -> Floats:
    """Return the inverse rotations of unit quaternions; (n, 4)."""
    inverse: Floats = quaternion * np.array([-1.0, -1.0, -1.0, 1.0])
    return inverse


def rotate(quaternion: Floats, vector: Floats) -> Floats:
    """Rotate vectors by unit quaternions: v + 2 w (u x v) + 2 u x (u x v).

    Args:
        quaternion: (n, 4), or (1, 4) for all.
        vector: (n, 3).
    """
    axis, w = quaternion[:, :3], quaternion[:, 3:]
    turned = 2.0 * _cross(axis, vector)
    rotated: Floats = vector + w * turned + _cross(axis, turned)
    return rotated


def _cross(first: Floats, second: Floats) -> Floats:
    """Return cross products, row by row; numpy's takes longer to look at the axes of few rows."""
    x1, y1, z1 = first.T
    x2, y2, z2 = second.T
    return np.stack([y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2], axis=1)


def roll_pitch_yaw(quaternion: Floats) -> Floats:
    """Return the angles of intrinsic z-y-x rotations, as REP-103 has them.

    Args:
        quaternion: (n, 4) unit.

    Returns:
        (n, 3) rad: roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2].
    """
    x, y, z, w = quaternion.T
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=1)


def along_heading(vector: Floats, heading: Floats | float) -> Floats:
    """Turn horizontal vectors into their parts along a heading and to the left of it.

    Args:
        vector: (n, 2), or more columns, which stay.
        heading: (n,) rad, or one of all.
    """
    (x, y, *others), cos, sin = vector.T, np.cos(heading), np.sin(heading)
    return np.stack([x * cos + y * sin, y * cos - x * sin, *others], axis=1)


def slerp(first: Floats, second: Floats, share: Floats) -> Floats:
    """Interpolate between unit quaternions along the shorter arc (Shoemake 1985).

    Args:
        first: (n, 4).
        second: (n, 4).
        share: (n,) 0 gives `first`, 1 gives `second`.
    """
    dot = (first * second).sum(axis=1)
    second = np.where(dot[:, None] < 0.0, -second, second)
    angle = np.arccos(np.clip(np.abs(dot), 0.0, 1.0))
    near = angle < 1e-6
    sine = np.where(near, 1.0, np.sin(angle))
    weight_first = np.where(near, 1.0 - share, np.sin((1.0 - share) * angle) / sine)
    weight_second = np.where(near, share, np.sin(share * angle) / sine)
    return normalised(weight_first[:, None] * first + weight_second[:, None] * second)


def from_roll_pitch_yaw(angles: Floats) -> Floats:
    """Return the quaternions of rotations about x, then y, then z of the fixed frame.

    Args:
        angles: (n, 3) rad.

    Returns:
        (n, 4) x, y, z, w.
    """
    about_x, about_y, about_z = turns = np.zeros((3, len(angles), 4))
    turns[:, :, 3] = np.cos(angles / 2.0).T
    for axis, turn in enumerate(turns):
        turn[:, axis] = np.sin(angles[:, axis] / 2.0)
    return multiply(about_z, multiply(about_y, about_x))
