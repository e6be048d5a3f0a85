"""Unit quaternions and the kinematics of one DogBot-like leg.

Quaternions are arrays of shape ``(..., 4)`` in the order x, y, z, w, as in ROS messages. A leg is a
chain of three revolute joints: the hip rolls about the body's forward axis (+y), the upper and the
lower leg pitch about the axis to the right (+x). At zero angles the leg hangs straight down.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UPPER_LEG_LENGTH_M = 0.3
"""From the upper leg's joint to the knee."""
LOWER_LEG_LENGTH_M = 0.3
"""From the knee to the sole, where the foot touches the ground."""

_X_AXIS, _Y_AXIS, _Z_AXIS = range(3)


@dataclass(frozen=True, slots=True)
class LegGeometry:
    """Where a leg is fixed to the body.

    Attributes:
        hip_m: Hip joint in the body frame (x right, y forward, z up), in metres.
        hip_offset_m: Upper leg's joint from the hip joint along the hip's +x axis, in metres.

    """

    hip_m: tuple[float, float, float]
    hip_offset_m: float


def _rotation_about(axis: int, angle_rad: npt.ArrayLike) -> Array:
    half_rad = np.asarray(angle_rad, dtype=np.float64) / 2
    quaternion = np.zeros((*half_rad.shape, 4))
    quaternion[..., axis] = np.sin(half_rad)
    quaternion[..., 3] = np.cos(half_rad)
    return quaternion


def rotation_about_x(angle_rad: npt.ArrayLike) -> Array:
    """Quaternions of rotations about +x by ``angle_rad``."""
    return _rotation_about(_X_AXIS, angle_rad)


def rotation_about_y(angle_rad: npt.ArrayLike) -> Array:
    """Quaternions of rotations about +y by ``angle_rad``."""
    return _rotation_about(_Y_AXIS, angle_rad)


def rotation_about_z(angle_rad: npt.ArrayLike) -> Array:
    """Quaternions of rotations about +z by ``angle_rad``."""
    return _rotation_about(_Z_AXIS, angle_rad)


def multiply(left: Array, right: Array) -> Array:
    """Hamilton product: the rotation ``right`` followed by the rotation ``left``."""
    left_vector, left_w = left[..., :3], left[..., 3:]
    right_vector, right_w = right[..., :3], right[..., 3:]
    vector = left_w * right_vector + right_w * left_vector + np.cross(left_vector, right_vector)
    w = left_w * right_w - np.sum(left_vector * right_vector, axis=-1, keepdims=True)
    return np.concatenate([vector, w], axis=-1)


def conjugate(quaternion: Array) -> Array:
    """Return the inverse rotation of a unit quaternion."""
    conjugated: Array = quaternion * np.array([-1.0, -1.0, -1.0, 1.0])
    return conjugated


def rotate(quaternion: Array, vector: Array) -> Array:
    """Rotate vectors of shape ``(..., 3)``: from the child's into the parent's frame."""
    imaginary, w = quaternion[..., :3], quaternion[..., 3:]
    twice_cross = 2 * np.cross(imaginary, vector)
    rotated: Array = vector + w * twice_cross + np.cross(imaginary, twice_cross)
    return rotated


def joint_angles(leg: LegGeometry, sole_in_body_m: Array) -> Array:
    """Inverse kinematics, with the knee behind the line from hip to sole.

    Args:
        leg: The leg.
        sole_in_body_m: Sole positions in the body frame, shape ``(n, 3)``, in metres.

    Returns:
        Angles of hip, upper leg and lower leg, shape ``(n, 3)``, in radians.

    """
    x, y, z = (sole_in_body_m - np.asarray(leg.hip_m)).T
    depth_m = np.sqrt(x**2 + z**2 - leg.hip_offset_m**2)
    # The roll turns (hip_offset, -depth) into (x, z); as complex numbers z + ix it is a factor.
    roll_rad = np.angle((z + 1j * x) / (-depth_m + 1j * leg.hip_offset_m))
    reach_squared_m2 = y**2 + depth_m**2
    cos_knee = (reach_squared_m2 - UPPER_LEG_LENGTH_M**2 - LOWER_LEG_LENGTH_M**2) / (
        2 * UPPER_LEG_LENGTH_M * LOWER_LEG_LENGTH_M
    )
    knee_rad = np.arccos(cos_knee)
    lower_leg_share_rad = np.arctan2(
        LOWER_LEG_LENGTH_M * np.sin(knee_rad),
        UPPER_LEG_LENGTH_M + LOWER_LEG_LENGTH_M * cos_knee,
    )
    upper_rad = np.arctan2(y, depth_m) - lower_leg_share_rad
    return np.stack([roll_rad, upper_rad, knee_rad], axis=-1)


def joint_rotations(angles_rad: Array) -> Array:
    """Rotations of hip, upper leg and lower leg, each in its parent: shape ``(n, 3, 4)``."""
    return np.stack(
        [
            rotation_about_y(angles_rad[:, 0]),
            rotation_about_x(angles_rad[:, 1]),
            rotation_about_x(angles_rad[:, 2]),
        ],
        axis=1,
    )


def lower_leg_orientation(angles_rad: Array) -> Array:
    """Orientation of the lower leg in the body frame, shape ``(n, 4)``."""
    hip, upper_leg, lower_leg = np.moveaxis(joint_rotations(angles_rad), 1, 0)
    return multiply(multiply(hip, upper_leg), lower_leg)
