"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.base.poses import Transforms
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.writer import drawing
from dogbot_logtool.writer.channels import AddedChannels
from dogbot_logtool.writer.drawing import ArrowLook, SupportLook, SupportShape
from dogbot_logtool.writer.encodings.encoding import LOAD_STATES, Encoding, MessageType
from dogbot_logtool.writer.message_records import (
    MessageRecords,
    by_channel,
    kept_template,
    recorded,
)
from dogbot_logtool.writer.messages import (
    fill_arrows,
    fill_labels,
    leg_records,
    load_records,
    shown_records,
    support_records,
    transform_records,
)
from dogbot_logtool.writer.template import TEMPLATES_KEPT, Template
from dogbot_logtool.writer.topics import (
    EVENTS_TOPIC,
    GAIT_TOPIC,
    LEGS_TOPIC,
    ROBOT_DESCRIPTION_TOPIC,
    SPANS_TOPIC,
    SUPPORT_TOPIC,
    TF_TOPIC,
    arrow_topic,
    label_topic,
    load_topic,
)

_CDR_HEAD: Final = b"\x00\x01\x00\x00"
"""Little-endian CDR."""


@dataclass(frozen=True, slots=True)
class AnnotationColumns:
    """The annotations of a batch as columns."""

    transforms: Transforms
    arrows: Sequence[Arrows]
    loads: Sequence[Loads]
    support: Sequence[SupportScene] = ()
    labels: Sequence[Labels] = ()
    legs: Sequence[LegLines] = ()
    links: Sequence[LinkTransforms] = ()


@dataclass(frozen=True, slots=True)
class WantedAnnotations:
    """Which annotations an output has, and how they look."""

    feet: Sequence[str]
    world_frame: str
    base_frame: str
    arrows: ArrowLook
    base_transform: bool = True
    links: Sequence[tuple[str, str]] = ()
    """Frames of links, parent and child, whose transforms are written; none: no links."""
    support: SupportLook | None = None
    """None: there is no such topic; likewise `legs`."""
    legs: SupportLook | None = None
    description: MessageType | None = None
    """Type of the robot's description; None: there is none."""


@dataclass(frozen=True, slots=True)
class EventChannels:
    """Ids of the channels of what is known when the whole log was measured."""

    events: int
    gait: int
    spans: int | None
    """None: the encoding has no message for spans of time."""


