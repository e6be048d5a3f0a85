"""Velocity commands and inertial units: vectors that single messages hold."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.blocks import concatenated
from dogbot_logtool.core.recorded.vectors import VectorSamples
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.fields import Fields, fixed_numbers, number, text, time, vector
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
    malformed_in,
)


@dataclass(frozen=True, slots=True)
class VectorSource:
    """How messages of a type hold three numbers."""

    type_name: str
    numbers: tuple[str, ...]
    """Paths of three numbers, or of one fixed array of three."""
    header: str = ""
    """Path of the header; empty: there is none, and log time is the only time."""

    @property
    def fields(self) -> Fields:
        """Fields that are read of each message."""
        values = (
            tuple(number(path) for path in self.numbers)
            if len(self.numbers) > 1
            else (fixed_numbers(self.numbers[0], 3),)
        )
        head = (time(f"{self.header}.stamp"), text(f"{self.header}.frame_id"))
        return (*values, *head) if self.header else values


def _velocity(twist: str = "") -> tuple[str, ...]:
    paths = ("linear.x", "linear.y", "angular.z")
    return tuple(f"{twist}.{path}" if twist else path for path in paths)


def _parts(path: str) -> tuple[str, ...]:
    return tuple(each.path for each in vector(path))


COMMANDS: Final = {
    source.type_name: source
    for source in (
        VectorSource("geometry_msgs/Twist", _velocity()),
        VectorSource("geometry_msgs/TwistStamped", _velocity("twist"), "header"),
    )
}
"""Linear x and y in m/s and angular z in rad/s, by type."""
INERTIAL_UNITS: Final = {
    source.type_name: source
    for source in (
        VectorSource("sensor_msgs/Imu", _parts("linear_acceleration"), "header"),
        VectorSource("unitree_go/LowState", ("imu_state.accelerometer",)),
        VectorSource("go2_interfaces/LowState", ("imu_state.accelerometer",)),
        VectorSource("unitree_legged_msgs/LowState", ("imu.accelerometer",)),
        VectorSource("ros2_unitree_legged_msgs/LowState", ("imu.accelerometer",)),
    )
}
"""Fields of accelerations, m/s^2, by type; the best first."""


@dataclass(frozen=True, slots=True)
class ReadVectors:
    """Vectors of a batch."""

    samples: VectorSamples
    frames: tuple[str, ...]
    """Header frame ids among them."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""


def check_vectors(channel: Channel, sources: Mapping[str, VectorSource]) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`.

    Raises:
        DefinitionError: they cannot.
    """
    return check_channel(channel, sources[channel.type_name].fields)


def read_vectors(
    batch: Batch, channels: Sequence[Channel], sources: Mapping[str, VectorSource]
) -> ReadVectors:
    """Read the vectors of a batch, of the senders of one topic, in the order of their log times.

    Args:
        batch: the batch.
        channels: those that `check_vectors` accepts, all of one type.
        sources: of that type.
    """
    source = sources[channels[0].type_name]
    decoded = decode_channels(batch, channels, source.fields)
    parts = [_samples(messages, source) for messages in decoded]
    samples = concatenated([_NONE, *parts])
    if len(parts) > 1:
        samples = samples.pick(np.argsort(samples.log_time, kind="stable"))
    frames = {frame for messages in decoded for frame in _frames(messages, source)}
    return ReadVectors(samples, tuple(sorted(frames)), malformed_in(decoded))


_NONE: Final = VectorSamples(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)))


def _samples(messages: DecodedMessages, source: VectorSource) -> VectorSamples:
    table, count = messages.table, len(messages.channel)
    if len(source.numbers) > 1:
        columns = [table.numbers(path).astype(np.float64) for path in source.numbers]
        values = np.stack(columns, axis=1)
    else:
        values = table.numbers(source.numbers[0]).astype(np.float64)[:, :3]
    stamp = table.nanoseconds(f"{source.header}.stamp") if source.header else None
    return VectorSamples(
        messages.log_time, np.zeros(count, np.int64) if stamp is None else stamp, values
    )


def _frames(messages: DecodedMessages, source: VectorSource) -> tuple[str, ...]:
    if not source.header:
        return ()
    return messages.table.texts(f"{source.header}.frame_id").encode()[1]
