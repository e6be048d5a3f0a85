"""States of Unitree's robots: raw counts of the pressure sensors in all feet, and no header.

Offset and scale of the counts differ from foot to foot and are nowhere documented, so both stand
in the robot's file: newtons = newtons_per_count x (counts - offset). Without a scale the counts
only tell whether a foot touches, and only if the file says from how many counts on.
"""

from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.reader.decode.fields import fixed_numbers
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSource,
    Felt,
    FootChannels,
    each_foot,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LEGS: Final = ("front_right", "front_left", "back_right", "back_left")
"""The order of every array in Unitree's messages: FR, FL, RR, RL."""


def _counts_felt(messages: DecodedMessages, feet: FootChannels, *, field: str) -> Felt:
    """Reduce messages to samples; see `ContactSource.read`."""
    counts = messages.table.numbers(field).astype(np.float64)
    on_counts = feet.contact_on_counts

    def newtons(foot: Foot, counts: Floats) -> Floats:
        loaded = counts - foot.offset
        if foot.newtons_per_count is not None:
            force = np.maximum(foot.newtons_per_count * loaded, 0.0)
            return np.where(force < feet.release_n, 0.0, force)
        return np.where(loaded >= (on_counts or 0.0), np.nan, 0.0)

    for foot in feet.feet:
        if foot.newtons_per_count is None and on_counts is None and foot.element is not None:
            # Neither force nor contact can be known of it.
            counts[:, foot.element : foot.element + 1] = np.nan
    stamp = np.zeros(len(messages.channel), np.int64)
    return each_foot(messages, feet, stamp, counts, newtons)


def _source(type_name: str, field: str) -> ContactSource:
    return ContactSource(
        type_name=type_name,
        fields=(fixed_numbers(field, at_least=len(_LEGS)),),
        read=partial(_counts_felt, field=field),
        elements=_LEGS,
        frame=WrenchFrame.UNKNOWN,
        has_header=False,
        has_points=False,
        is_raw=True,
    )


SOURCES: Final = (
    _source("unitree_legged_msgs/LowState", "footForce"),
    _source("unitree_go/LowState", "foot_force"),
    _source("go2_interfaces/LowState", "foot_force"),
    _source("ros2_unitree_legged_msgs/LowState", "foot_force"),
    _source("unitree_legged_msgs/HighState", "footForce"),
    _source("unitree_go/SportModeState", "foot_force"),
    _source("ros2_unitree_legged_msgs/HighState", "foot_force"),
)
"""A1 and Go1 speak `unitree_legged_msgs`, Go2 `unitree_go`; the others are well-known drivers'.
Low-level states come first: where a robot publishes both, they come more often."""
