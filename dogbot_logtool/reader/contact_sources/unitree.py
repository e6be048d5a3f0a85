"""LowState of Unitree's robots: raw counts of the pressure sensors in all feet, and no header.

Offset and scale of the counts differ from foot to foot and are nowhere documented, so both stand
in the robot's file: newtons = newtons_per_count x (counts - offset).
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.wrench_frame import WrenchFrame
from dogbot_logtool.reader.contact_sources.source import (
    ContactSource,
    Felt,
    FootChannels,
    each_foot,
    fixed_numbers,
)
from dogbot_logtool.reader.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LEGS: Final = ("front_right", "front_left", "back_right", "back_left")
"""The order of every array in Unitree's messages: FR, FL, RR, RL."""


def _source(type_name: str, field: str) -> ContactSource:
    def counts_felt(messages: DecodedMessages, feet: FootChannels) -> Felt:
        """Reduce messages to samples; see `ContactSource.read`."""

        def newtons(foot: Foot, counts: Floats) -> Floats:
            force = np.maximum(foot.newtons_per_count * (counts - foot.offset), 0.0)
            return np.where(force < feet.release_n, 0.0, force)

        stamp = np.zeros(len(messages.channel), np.int64)
        return each_foot(messages, feet, stamp, fixed_numbers(messages.table, field), newtons)

    return ContactSource(
        type_name=type_name,
        wanted=(field,),
        read=counts_felt,
        elements=_LEGS,
        frame=WrenchFrame.UNKNOWN,
        has_header=False,
        has_points=False,
        is_raw=True,
    )


LEGGED_SOURCE: Final = _source("unitree_legged_msgs/LowState", "footForce")
"""A1, Go1 and other robots of the older interface."""
GO_SOURCE: Final = _source("unitree_go/LowState", "foot_force")
"""Go2."""
