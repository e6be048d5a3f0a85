"""Annotations of two feet, and what is written of them."""

from collections.abc import Callable, Sequence
from io import BytesIO
from typing import Any

import numpy as np
from mcap import records
from mcap.data_stream import ReadDataStream

from dogbot_logtool.core.base.poses import Transforms
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.writer.annotations import (
    AnnotationColumns,
    Annotations,
    WantedAnnotations,
)
from dogbot_logtool.writer.channels import AddedChannels, IdSource
from dogbot_logtool.writer.drawing import ArrowLook
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from dogbot_logtool.writer.encodings.ros import Ros1Encoding, Ros2Encoding

FEET = ("left", "right")
ENCODINGS = (FoxgloveEncoding(), Ros1Encoding(), Ros2Encoding())


def declared(
    encoding: Encoding,
    feet: Sequence[str] = FEET,
    *,
    with_tf: bool = True,
    description: MessageType | None = None,
    used: frozenset[int] = frozenset(),
    resolve: Callable[[str, MessageType], str] = lambda topic, _: topic,
) -> Annotations:
    wanted = WantedAnnotations(
        feet,
        "world",
        "base",
        ArrowLook(0.04, 0.5),
        base_transform=with_tf,
        description=description,
    )
    return Annotations(encoding, wanted, AddedChannels(IdSource(used), IdSource(used), resolve))


def no_transforms() -> Transforms:
    nothing = np.empty(0, np.int64)
    return Transforms(nothing, nothing, np.empty((0, 3)), np.empty((0, 4)))


def arrows(foot: list[int], times: list[int], shown: list[bool]) -> Arrows:
    count = len(foot)
    return Arrows(
        foot=np.array(foot, np.int64),
        log_time=np.array(times, np.int64),
        stamp=np.array(times, np.int64) + 5,
        shown=np.array(shown, np.bool_),
        position=np.arange(count * 3.0).reshape(count, 3),
        orientation=np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
        length=np.arange(1.0, count + 1.0),
        colour=np.tile(np.array([1.0, 0.5, 0.25, 1.0], np.float32), (count, 1)),
    )


def loads(foot: list[int], times: list[int]) -> Loads:
    count = len(foot)
    return Loads(
        foot=np.array(foot, np.int64),
        log_time=np.array(times, np.int64),
        stamp=np.array(times, np.int64),
        in_contact=np.ones(count, np.bool_),
        state=np.zeros(count, np.int64),
        force=np.arange(float(count)),
        body_weights=np.full(count, np.nan),
    )


def messages_of(annotations: Annotations, columns: AnnotationColumns) -> list[tuple[str, Any]]:
    laid = b"".join(group.data.tobytes() for group in annotations.messages(columns))
    stream = BytesIO(laid)
    topics = annotations.added.topics()
    found: list[tuple[str, Any]] = []
    while stream.tell() < len(laid):
        data = ReadDataStream(stream)
        assert data.read1() == 5
        message = records.Message.read(data, data.read8())
        found.append((topics[message.channel_id], message))
    return found
