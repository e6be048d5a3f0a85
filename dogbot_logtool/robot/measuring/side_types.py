"""Types of topics beside feet and base, apart so that logs without any load nothing for them."""

from typing import Final

from dogbot_logtool.reader.containers.log import Log

SIDE_TYPES: Final = frozenset(
    {"geometry_msgs/Twist", "geometry_msgs/TwistStamped", "sensor_msgs/Imu", "unitree_go/LowState"}
    | {"go2_interfaces/LowState", "unitree_legged_msgs/LowState"}
    | {"ros2_unitree_legged_msgs/LowState"}
)
"""Those that `side_topics` chooses of."""


def has_side_topics(log: Log) -> bool:
    """Tell whether a log may have velocity commands or an inertial unit."""
    return not SIDE_TYPES.isdisjoint(channel.type_name for channel in log.channels.values())
