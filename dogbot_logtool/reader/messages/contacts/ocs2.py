"""ocs2_msgs/mpc_observation: the mode of a legged robot's controller, and the forces it plans.

The mode's bits are the feet in contact. Robots without legs use the same message: only a state and
an input as long as those of a quadruped are about feet.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.fields import number, numbers
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues, MessageFoot
from dogbot_logtool.reader.messages.contacts.whole_robot import QUADRUPED, arrays_of_length
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_BITS: Final = (8, 4, 2, 1)
_STATE: Final = 24
"""Momentum, base pose, twelve joints."""
_INPUT: Final = 24
"""Forces on four feet, twelve joint velocities."""


def _values(messages: DecodedMessages, feet: Sequence[Foot]) -> FootValues:
    del feet
    rows = len(messages.channel)
    forces = arrays_of_length(messages, "input.value", _INPUT)[:, : 3 * len(QUADRUPED)]
    mode = messages.table.numbers("mode").astype(np.int64)
    flags = np.stack([(mode & bit) > 0 for bit in _BITS], axis=1).astype(np.float64)
    return FootValues(
        stamp=np.zeros(rows, np.int64),
        contact=flags,
        force=forces.reshape(rows, len(QUADRUPED), 3),
    )


def _feet_in(messages: DecodedMessages) -> tuple[MessageFoot, ...]:
    """Return the feet of a quadruped; none where the messages are of a robot without legs."""
    whole = np.isfinite(arrays_of_length(messages, "state.value", _STATE)).all(axis=1)
    whole &= np.isfinite(arrays_of_length(messages, "input.value", _INPUT)).all(axis=1)
    if not whole.any():
        return ()
    return tuple(MessageFoot(name=name) for name in QUADRUPED)


SOURCE: Final = ContactSource(
    type_name="ocs2_msgs/mpc_observation",
    fields=(number("mode"), numbers("state.value"), numbers("input.value")),
    values=_values,
    feet_in=_feet_in,
    any_package=True,
    plans="always",
    frame=WrenchFrame.WORLD,
    has_header=False,
    has_points=False,
    has_flags=True,
)
"""The forces are always planned. The mode is measured only where the controller's node puts its
contact estimate into it."""
