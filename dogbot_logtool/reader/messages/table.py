"""The table of message types that are read, of feet and of base the best first."""

from collections.abc import Iterator
from functools import cache, lru_cache
from typing import Any, Final

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.messages.message_type import COPIED, TOLD_BY, Pairs, Part
from dogbot_logtool.reader.messages.message_type import MessageType as Row

_WORLD, _LINK = WrenchFrame.WORLD, WrenchFrame.LINK
QUADRUPED: Final = ("front_left", "front_right", "back_left", "back_right")
"""Feet in the order that most messages have."""
_LETTERS: Final = ("lf", "rf", "lh", "rh")
_CONTACTS: Final[dict[str, Any]] = {
    "label": "contacts[].name",
    "force": "contacts[].wrench.force",
    "point": "contacts[].pose.position|contacts[].position",
    "planned": "by name",
}
_POSE: Final[dict[str, Any]] = {"position": "pose.position", "orientation": "pose.orientation"}
_WITHOUT_HEADER: Final[dict[str, Any]] = {"stamp": "", "frame": ""}
_FOXGLOVE: Final[dict[str, Any]] = {"stamp": "timestamp", "frame": "frame_id"}
_UNITREE: Final[dict[str, Any]] = {
    **_WITHOUT_HEADER,
    "legs": ("front_right", "front_left", "back_right", "back_left"),
    "force": "foot_force[0:4]|footForce[0:4]|footforce[0:4]",
    "unit": "counts",
}
"""Drivers differ in the package and in the spelling. Stamps, if any, are of the robot's clock."""
_UNITREE_POINTS: Final[dict[str, Any]] = {
    "point": "foot_position_body[0:12 by 3]|footPosition2Body[]|footposition2body[]|"
    "foot_position2body[]|",
    "points_in": "base",
    "point_in_swing": True,
}
_UNITREE_BASE: Final[dict[str, Any]] = {
    "position": "position[0:3 by 3]",
    "orientation": "imu_state.quaternion[0:4 by 4]|imu.quaternion[0:4 by 4]",
    "turned": "wxyz",
}
_UNITREE_MOTORS: Final[dict[str, Any]] = {
    # Named as in their robot descriptions.
    "joints": tuple(
        f"{leg}_{joint}_joint"
        for leg in ("FR", "FL", "RR", "RL")
        for joint in ("hip", "thigh", "calf")
    ),
    "joint_position": "motor_state[].q|motorState[].q",
    "joint_velocity": "motor_state[].dq|motorState[].dq",
    "joint_effort": "motor_state[].tau_est|motorState[].tauEst",
    "acceleration": "imu_state.accelerometer[0:3 by 3]|imu.accelerometer[0:3 by 3]",
    "turn_rate": "imu_state.gyroscope[0:3 by 3]|imu.gyroscope[0:3 by 3]|",
}
_MODELS: Final[dict[str, Any]] = {
    **_WITHOUT_HEADER,
    "choose": ("name[]",),
    "position": "pose[].position",
    "orientation": "pose[].orientation",
}
_STANDARD: Final = frozenset(
    {"foxglove_msgs", "gazebo_msgs", "geometry_msgs", "nav_msgs", "ros_gz_interfaces",
     "sensor_msgs", "tf", "tf2_msgs"}
)  # fmt: skip
"""Packages whose names of messages mean something else in other packages."""


# fmt: off
def _poses() -> Iterator[Row]:
    yield Row("nav_msgs/Odometry", position="pose.pose.position",
              orientation="pose.pose.orientation", linear="twist.twist.linear",
              body="child_frame_id")
    for package in ("foxglove.", "foxglove_msgs/"):
        yield Row(f"{package}Odometry", **_POSE, **_FOXGLOVE, linear="linear_velocity",
                  body="body_frame_id")
        yield Row(f"{package}PoseInFrame", **_POSE, **_FOXGLOVE, anything=True)
    yield Row("geometry_msgs/PoseWithCovarianceStamped", position="pose.pose.position",
              orientation="pose.pose.orientation", anything=True)
    yield Row("geometry_msgs/PoseStamped", **_POSE, anything=True)
    yield Row("geometry_msgs/TransformStamped", position="transform.translation",
              orientation="transform.rotation", body="child_frame_id", anything=True)
    # A bare pose is mostly a command.
    yield Row("geometry_msgs/Pose", position="position", orientation="orientation",
              **_WITHOUT_HEADER, on_request=True)


