"""The base from every source: the same figures, in closed form; what is said; what is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.oracles import base_walks as base
from tests.oracles import walks

DURATION_S = (base.SAMPLES - 1) * walks.STEP / 1e9


def check(got: dict[str, Any], rel: float = 1e-9) -> None:
    """Check the figures against the arc that was walked."""
    motion = got["base"]
    turned, radius = base.YAW_RATE * DURATION_S, base.SPEED / base.YAW_RATE
    assert motion["net_displacement_m"] == pytest.approx(2 * radius * np.sin(turned / 2), rel=rel)
    assert motion["path_length_m"] == pytest.approx(base.SPEED * DURATION_S, rel=1e-3)
    assert motion["yaw_change_rad"] == pytest.approx(turned, rel=max(rel, 1e-6))
    assert motion["forward_speed_mps"] == pytest.approx(base.SPEED, rel=1e-3)
    assert motion["roll_rad"]["mean"] == pytest.approx(base.ROLL, rel=max(rel, 1e-6))
    assert motion["pitch_rad"]["mean"] == pytest.approx(base.PITCH, rel=max(rel, 1e-6))


@pytest.mark.parametrize("kind", base.TOPICS)
def test_every_source_gives_the_walk(tmp_path: Path, kind: str) -> None:
    path = base.write(tmp_path / "walk.mcap", kind, base.TOPICS[kind])
    name = base.TOPICS[kind] if kind in base.ON_REQUEST else None
    got = dl.measure(path, odom_topic=name).stats
    single = kind.startswith(("unitree", "ocs2"))
    check(got, rel=1e-6 if single else 1e-9)
    said = {finding["code"] for finding in got["findings"]}
    assert ("PLANNED" in said) == (kind in base.PLANNED)
    assert ("LOG_TIME_USED" in said) == (kind in base.WITHOUT_HEADER)


@pytest.mark.parametrize(
    ("kind", "path"),
    [
        ("geometry_msgs/PoseStamped", "pose"),
        ("geometry_msgs/PoseStamped", ""),
        ("xpp_msgs/RobotStateCartesian", "base.pose"),
        ("geometry_msgs/TransformStamped", "transform"),
        ("std_msgs/Float64MultiArray", "data[2:9]"),
    ],
)
def test_a_pose_that_the_user_names(tmp_path: Path, kind: str, path: str) -> None:
    log = base.write(tmp_path / "walk.mcap", kind, "/goal_pose")
    check(dl.measure(log, odom_topic=f"/goal_pose:{path}".rstrip(":")).stats)


@pytest.mark.parametrize(
    ("kind", "element", "said"),
    [
        ("tf2_msgs/TFMessage", "odom/trunk", "odom/base_link"),
        ("gazebo_msgs/ModelStates", "spot", "anymal, ground_plane"),
        ("geometry_msgs/PoseStamped", "body", "no field 'body'"),
        ("ocs2_msgs/mpc_observation", "state.value[0:5]", "has 5 numbers"),
    ],
)
def test_a_wrong_element_lists_what_there_is(
    tmp_path: Path, kind: str, element: str, said: str
) -> None:
    log = base.write(tmp_path / "walk.mcap", kind, "/x")
    with pytest.raises(dl.CallError, match=said):
        dl.measure(log, odom_topic=f"/x:{element}")
