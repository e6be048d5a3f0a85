"""Poses of links against rotation matrices by Rodrigues' formula."""

from math import cos, pi, sin

import numpy as np
import pytest

from dogbot_logtool.core.frames.kinematics import Joint, Triple, link_poses


def matrix(quaternion: np.ndarray) -> np.ndarray:
    """By the definition of a unit quaternion's rotation."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def rodrigues(axis: Triple, angle: float) -> np.ndarray:
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + sin(angle) * cross + (1 - cos(angle)) * cross @ cross)


SLANTED: Triple = (2 / 7, 3 / 7, 6 / 7)
TURNED = (0.0, 0.0, sin(pi / 6), cos(pi / 6))
"""60 degrees about z."""
TURNED_MATRIX = rodrigues((0.0, 0.0, 1.0), pi / 3)


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, pi, 7.0])
def test_a_revolute_joint_turns_about_its_axis(angle: float) -> None:
    joint = Joint("j", "a", "b", "revolute", (1.0, 2.0, 3.0), TURNED, SLANTED)
    shift, turn = link_poses([joint], np.array([[angle]]))
    np.testing.assert_allclose(
        matrix(turn[0, 0]), TURNED_MATRIX @ rodrigues(SLANTED, angle), atol=1e-12
    )
    np.testing.assert_allclose(shift[0, 0], [1.0, 2.0, 3.0])


def test_a_prismatic_joint_moves_along_its_axis_in_its_own_frame() -> None:
    joint = Joint("j", "a", "b", "prismatic", (1.0, 0.0, 0.0), TURNED, SLANTED)
    shift, turn = link_poses([joint], np.array([[0.0], [0.7]]))
    expected = np.array([1.0, 0.0, 0.0]) + 0.7 * TURNED_MATRIX @ np.array(SLANTED)
    np.testing.assert_allclose(shift[:, 0], [[1.0, 0.0, 0.0], expected], atol=1e-12)
    np.testing.assert_allclose(matrix(turn[1, 0]), TURNED_MATRIX, atol=1e-12)


def test_a_fixed_joint_stays_and_a_mimic_follows() -> None:
    fixed = Joint("f", "a", "b", "fixed", rotation=TURNED)
    mimic = Joint("m", "b", "c", "revolute", source="j", multiplier=-2.0, offset=0.5)
    assert (fixed.measured, mimic.measured) == ("f", "j")
    _, turn = link_poses([fixed, mimic], np.array([[np.nan, 0.4]]))
    np.testing.assert_allclose(matrix(turn[0, 0]), TURNED_MATRIX, atol=1e-12)
    expected = rodrigues((1.0, 0.0, 0.0), -2.0 * 0.4 + 0.5)
    np.testing.assert_allclose(matrix(turn[0, 1]), expected, atol=1e-12)
