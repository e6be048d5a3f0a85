"""dwl_msgs/WholeBodyState: the base as a list of its six joints, each known by a number."""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.rotations import from_roll_pitch_yaw
from dogbot_logtool.reader.decode.fields import HEADER, number, table
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages

_JOINTS: Final = 6
"""Roll, pitch, yaw, x, y, z, in the order of their numbers."""


def _read(messages: DecodedMessages, element: str) -> BasePoses:
    """Return the poses; one without x, y or z is NaN, an angle that is not told is 0."""
    del element
    nested, count = messages.table.nested("base"), len(messages.channel)
    joint = nested.table.numbers("id").astype(np.int64)
    position = nested.table.numbers("position").astype(np.float64)
    known = (joint >= 0) & (joint < _JOINTS)
    values = np.full((count, _JOINTS), np.nan)
    # A base that cannot turn has no joints for it.
    values[:, :3] = 0.0
    values[nested.parent[known], joint[known]] = position[known]
    _, worlds = messages.table.texts("header.frame_id").encode()
    stamp = messages.table.nanoseconds("header.stamp")
    turn = from_roll_pitch_yaw(values[:, :3])
    return BasePoses(
        poses=poses_of(messages.log_time, stamp, values[:, 3:], turn),
        channel=messages.channel,
        worlds=worlds,
        malformed=messages.malformed,
    )


SOURCE: Final = BaseSource(
    "dwl_msgs/WholeBodyState",
    (
        *HEADER,
        table("base", number("id"), number("position")),
    ),
    _read,
    any_package=True,
)