class Annotations:
    """The annotations of one output; called in several threads or processes at once."""

    def __init__(self, encoding: Encoding, wanted: WantedAnnotations, added: AddedChannels) -> None:
        """Declare their channels, and learn the templates of their messages.

        Args:
            encoding: of the messages.
            wanted: which there are.
            added: takes the channels.

        Raises:
            LogtoolError: the log uses all ids that there are.
        """
        self.encoding, self.added, self._wanted = encoding, added, wanted
        feet, frame = wanted.feet, wanted.world_frame
        # All messages of an encoding have times in the same form.
        self._timed = kept_template(encoding.load, 0, LOAD_STATES[0])
        self._base: Template | None = None
        self._links: Template | None = None
        if wanted.base_transform or wanted.links:
            channel = added.declare(TF_TOPIC, encoding.transform_type)
            if wanted.base_transform:
                pair = frame, wanted.base_frame
                self._base = kept_template(encoding.transforms, channel, (pair,))
            if wanted.links:
                self._links = kept_template(encoding.transforms, channel, tuple(wanted.links))
        arrows = [added.declare(arrow_topic(foot), encoding.arrow_type) for foot in feet]
        loads = [added.declare(load_topic(foot), encoding.load_type) for foot in feet]
        labels = [added.declare(label_topic(foot), encoding.arrow_type) for foot in feet]
        self._arrows = [
            self._shown(channel, drawing.arrow(foot, frame, wanted.arrows))
            for foot, channel in zip(feet, arrows, strict=True)
        ]
        self._loads = [
            kept_template(encoding.load, channel, state)
            for channel in loads
            for state in LOAD_STATES
        ]
        self._labels = [
            self._shown(channel, drawing.label(foot, frame, name))
            for foot, name, channel in zip(feet, short_names(feet), labels, strict=True)
        ]
        self._support = self._legs = self._description = 0
        if wanted.support is not None:
            self._support = added.declare(SUPPORT_TOPIC, encoding.support_type)
        if wanted.legs is not None:
            self._legs = added.declare(LEGS_TOPIC, encoding.arrow_type)
        if wanted.description is not None:
            self._description = added.declare(ROBOT_DESCRIPTION_TOPIC, wanted.description)
        self.event_channels = _event_channels(encoding, added)

    def _shown(self, channel: int, drawn: drawing.Drawing) -> tuple[Template, Template]:
        """Return the messages that draw something, and remove it."""
        encoding = self.encoding
        return (
            kept_template(encoding.drawing, channel, drawn),
            kept_template(encoding.removal, channel, drawn),
        )

    def robot_description(self, urdf: str, log_time: int) -> MessageRecords:
        """Return the message that describes the robot."""
        if self._wanted.description is None:
            raise AssertionError("the output has no channel for a robot description")
        payload = np.frombuffer(_description_message(urdf, self._wanted.description), np.uint8)
        time, start, end = np.array([[log_time], [0], [len(payload)]])
        return recorded(np.array([self._description]), start, time, time, payload, start, end)

    def messages(self, columns: AnnotationColumns) -> Iterator[MessageRecords]:
        """Yield the messages of a batch; see `by_channel`."""
        return by_channel(self._parts(columns))

    def _parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of a batch, channel by channel."""
        stamps = partial(self._timed.stamps, "stamp")
        if self._base is not None:
            base = columns.transforms
            places = base.translation[:, None], base.rotation[:, None]
            yield transform_records(self._base, base.log_time, base.stamp, *places)
        if self._links is not None:
            for links in columns.links:
                places = links.poses.translation, links.poses.rotation
                yield transform_records(self._links, links.log_time, links.stamp, *places)
        for arrows in columns.arrows:
            fill = partial(fill_arrows, arrows)
            yield from shown_records(self._arrows, arrows, stamps(arrows.stamp), fill)
        for loads in columns.loads:
            yield from load_records(self._loads, loads, stamps(loads.stamp))
        for labels in columns.labels:
            fill = partial(fill_labels, labels)
            yield from shown_records(self._labels, labels, stamps(labels.stamp), fill)
        yield from self._scene_parts(columns)

    def _scene_parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of what is drawn of the whole robot."""
        wanted, frame, stamps = self._wanted, self._wanted.world_frame, self._timed.stamps
        if wanted.support is not None:
            support = partial(
                _support_template, self.encoding, self._support, frame, wanted.support
            )
            for scene in columns.support:
                yield from support_records(support, scene, stamps("stamp", scene.stamp))
        if wanted.legs is not None:
            legs = partial(_legs_template, self.encoding, self._legs, frame, wanted.legs)
            for lines in columns.legs:
                yield from leg_records(legs, lines, stamps("stamp", lines.stamp))


@lru_cache(TEMPLATES_KEPT)
def _support_template(
    encoding: Encoding, channel: int, frame: str, look: SupportLook, shape: SupportShape
) -> Template:
    return kept_template(encoding.drawing, channel, drawing.support(shape, frame, look))


@lru_cache(TEMPLATES_KEPT)
def _legs_template(
    encoding: Encoding, channel: int, frame: str, look: SupportLook, feet: tuple[int, ...]
) -> Template:
    """Return a message that draws the legs of some feet; without any, one that removes them all."""
    message = encoding.drawing if feet else encoding.removal
    return kept_template(message, channel, drawing.legs(feet, frame, look))


def description_type(profile: str) -> MessageType:
    """Return the type of the robot's description, a `std_msgs/String`.

    It is ROS 1 in files with that profile, else CDR.
    """
    if profile == "ros1":
        return MessageType("std_msgs/String", "ros1msg", b"string data\n", "ros1")
    return MessageType("std_msgs/msg/String", "ros2msg", b"string data\n", "cdr")


def _description_message(urdf: str, kind: MessageType) -> bytes:
    text = urdf.encode()
    if kind.message_encoding == "ros1":
        return struct.pack("<I", len(text)) + text
    return _CDR_HEAD + struct.pack("<I", len(text) + 1) + text + b"\x00"


def _event_channels(encoding: Encoding, added: AddedChannels) -> EventChannels:
    events = added.declare(EVENTS_TOPIC, encoding.event_type)
    gait = added.declare(GAIT_TOPIC, encoding.gait_type)
    kind = encoding.span_type
    return EventChannels(events, gait, None if kind is None else added.declare(SPANS_TOPIC, kind))
