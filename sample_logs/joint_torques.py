"""Torques of the joints, and what legs do, in closed form.

Legs have no mass and joints no friction: at every instant a joint's motor holds the moment of the
ground-reaction force about its axis, tau = -J^T F, with J the Jacobian of the sole in the body. So
the motors' power is that of the sole pushing the ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gait_model import (
    FEET,
    SWING_HEIGHT_M,
    Gait,
    base_motion,
    ground_forces,
    leg_angles,
    leg_geometry,
    sole_position,
)
from leg_kinematics import (
    UPPER_LEG_LENGTH_M,
    conjugate,
    multiply,
    rotate,
    rotation_about_x,
    rotation_about_y,
)

if TYPE_CHECKING:
    from leg_kinematics import Array

_DIFFERENCE_S = 1e-4
_STEPS_PER_STRIDE = 20_000


def joint_torques(gait: Gait, foot: str, time_s: Array) -> Array:
    """Torques of hip, upper leg and lower leg about their axes, shape ``(n, 3)``, in N m."""
    leg, angles = leg_geometry(foot), leg_angles(gait, foot, time_s)
    base = base_motion(gait, time_s)
    to_body = conjugate(base.orientation)
    force_n = rotate(to_body, ground_forces(gait, time_s)[foot])
    sole_m = rotate(to_body, sole_position(gait, foot, time_s) - base.position_m)
    rolled = rotation_about_y(angles[:, 0])
    hip_m = np.broadcast_to(leg.hip_m, sole_m.shape)
    upper_m = hip_m + rotate(rolled, np.broadcast_to((leg.hip_offset_m, 0.0, 0.0), sole_m.shape))
    pitched = multiply(rolled, rotation_about_x(angles[:, 1]))
    down_m = np.broadcast_to((0.0, 0.0, -UPPER_LEG_LENGTH_M), sole_m.shape)
    knee_m = upper_m + rotate(pitched, down_m)
    roll_axis = np.broadcast_to((0.0, 1.0, 0.0), sole_m.shape)
    pitch_axis = rotate(rolled, np.broadcast_to((1.0, 0.0, 0.0), sole_m.shape))
    joints = ((hip_m, roll_axis), (upper_m, pitch_axis), (knee_m, pitch_axis))
    return np.stack(
        [
            -np.sum(axis * np.cross(sole_m - origin_m, force_n), axis=-1)
            for origin_m, axis in joints
        ],
        axis=-1,
    )


def leg_truth(gait: Gait, foot: str) -> dict[str, Any]:
    """What a leg does in one stride (all are alike): clearance, work, peak torques."""
    start_s = gait.touchdown(foot, 0)
    time_s = start_s + gait.period_s * (np.arange(_STEPS_PER_STRIDE) + 0.5) / _STEPS_PER_STRIDE
    before, after = (
        leg_angles(gait, foot, time_s + shift_s) for shift_s in (-_DIFFERENCE_S, _DIFFERENCE_S)
    )
    torque_nm = joint_torques(gait, foot, time_s)
    power_w = torque_nm * (after - before) / (2 * _DIFFERENCE_S)
    return {
        "clearance_m": SWING_HEIGHT_M,
        "absolute_work_j": np.abs(power_w).sum(axis=1).mean() * gait.period_s,
        "positive_work_j": power_w.clip(0.0).sum(axis=1).mean() * gait.period_s,
        "peak_torque_nm": dict(
            zip(("roll", "pitch", "knee"), np.abs(torque_nm).max(axis=0).tolist(), strict=True)
        ),
    }


def legs_truth(gait: Gait) -> dict[str, Any]:
    """What the legs do, and how their efforts were computed."""
    return {
        "effort": "quasi-static: minus the Jacobian's transpose times the ground force; legs "
        "without mass",
        "feet": {foot: leg_truth(gait, foot) for foot in FEET},
    }
