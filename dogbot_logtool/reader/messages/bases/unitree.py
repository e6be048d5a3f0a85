"""High-level states of Unitree's robots: position and quaternion (w, x, y, z) in arrays.

Log time is used: their stamps, where there are any, are those of the robot's own clock.
"""

from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.reader.decode.fields import fixed_numbers
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages

_XYZW: Final = [1, 2, 3, 0]


def _read(messages: DecodedMessages, element: str, *, quaternion: str) -> BasePoses:
    """Read position and quaternion of each message."""
    del element
    table = messages.table
    poses = poses_of(
        messages.log_time,
        np.zeros(len(messages.channel), np.int64),
        table.numbers("position").astype(np.float64)[:, :3],
        table.numbers(quaternion).astype(np.float64)[:, _XYZW],
    )
    return BasePoses(poses, messages.channel, malformed=messages.malformed)


def _source(type_name: str, imu: str) -> BaseSource:
    quaternion = f"{imu}.quaternion"
    fields = (fixed_numbers("position", 3), fixed_numbers(quaternion, 4))
    read = partial(_read, quaternion=quaternion)
    return BaseSource(type_name, fields, read, has_header=False, any_package=True)


SOURCES: Final = (
    _source("unitree_go/SportModeState", "imu_state"),
    _source("unitree_go/SportModeState", "imu"),
    _source("unitree_legged_msgs/HighState", "imu"),
    _source("ros2_unitree_legged_msgs/HighState", "imu"),
)
