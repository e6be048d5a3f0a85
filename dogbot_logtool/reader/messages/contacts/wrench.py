"""geometry_msgs/WrenchStamped: a force sensor in a foot, in its own frame."""

from typing import Final

from dogbot_logtool.core.contact.contacts import Contacts
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.reader.decode.fields import HEADER, vector
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    FootLinks,
    flat_samples,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages

_FIELDS: Final = (*HEADER, *vector("wrench.force"))


def to_contact_samples(messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    table = messages.table
    foot = feet.single(messages.channel)
    force = table.vectors("wrench.force", "xyz")
    return ContactSamples(
        flat_samples(messages.log_time, foot, table.nanoseconds("header.stamp"), force)
    )


def sensor_frames(
    messages: DecodedMessages, feet: FootChannels, _contacts: Contacts | None
) -> FootLinks:
    """Return the frames that the sensors' headers name, by foot."""
    code, names = messages.table.texts("header.frame_id").encode()
    pairs = feet.single(messages.channel) * len(names) + code
    frames: dict[int, set[str]] = {}
    for pair in distinct(pairs).tolist():
        frame = names[pair % len(names)].lstrip("/")
        if frame:
            frames.setdefault(pair // len(names), set()).add(frame)
    return frames


SOURCE: Final = ContactSource(
    type_name="geometry_msgs/WrenchStamped",
    fields=_FIELDS,
    read=to_contact_samples,
    links=sensor_frames,
    frame=WrenchFrame.LINK,
    has_points=False,
    anything=True,
)
