"""Definitions of message types for logs that do not record them, as ROS 2 bags of old do not."""

from functools import lru_cache
from typing import TYPE_CHECKING, Final

from dogbot_logtool.reader.definition import short_type_name

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
}
"""Types that rosbags' stores do not have."""


def long_type_name(name: str) -> str:
    """Return ``package/msg/Name``, as ROS 2 spells it, for either spelling."""
    package, _, message = short_type_name(name).rpartition("/")
    return f"{package}/msg/{message}" if package and "/" not in package else name


def known_definition(type_name: str, distribution: str) -> str | None:
    """Return the definition of a ROS 2 type with all that it depends on.

    Args:
        type_name: ``nav_msgs/msg/Odometry``.
        distribution: name of the ROS 2 distribution that recorded the log; empty: not known.

    Returns:
        the text as ``ros2msg``; None when nobody knows the type.
    """
    from rosbags.typesys import TypesysError  # noqa: PLC0415 - takes long to import

    store = _store(distribution)
    name = long_type_name(type_name)
    if name not in store.fielddefs:
        return None
    try:
        return store.generate_msgdef(name, ros_version=2)[0]
    except (TypesysError, KeyError):
        return None


@lru_cache(maxsize=4)
def _store(distribution: str) -> "Typestore":
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: PLC0415

    named = {store.name.rpartition("_")[2].lower(): store for store in Stores}
    store = get_typestore(named.get(distribution.lower(), Stores.ROS2_HUMBLE))
    for name, text in _SHIPPED.items():
        store.register(get_types_from_msg(text, name))
    return store
