"""Which joints and frames are a foot's, and that logs without legs pay nothing."""

from collections.abc import Sequence

import pytest

from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.measuring.legs import _feet_of_joints, _named_frames, _pairs

QUADRUPED = tuple(
    Foot(f"{end}_{side}", f"/{end}_{side}", leg_position=(end, side))
    for end in ("front", "back")
    for side in ("left", "right")
)
BIPED = (Foot("left", "/left"), Foot("right", "/right"))


def feet_of(feet: Sequence[Foot], *joints: str) -> list[str | None]:
    found = _feet_of_joints(feet, [], set(joints))
    return [feet[found[joint]].name if joint in found else None for joint in joints]


@pytest.mark.parametrize(
    ("joint", "foot"),
    [
        ("FL_thigh_joint", "front_left"),
        ("RR_calf_joint", "back_right"),
        ("LH_KFE", "back_left"),
        ("front_right_hip", "front_right"),
        ("hr.kn", "back_right"),
        ("neck_yaw", None),
        ("left_knee", None),
        ("fl_gripper_finger", None),
        ("", None),
    ],
)
def test_joints_of_a_quadruped(joint: str, foot: str | None) -> None:
    assert feet_of(QUADRUPED, joint) == [foot]


@pytest.mark.parametrize(
    ("joint", "foot"),
    [
        ("leg_left_3_joint", "left"),
        ("r_leg_kny", "right"),
        ("rightHipPitch", "right"),
        ("arm_left_3_joint", None),
        ("hand_right_thumb_joint", None),
        ("head_1_joint", None),
        ("front_left_wheel", None),
    ],
)
def test_joints_of_a_biped(joint: str, foot: str | None) -> None:
    assert feet_of(BIPED, joint) == [foot]


def test_pairs_are_alike_but_for_their_side() -> None:
    names = ("FL_hip_joint", "FR_hip_joint", "RL_hip_joint", "FL_calf_joint")
    found = _feet_of_joints(QUADRUPED, [], set(names))
    assert [(pair.left, pair.right) for pair in _pairs(QUADRUPED, found)] == [names[:2]]
    found = _feet_of_joints(BIPED, [], {"leg_left_3_joint", "leg_right_3_joint"})
    (pair,) = _pairs(BIPED, found)
    assert pair.name == "leg_3_joint"


def test_frames_that_are_named_like_feet() -> None:
    frames = [
        "base",
        *(f"{leg}_{part}" for leg in ("LF", "RF", "LH", "RH") for part in ("FOOT", "SHANK")),
    ]
    named = _named_frames(QUADRUPED, frames)
    assert named == {0: "LF_FOOT", 1: "RF_FOOT", 2: "LH_FOOT", 3: "RH_FOOT"}
    assert _named_frames(QUADRUPED, ["base", "camera"]) == {}
    # A foot's frame may be at the knee, as DogBot's is; a sole's is not.
    soles = ["LF_sole", "RF_sole", "LH_sole", "RH_sole"]
    assert _named_frames(QUADRUPED, [*frames, *soles]) == dict(enumerate(soles))
    assert _named_frames(BIPED, ["left_sole_link", "left_ankle", "right_sole_link"]) == {
        0: "left_sole_link",
        1: "right_sole_link",
    }