def _lists_of_poses() -> Iterator[Row]:
    yield Row("gazebo_msgs/ModelStates", **_MODELS)
    yield Row("gazebo_msgs/LinkStates", **_MODELS)
    yield Row("nav_msgs/Path", position="poses[-1].pose.position",
              orientation="poses[-1].pose.orientation", on_request=True,
              remark="the last pose of each path is taken: the newest one, or a plan's goal")
    for name in ("tf/tfMessage", "tf2_msgs/TFMessage"):
        yield Row(name, stamp="transforms[].header.stamp", frame="",
                  choose=("transforms[].header.frame_id", "transforms[].child_frame_id"),
                  position="transforms[].transform.translation",
                  orientation="transforms[].transform.rotation")
    yield Row("foxglove.FrameTransforms", stamp="transforms[].timestamp", frame="",
              choose=("transforms[].parent_frame_id", "transforms[].child_frame_id"),
              position="transforms[].translation", orientation="transforms[].rotation")
    yield Row("foxglove.FrameTransform", stamp="timestamp", frame="",
              choose=("parent_frame_id", "child_frame_id"), position="translation",
              orientation="rotation")


def _vectors() -> Iterator[Row]:
    yield Row("geometry_msgs/Twist", **_WITHOUT_HEADER,
              command=("linear.x", "linear.y", "angular.z"))
    yield Row("geometry_msgs/TwistStamped",
              command=("twist.linear.x", "twist.linear.y", "twist.angular.z"))
    yield Row("sensor_msgs/Imu", acceleration="linear_acceleration",
              turn_rate="angular_velocity")


def _joints() -> Iterator[Row]:
    for package in ("foxglove.", "foxglove_msgs/"):
        yield Row(f"{package}JointStates", stamp="timestamp", joint="joints[].name",
                  joint_position="joints[].position", joint_velocity="joints[].velocity",
                  joint_effort="joints[].effort")


def _feet() -> Iterator[Row]:
    # Forces are along a link's axes or the world's; the foot is either body.
    yield Row("gazebo_msgs/ContactsState", axes=None, pairs=Pairs(
        "states", ("collision1_name", "collision2_name"), "contact_positions", "contact_normals",
        force="force", total="total_wrench.force", info="info"))
    yield Row("ros_gz_interfaces/Contacts", axes=_WORLD, silent_in_swing=True, pairs=Pairs(
        "contacts", ("collision1.name", "collision2.name"), "positions", "normals",
        force="body_1_wrench.force"))
    # Simulators write forces along the world's axes; of real robots that is not known.
    yield Row("anymal_msgs/AnymalState", label="contacts[].name", flag="contacts[].state",
              closed=(1, 2), open=(0,), force="contacts[].wrench.force",
              point="contacts[].position", normal="contacts[].normal", axes=None,
              position="pose.pose.position", orientation="pose.pose.orientation",
              frame="pose.header.frame_id|")
    # `state/grfs` is measured (in simulation), `control/grfs` is commanded.
    yield Row("quad_msgs/GRFArray", legs=("front_left", "back_left", "front_right", "back_right"),
              flag="contact_states[]", force="vectors[]", point="points[]", axes=_WORLD,
              planned="by name")
    yield Row("quad_msgs/RobotState", position="body.pose.position",
              orientation="body.pose.orientation")
    # Unknown, 0 or -1, is the default.
    for flag, closed in (("status", (2, 3)), ("contact_state", (0, 2))):
        yield Row("whole_body_state_msgs/WholeBodyState", **_CONTACTS, only="contacts[].type",
                  flag=f"contacts[].{flag}", closed=closed, open=(1,),
                  normal="contacts[].surface_normal", axes=_WORLD)
    # Forces are zero without contact.
    yield Row("dwl_msgs/WholeBodyState", **_CONTACTS, points_in="base")
    yield Row("dwl_msgs/WholeBodyState", numbered=("base[].id", "base[].position"), turned="xyz")
    yield Row("unitree_go/SportModeState", **_UNITREE, **_UNITREE_POINTS, **_UNITREE_BASE)
    yield Row("go2_interfaces/Go2State", **_UNITREE, **_UNITREE_POINTS)
    for package in ("unitree_legged_msgs", "ros2_unitree_legged_msgs"):
        yield Row(f"{package}/HighState", **_UNITREE, **_UNITREE_POINTS, **_UNITREE_BASE)
    for package in ("unitree_legged_msgs", "unitree_go", "go2_interfaces",
                    "ros2_unitree_legged_msgs"):
        yield Row(f"{package}/LowState", **_UNITREE, **_UNITREE_MOTORS)
    # Drivers of A1 and Go1 add the counts of four feet to twelve joints.
    yield Row("sensor_msgs/JointState", legs=QUADRUPED, force="effort[12:16 of 16]",
              unit="counts", topic_end="joint_foot", joint="name[]", joint_position="position[]",
              joint_velocity="velocity[]", joint_effort="effort[]")
    yield Row("geometry_msgs/WrenchStamped", force="wrench.force", axes=_LINK, anything=True)
    yield Row("pronto_msgs/QuadrupedForceTorqueSensors", legs=QUADRUPED, each=_LETTERS,
              force="{}.force")
    yield Row("syropod_highlevel_controller/TipState", label="name[]", force="wrench[].force")
    # Without header, but for forks.
    yield Row("spot_msgs/FootStateArray", stamp="header.stamp|", frame="", legs=QUADRUPED,
              flag="states[].contact", closed=(1,), open=(2,),
              point="states[].foot_position_rt_body|", points_in="base")
    yield Row("champ_msgs/ContactsStamped", legs=QUADRUPED, flag="contacts[]")
    # The definition says the order of the feet.
    yield Row("quadropted_msgs/RobotFootContact", **_WITHOUT_HEADER,
              legs=("front_right", "front_left", "back_right", "back_left"), flag="contacts[]")
    yield Row("state_estimator_msgs/ContactDetection", legs=QUADRUPED, each=_LETTERS,
              flag="stance_{}")
    # Pronto writes 0.4, 0.3, 0.2 and 0.1 for feet in contact, to tell them apart in plots.
    yield Row("pronto_msgs/QuadrupedStance", legs=QUADRUPED, each=_LETTERS, flag="{}",
              above=0.01)
    # `act_contact_states` are measured, `ref_contact_states` planned; hands stand among the feet.
    yield Row("hrpsys_ros_bridge/ContactStatesStamped", label="states[].header.frame_id",
              flag="states[].state.state", planned="by name")


