"""foxglove.FrameTransforms and foxglove.FrameTransform to columns.

What `convert` writes must be found again by `info`. Protobuf is decoded message by message, by
the official library; such channels carry some 50 messages a second, not thousands.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.plausible import plausible_translations
from dogbot_logtool.reader.containers.log import Batch, Channel

if TYPE_CHECKING:
    from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform

_MANY: Final = "foxglove.FrameTransforms"
_ONE: Final = "foxglove.FrameTransform"
FOXGLOVE_TYPES: Final = frozenset({_MANY, _ONE})
_LARGEST: Final = 1 << 20
"""Bytes of a message, some ten thousand transforms; decoded, a hostile one takes much more."""
_LAST_SECOND: Final = (1 << 63) // 1_000_000_000 - 1


@dataclass(slots=True)
class _Rows:
    """Transforms, one after another."""

    channel: list[int] = field(default_factory=list)
    log_time: list[int] = field(default_factory=list)
    stamp: list[int] = field(default_factory=list)
    parent: list[int] = field(default_factory=list)
    child: list[int] = field(default_factory=list)
    pose: list[tuple[float, ...]] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)

    def add(self, channel: int, log_time: int, transform: "FrameTransform") -> None:
        move, turn = transform.translation, transform.rotation
        self.channel.append(channel)
        self.log_time.append(log_time)
        self.stamp.append(_nanoseconds(transform))
        for column, name in (
            (self.parent, transform.parent_frame_id),
            (self.child, transform.child_frame_id),
        ):
            column.append(self.names.setdefault(name, len(self.names)))
        self.pose.append((move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w))

    def columns(self) -> RecordedTransforms:
        pose = np.array(self.pose, np.float64).reshape(-1, 7)
        names = tuple(self.names)
        return RecordedTransforms(
            channel=np.array(self.channel, np.int64),
            log_time=np.array(self.log_time, np.int64),
            stamp=np.array(self.stamp, np.int64),
            parent=np.array(self.parent, np.int64),
            parents=names,
            child=np.array(self.child, np.int64),
            children=names,
            translation=plausible_translations(pose[:, :3]),
            rotation=pose[:, 3:],
        )


def foxglove_transforms(
    batch: Batch, channels: Sequence[Channel]
) -> tuple[RecordedTransforms, dict[int, int]]:
    """Decode the transforms of a batch.

    Args:
        batch: the batch.
        channels: channels of `FOXGLOVE_TYPES`, encoded as protobuf.

    Returns:
        the transforms, and the number of messages that could not be decoded by channel id.
    """
    types = {channel.id: channel.type_name for channel in channels}
    messages = batch.messages
    rows = _Rows()
    malformed: dict[int, int] = {}
    for row in np.flatnonzero(np.isin(messages.channel, list(types))).tolist():
        channel = int(messages.channel[row])
        payload = batch.buffer[messages.start[row] : messages.end[row]]
        transforms = _parsed(types[channel], payload.tobytes())
        if transforms is None:
            malformed[channel] = malformed.get(channel, 0) + 1
            continue
        for transform in transforms:
            rows.add(channel, int(messages.log_time[row]), transform)
    return rows.columns(), malformed


def _parsed(type_name: str, payload: bytes) -> Iterable["FrameTransform"] | None:
    """Return the transforms of a message; None if it cannot be decoded."""
    # Imported late: other logs need no protobuf.
    from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform  # noqa: PLC0415
    from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms  # noqa: PLC0415
    from google.protobuf.message import DecodeError  # noqa: PLC0415

    if len(payload) > _LARGEST:
        return None
    try:
        if type_name == _ONE:
            return [FrameTransform.FromString(payload)]
        return FrameTransforms.FromString(payload).transforms
    except DecodeError:
        return None


def _nanoseconds(transform: "FrameTransform") -> int:
    """Return the stamp, ns; 0, which is none, where it is outside what 64 bits hold."""
    seconds, nanoseconds = transform.timestamp.seconds, transform.timestamp.nanos
    inside = 0 <= seconds <= _LAST_SECOND and 0 <= nanoseconds < 1_000_000_000
    return seconds * 1_000_000_000 + nanoseconds if inside else 0
