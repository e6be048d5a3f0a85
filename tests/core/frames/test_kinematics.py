"""Joints that slide, stay or follow; `test_convert_legs.py` has those that turn."""

from math import cos, pi, sin

import numpy as np

from dogbot_logtool.core.frames.kinematics import Joint, Triple, link_poses
from tests.oracles.frames import turn_of

SLANTED: Triple = (2 / 7, 3 / 7, 6 / 7)
TURNED = (0.0, 0.0, sin(pi / 6), cos(pi / 6))
"""60 degrees about z."""
TURNED_MATRIX = turn_of(TURNED)


def test_a_prismatic_joint_moves_along_its_axis_in_its_own_frame() -> None:
    joint = Joint("j", "a", "b", "prismatic", (1.0, 0.0, 0.0), TURNED, SLANTED)
    shift, turn = link_poses([joint], np.array([[0.0], [0.7]]))
    expected = np.array([1.0, 0.0, 0.0]) + 0.7 * TURNED_MATRIX @ np.array(SLANTED)
    np.testing.assert_allclose(shift[:, 0], [[1.0, 0.0, 0.0], expected], atol=1e-12)
    np.testing.assert_allclose(turn_of(turn[1, 0]), TURNED_MATRIX, atol=1e-12)


def test_a_fixed_joint_stays_and_a_mimic_follows() -> None:
    fixed = Joint("f", "a", "b", "fixed", rotation=TURNED)
    mimic = Joint("m", "b", "c", "revolute", source="j", multiplier=-2.0, offset=0.5)
    assert (fixed.measured, mimic.measured) == ("f", "j")
    _, turn = link_poses([fixed, mimic], np.array([[np.nan, 0.4]]))
    np.testing.assert_allclose(turn_of(turn[0, 0]), TURNED_MATRIX, atol=1e-12)
    half = (-2.0 * 0.4 + 0.5) / 2.0
    expected = turn_of((sin(half), 0.0, 0.0, cos(half)))
    np.testing.assert_allclose(turn_of(turn[0, 1]), expected, atol=1e-12)