def _plans() -> Iterator[Row]:
    # The order of the feet differs from version to version; `time_from_start` is that of the plan.
    yield Row("xpp_msgs/RobotStateCartesian", **_WITHOUT_HEADER, by_place=True,
              flag="ee_contact[]|common.ee_in_contact[]", force="ee_forces[]",
              point="ee_motion[].pos|feet[].pos", axes=_WORLD, planned="always",
              position="base.pose.position|common.base.pose.position",
              orientation="base.pose.orientation|common.base.pose.orientation")


def _controllers() -> Iterator[Row]:
    # Momentum (6), position, yaw, pitch, roll, joints; forces of all feet, joint velocities.
    # The forces are planned; the mode is measured only where the node has a contact estimate.
    yield Row("ocs2_msgs/mpc_observation", **_WITHOUT_HEADER, legs=QUADRUPED,
              each=("8", "4", "2", "1"), maybe_without_legs=True, flag="mode&{}",
              force="input.value[0:12 by 3 of 24]", axes=_WORLD, planned="always",
              position="state.value[6:9 by 3 of 18+]", orientation="state.value[9:12 by 3 of 18+]",
              turned="zyx")
# fmt: on


TABLE: Final = (
    *_poses(), *_vectors(), *_feet(), *_joints(), *_plans(), *_lists_of_poses(), *_controllers()
)  # fmt: skip


def tells(row: Row, part: Part) -> bool:
    """Tell whether a row tells of a part."""
    return any(getattr(row, field) for field in TOLD_BY[part])


@cache
def types_of(part: Part) -> tuple[str, ...]:
    """Return the types that tell of a part, the best first."""
    return tuple(dict.fromkeys(row.name for row in TABLE if tells(row, part)))


@lru_cache(maxsize=1024)
def rows_of(type_name: str, part: Part) -> tuple[Row, ...]:
    """Return the rows that may read a type: its own, else those of drivers that copied it."""
    rows = [row for row in TABLE if row.name == type_name]
    last = type_name.rpartition("/")[2]
    if not rows and part in COPIED:
        rows = [
            row
            for row in TABLE
            if row.name.rpartition("/")[2] == last and row.name.partition("/")[0] not in _STANDARD
        ]
    return tuple(row for row in rows if tells(row, part))
