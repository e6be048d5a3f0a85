"""Definitions of messages that tell of all feet at once."""

from typing import Final

_VECTORS: Final = "geometry_msgs/Point pos\ngeometry_msgs/Vector3 vel\ngeometry_msgs/Vector3 acc"
_POSE: Final = "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel accel"
_CONTACT: Final = (
    "geometry_msgs/Pose pose\ngeometry_msgs/Twist velocity\ngeometry_msgs/Wrench wrench\n"
    "geometry_msgs/Vector3 surface_normal\nfloat64 friction_coefficient"
)
_SPORT: Final = (
    "int16[4] foot_force\nfloat32[3] position\nfloat32[12] foot_position_body\n"
    "float32[12] foot_speed_body"
)
DEFINITIONS: Final = {
    "xpp_msgs/msg/StateLin3d": _VECTORS,
    "xpp_msgs/msg/State6d": _POSE,
    "xpp_msgs/msg/RobotStateCartesian": "builtin_interfaces/Duration time_from_start\n"
    "xpp_msgs/State6d base\nxpp_msgs/StateLin3d[] ee_motion\n"
    "geometry_msgs/Vector3[] ee_forces\nbool[] ee_contact",
    "old_xpp/msg/BaseState": _POSE,
    "old_xpp/msg/RobotStateCommon": "old_xpp/BaseState base\nbool[] ee_in_contact\n"
    "float64 t_global",
    "old_xpp/msg/RobotStateCartesian": "old_xpp/RobotStateCommon common\n"
    "xpp_msgs/StateLin3d[] feet\ngeometry_msgs/Vector3[] ee_forces",
    "anymal_msgs/msg/Contact": "std_msgs/Header header\nstring name\nuint8 state\n"
    "geometry_msgs/Wrench wrench\ngeometry_msgs/Point position\n"
    "geometry_msgs/Vector3 normal\nfloat64 frictionCoefficient",
    "anymal_msgs/msg/AnymalState": "std_msgs/Header header\nint8 state\n"
    "geometry_msgs/PoseStamped pose\nanymal_msgs/Contact[] contacts",
    "quad_msgs/msg/GRFArray": "std_msgs/Header header\ngeometry_msgs/Vector3[] vectors\n"
    "geometry_msgs/Point[] points\nbool[] contact_states\nuint32 traj_index",
    "whole_body_state_msgs/msg/ContactState": "string name\nuint8 type\nuint8 status\n" + _CONTACT,
    "whole_body_state_msgs/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "whole_body_state_msgs/ContactState[] contacts",
    "old_whole_body/msg/ContactState": "string name\nuint8 type\nint8 contact_state\n" + _CONTACT,
    "old_whole_body/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "old_whole_body/ContactState[] contacts",
    "dwl_msgs/msg/BaseState": "string name\nuint8 id\nfloat64 position\nfloat64 velocity",
    "dwl_msgs/msg/ContactState": "string name\ngeometry_msgs/Pose pose\n"
    "geometry_msgs/Twist velocity\ngeometry_msgs/Wrench wrench",
    "dwl_msgs/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "dwl_msgs/BaseState[] base\ndwl_msgs/ContactState[] contacts",
    "old_dwl/msg/ContactState": "string name\ngeometry_msgs/Vector3 position\n"
    "geometry_msgs/Wrench wrench",
    "old_dwl/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "dwl_msgs/BaseState[] base\nold_dwl/ContactState[] contacts",
    "syropod_highlevel_controller/msg/TipState": "std_msgs/Header header\nstring[] name\n"
    "geometry_msgs/Wrench[] wrench\nfloat64[] proximity",
    "ocs2_msgs/msg/mpc_state": "float32[] value",
    "ocs2_msgs/msg/mpc_input": "float32[] value",
    "ocs2_msgs/msg/mpc_observation": "float64 time\nocs2_msgs/mpc_state state\n"
    "ocs2_msgs/mpc_input input\nint8 mode",
    "state_estimator_msgs/msg/ContactDetection": "std_msgs/Header header\nbool stance_lf\n"
    "bool stance_rf\nbool stance_lh\nbool stance_rh",
    "pronto_msgs/msg/QuadrupedStance": "std_msgs/Header header\nfloat32 lf\nfloat32 rf\n"
    "float32 lh\nfloat32 rh",
    "pronto_msgs/msg/QuadrupedForceTorqueSensors": "std_msgs/Header header\n"
    "geometry_msgs/Wrench lf\ngeometry_msgs/Wrench rf\ngeometry_msgs/Wrench lh\n"
    "geometry_msgs/Wrench rh",
    "quadropted_msgs/msg/RobotFootContact": "bool[4] contacts",
    "hrpsys_ros_bridge/msg/ContactState": "uint8 state\nfloat64 remaining_time",
    "hrpsys_ros_bridge/msg/ContactStateStamped": "std_msgs/Header header\n"
    "hrpsys_ros_bridge/ContactState state",
    "hrpsys_ros_bridge/msg/ContactStatesStamped": "std_msgs/Header header\n"
    "hrpsys_ros_bridge/ContactStateStamped[] states",
    "go2_interfaces/msg/Go2State": "uint32 mode\nfloat32 progress\n" + _SPORT,
    "my_driver/msg/SportModeState": "uint8 mode\n" + _SPORT,
}
