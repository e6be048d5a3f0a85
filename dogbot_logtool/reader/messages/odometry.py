"""nav_msgs/Odometry to columns."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.base.odometry import Odometry, concatenate_odometry
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.fields import text, time, vector
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
)

ODOMETRY_TYPE: Final = "nav_msgs/Odometry"
_FIELDS: Final = (
    time("header.stamp"),
    text("header.frame_id"),
    text("child_frame_id"),
    *vector("pose.pose.position"),
    *vector("pose.pose.orientation", "xyzw"),
    *vector("twist.twist.linear"),
    *vector("twist.twist.angular"),
)


def check_odometry(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, _FIELDS)


def decode_odometry(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the odometry messages of a batch; see `decode_channels`."""
    return decode_channels(batch, channels, _FIELDS)


def odometry_columns(messages: DecodedMessages) -> Odometry:
    """Return the columns of decoded odometry messages."""
    table = messages.table
    return Odometry(
        log_time=messages.log_time,
        stamp=table.nanoseconds("header.stamp"),
        position=table.vectors("pose.pose.position", "xyz"),
        orientation=table.vectors("pose.pose.orientation", "xyzw"),
        linear_velocity=table.vectors("twist.twist.linear", "xyz"),
        angular_velocity=table.vectors("twist.twist.angular", "xyz"),
    )


def joined_odometry(decoded: Sequence[DecodedMessages]) -> Odometry:
    """Return the columns of all decoded odometry messages, in the order of the log."""
    return concatenate_odometry([odometry_columns(messages) for messages in decoded])


def odometry_frames(messages: DecodedMessages) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the different header frame ids and child frame ids, as recorded."""
    _, parents = messages.table.texts("header.frame_id").encode()
    _, children = messages.table.texts("child_frame_id").encode()
    return parents, children
