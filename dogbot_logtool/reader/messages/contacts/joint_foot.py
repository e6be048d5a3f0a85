"""sensor_msgs/JointState with four feet behind twelve joints: raw counts as efforts.

Drivers of Unitree's A1 and Go1 publish it as ``joint_foot``. The efforts of the last four names are
the filtered counts of the feet; their velocities are planned contacts, which are not read.
"""

from typing import Final

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.reader.decode.fields import HEADER, numbers
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
)
from dogbot_logtool.reader.messages.contacts.unitree import raw_samples
from dogbot_logtool.reader.messages.contacts.whole_robot import QUADRUPED, arrays_of_length
from dogbot_logtool.reader.messages.messages import DecodedMessages

JOINTS: Final = 12


def _counts(messages: DecodedMessages) -> Floats:
    """(n, 4) counts; NaN in messages of another number of joints."""
    return arrays_of_length(messages, "effort", JOINTS + len(QUADRUPED))[:, JOINTS:]


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    stamp = messages.table.nanoseconds("header.stamp")
    return raw_samples(messages, feet, _counts(messages), stamp=stamp)


SOURCE: Final = ContactSource(
    type_name="sensor_msgs/JointState",
    fields=(*HEADER, numbers("effort")),
    read=to_contact_samples,
    elements=QUADRUPED,
    topic_end="joint_foot",
    frame=WrenchFrame.UNKNOWN,
    has_points=False,
    is_raw=True,
)
