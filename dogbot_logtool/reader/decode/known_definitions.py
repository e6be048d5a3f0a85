"""Definitions of message types for logs that do not record them, as old ROS 2 bags do not."""

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dogbot_logtool.reader.decode.definition import long_type_name
from dogbot_logtool.reader.decode.message_layout import Serialisation

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_SHIPPED: Final = Path(__file__).with_name("definitions")
"""Types that rosbags' stores do not have, and whose layout never changed, a file each. (Those of
`unitree_legged_msgs` and `spot_msgs` differ from version to version: only a log that records them
can be read.)"""


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
    for file in sorted(_SHIPPED.glob("*/*.msg")):
        name = f"{file.parent.name}/msg/{file.stem}"
        if name not in store.fielddefs:
            store.register(get_types_from_msg(file.read_text(encoding="utf-8"), name))
    return store
