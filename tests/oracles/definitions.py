"""Definitions of the types of messages that the walks are told in."""

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
CELLS: Final = tuple(
    f"{foot}_foot_{end}_{side}"
    for foot in "lr"
    for end in ("front", "back")
    for side in ("left", "right")
)
"""As NAO's soles have them: four in each foot."""
DEFINITIONS: Final = {
    "gazebo_msgs/msg/ContactState": "string info\nstring collision1_name\nstring collision2_name\n"
    "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
    "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\n"
    "float64[] depths",
    "gazebo_msgs/msg/ContactsState": "std_msgs/Header header\ngazebo_msgs/ContactState[] states",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "ros_gz_interfaces/msg/Entity": "uint8 LINK=3\nuint64 id\nstring name\nuint8 type",
    "ros_gz_interfaces/msg/JointWrench": "std_msgs/Header header\nstd_msgs/String body_1_name\n"
    "std_msgs/UInt32 body_1_id\nstd_msgs/String body_2_name\nstd_msgs/UInt32 body_2_id\n"
    "geometry_msgs/Wrench body_1_wrench\ngeometry_msgs/Wrench body_2_wrench",
    "ros_gz_interfaces/msg/Contact": "ros_gz_interfaces/Entity collision1\n"
    "ros_gz_interfaces/Entity collision2\ngeometry_msgs/Vector3[] positions\n"
    "geometry_msgs/Vector3[] normals\nfloat64[] depths\nros_gz_interfaces/JointWrench[] wrenches",
    "ros_gz_interfaces/msg/Contacts": "std_msgs/Header header\n"
    "ros_gz_interfaces/Contact[] contacts",
    "unitree_legged_msgs/msg/LowState": "uint8[2] head\nuint32[2] SN\nfloat32[4] quaternion\n"
    "int16[4] footForce\nint16[4] footForceEst\nuint32 tick\nuint8[40] wirelessRemote\nuint32 crc",
    "unitree_go/msg/LowState": "uint8[2] head\nuint8 level_flag\nuint16 bandwidth\n"
    "int16[4] foot_force\nint16[4] foot_force_est\nuint32 tick\nuint8[40] wireless_remote",
    "unitree_legged_msgs/msg/HighState": "uint8[2] head\nuint8 mode\nint16[4] footForce\n"
    "int16[4] footForceEst\nfloat32[3] position",
    "unitree_go/msg/TimeSpec": "int32 sec\nuint32 nanosec",
    "unitree_go/msg/SportModeState": "unitree_go/TimeSpec stamp\nuint32 error_code\n"
    "unitree_go/IMUState imu_state\nfloat32[3] position\nfloat32[3] velocity\n"
    "int16[4] foot_force\nfloat32[12] foot_position_body",
    "spot_msgs/msg/FootState": "geometry_msgs/Point foot_position_rt_body\nuint8 contact",
    "spot_msgs/msg/FootStateArray": "spot_msgs/FootState[] states",
    "champ_msgs/msg/ContactsStamped": "std_msgs/Header header\nbool[] contacts",
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
    "geometry_msgs/PoseStamped pose\ngeometry_msgs/TwistStamped twist\n"
    "anymal_msgs/Contact[] contacts",
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
    "quad_msgs/msg/BodyState": "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist",
    "quad_msgs/msg/RobotState": "std_msgs/Header header\nuint32 traj_index\n"
    "quad_msgs/BodyState body",
    "gazebo_msgs/msg/ModelStates": "string[] name\ngeometry_msgs/Pose[] pose\n"
    "geometry_msgs/Twist[] twist",
    "gazebo_msgs/msg/LinkStates": "string[] name\ngeometry_msgs/Pose[] pose\n"
    "geometry_msgs/Twist[] twist",
    "unitree_go/msg/IMUState": "float32[4] quaternion\nfloat32[3] rpy",
    "odd_msgs/msg/Reading": "float32 value\n",
    "odd_msgs/msg/LoadCell": "uint32 rows\nuint32 cols\nfloat32[] data\n",
    "odd_msgs/msg/Counts": "int16 value\n",
    "odd_msgs/msg/Touch": "bool is_down\n",
    "odd_msgs/msg/Bits": "int8 foot_contacts\nfloat32 battery\nuint32 contact_number\n",
    "odd_msgs/msg/Pressures": "".join(f"float64 {leg}_foot\n" for leg in ("LF", "RF", "LH", "RH")),
    "odd_msgs/msg/Soles": "".join(f"float32 {cell}\n" for cell in CELLS),
    "odd_msgs/msg/Pad": "string name\nfloat64 load\n",
    "odd_msgs/msg/Pads": "odd_msgs/Pad[] pads\n",
    "odd_msgs/msg/Tips": "string[] name\ngeometry_msgs/Wrench[] wrench\n",
    "odd_msgs/msg/Leg": "string name\nint16 counts\ngeometry_msgs/Vector3 force\nfloat32[] cells\n",
    "odd_msgs/msg/State": (
        "std_msgs/Header header\nodd_msgs/Leg[] legs\nfloat64[4] loads\nuint8[] flags\n"
        "geometry_msgs/Wrench left\ngeometry_msgs/Wrench right\n"
    ),
}
