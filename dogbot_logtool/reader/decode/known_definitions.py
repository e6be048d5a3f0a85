"""Definitions of message types for logs that do not record them, as old ROS 2 bags do not."""

from functools import lru_cache
from typing import TYPE_CHECKING, Final

from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.reader.decode.message_layout import Serialisation

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_SHIPPED: Final = {
    "gazebo_msgs/msg/ContactState": """
        string info
        string collision1_name
        string collision2_name
        geometry_msgs/Wrench[] wrenches
        geometry_msgs/Wrench total_wrench
        geometry_msgs/Vector3[] contact_positions
        geometry_msgs/Vector3[] contact_normals
        float64[] depths
    """,
    "gazebo_msgs/msg/ContactsState": """
        std_msgs/Header header
        gazebo_msgs/ContactState[] states
    """,
    "tf2_msgs/msg/TFMessage": """
        geometry_msgs/TransformStamped[] transforms
    """,
    "tf/msg/tfMessage": """
        geometry_msgs/TransformStamped[] transforms
    """,
    "ros_gz_interfaces/msg/Entity": """
        uint64 id
        string name
        uint8 type
    """,
    "ros_gz_interfaces/msg/JointWrench": """
        std_msgs/Header header
        std_msgs/String body_1_name
        std_msgs/UInt32 body_1_id
        std_msgs/String body_2_name
        std_msgs/UInt32 body_2_id
        geometry_msgs/Wrench body_1_wrench
        geometry_msgs/Wrench body_2_wrench
    """,
    "ros_gz_interfaces/msg/Contact": """
        ros_gz_interfaces/Entity collision1
        ros_gz_interfaces/Entity collision2
        geometry_msgs/Vector3[] positions
        geometry_msgs/Vector3[] normals
        float64[] depths
        ros_gz_interfaces/JointWrench[] wrenches
    """,
    "ros_gz_interfaces/msg/Contacts": """
        std_msgs/Header header
        ros_gz_interfaces/Contact[] contacts
    """,
    "champ_msgs/msg/ContactsStamped": """
        std_msgs/Header header
        bool[] contacts
    """,
    "unitree_go/msg/TimeSpec": """
        int32 sec
        uint32 nanosec
    """,
    "unitree_go/msg/IMUState": """
        float32[4] quaternion
        float32[3] gyroscope
        float32[3] accelerometer
        float32[3] rpy
        int8 temperature
    """,
    "unitree_go/msg/MotorState": """
        uint8 mode
        float32 q
        float32 dq
        float32 ddq
        float32 tau_est
        float32 q_raw
        float32 dq_raw
        float32 ddq_raw
        int8 temperature
        uint32 lost
        uint32[2] reserve
    """,
    "unitree_go/msg/BmsState": """
        uint8 version_high
        uint8 version_low
        uint8 status
        uint8 soc
        int32 current
        uint16 cycle
        int8[2] bq_ntc
        int8[2] mcu_ntc
        uint16[15] cell_vol
    """,
    "unitree_go/msg/LowState": """
        uint8[2] head
        uint8 level_flag
        uint8 frame_reserve
        uint32[2] sn
        uint32[2] version
        uint16 bandwidth
        unitree_go/IMUState imu_state
        unitree_go/MotorState[20] motor_state
        unitree_go/BmsState bms_state
        int16[4] foot_force
        int16[4] foot_force_est
        uint32 tick
        uint8[40] wireless_remote
        uint8 bit_flag
        float32 adc_reel
        int8 temperature_ntc1
        int8 temperature_ntc2
        float32 power_v
        float32 power_a
        uint16[4] fan_frequency
        uint32 reserve
        uint32 crc
    """,
    "unitree_go/msg/SportModeState": """
        unitree_go/TimeSpec stamp
        uint32 error_code
        unitree_go/IMUState imu_state
        uint8 mode
        float32 progress
        uint8 gait_type
        float32 foot_raise_height
        float32[3] position
        float32 body_height
        float32[3] velocity
        float32 yaw_speed
        float32[4] range_obstacle
        int16[4] foot_force
        float32[12] foot_position_body
        float32[12] foot_speed_body
    """,
}
"""Types that rosbags' stores do not have, and whose layout never changed. (Those of
`unitree_legged_msgs` and `spot_msgs` differ from version to version: only a log that records them
can be read.)"""


def long_type_name(name: str) -> str:
    """Return ``package/msg/Name``, as ROS 2 spells it, for either spelling."""
    package, _, message = short_type_name(name).rpartition("/")
    return f"{package}/msg/{message}" if package and "/" not in package else name


def known_definition(
    type_name: str, distribution: str = "", serialisation: Serialisation = "cdr"
) -> str | None:
    """Return the definition of a type with all that it depends on.

    Args:
        type_name: ``nav_msgs/msg/Odometry``.
        distribution: name of the ROS 2 distribution that recorded the log; empty: not known.
        serialisation: of ROS 1 or of ROS 2.

    Returns:
        the text as ``ros1msg`` or ``ros2msg``; None for a type that is not known.
    """
    from rosbags.typesys import TypesysError  # noqa: PLC0415 - takes long to import

    is_ros1 = serialisation == "ros1"
    store = _store("ros1" if is_ros1 else distribution)
    name = long_type_name(type_name)
    if name not in store.fielddefs:
        return None
    try:
        return store.generate_msgdef(name, ros_version=1 if is_ros1 else 2)[0]
    except (TypesysError, KeyError):
        return None


@lru_cache(maxsize=4)
def _store(distribution: str) -> "Typestore":
    """Return rosbags' types of a ROS 2 distribution, or of ROS 1, with those that it lacks."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: PLC0415

    named = {store.name.rpartition("_")[2].lower(): store for store in Stores}
    named["ros1"] = Stores.ROS1_NOETIC
    store = get_typestore(named.get(distribution.lower(), Stores.ROS2_HUMBLE))
    for name, text in _SHIPPED.items():
        if name not in store.fielddefs:
            store.register(get_types_from_msg(text, name))
    return store
