import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.rotations import multiply, normalised, roll_pitch_yaw, slerp


def about(axis: int, angle: float) -> Floats:
    quaternion = np.zeros((1, 4))
    quaternion[0, axis], quaternion[0, 3] = np.sin(angle / 2.0), np.cos(angle / 2.0)
    return quaternion


def test_angles_come_back_from_their_quaternion() -> None:
    quaternion = multiply(multiply(about(2, 2.5), about(1, -0.4)), about(0, 0.3))
    np.testing.assert_allclose(roll_pitch_yaw(quaternion), [[0.3, -0.4, 2.5]], atol=1e-12)


def test_half_way_between_two_turns_is_half_the_turn() -> None:
    half = slerp(about(2, 0.0), about(2, 1.0), np.array([0.5]))
    np.testing.assert_allclose(half, about(2, 0.5), atol=1e-12)


def test_interpolation_takes_the_shorter_arc() -> None:
    half = slerp(about(2, 0.2), -about(2, 0.4), np.array([0.5]))
    assert abs((half * about(2, 0.3)).sum()) == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_any_length_is_normalised(scale: float) -> None:
    np.testing.assert_allclose(normalised(about(1, 0.8) * scale), about(1, 0.8), rtol=1e-12)
