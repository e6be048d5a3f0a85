"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.base.poses import Transforms
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.writer.channels import AddedChannels
from dogbot_logtool.writer.encodings.encoding import (
    LOAD_STATES,
    ArrowLook,
    Encoding,
    MessageType,
    SupportLook,
)
from dogbot_logtool.writer.message_records import (
    MessageRecords,
    by_channel,
    kept_template,
    recorded,
)
from dogbot_logtool.writer.messages.arrows import ArrowWriter
from dogbot_logtool.writer.messages.labels import LabelWriter
from dogbot_logtool.writer.messages.legs import LegsWriter
from dogbot_logtool.writer.messages.loads import LoadWriter
from dogbot_logtool.writer.messages.robot_description import description_message
from dogbot_logtool.writer.messages.support import SupportWriter
from dogbot_logtool.writer.messages.transforms import BaseTransformWriter, LinkTransformWriter
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
        self.encoding, self.added, frame = encoding, added, wanted.world_frame
        # All messages of an encoding have times in the same form.
        self._timed = kept_template(encoding.load, 0, LOAD_STATES[0])
        self._base: BaseTransformWriter | None = None
        self._links: LinkTransformWriter | None = None
        if wanted.base_transform or wanted.links:
            channel = added.declare(TF_TOPIC, encoding.transform_type)
            if wanted.base_transform:
                self._base = BaseTransformWriter(channel, encoding, frame, wanted.base_frame)
            if wanted.links:
                self._links = LinkTransformWriter(channel, encoding, wanted.links)
        arrows = {
            foot: added.declare(arrow_topic(foot), encoding.arrow_type) for foot in wanted.feet
        }
        self._arrows = ArrowWriter(arrows, encoding, frame, wanted.arrows)
        loads = [added.declare(load_topic(foot), encoding.load_type) for foot in wanted.feet]
        self._loads = LoadWriter(loads, encoding)
        labels = {
            foot: added.declare(label_topic(foot), encoding.arrow_type) for foot in wanted.feet
        }
        self._labels = LabelWriter(labels, encoding, frame)
        self._support: SupportWriter | None = None
        if wanted.support is not None:
            channel = added.declare(SUPPORT_TOPIC, encoding.support_type)
            self._support = SupportWriter(channel, encoding, frame, wanted.support)
        self._legs: LegsWriter | None = None
        if wanted.legs is not None:
            channel = added.declare(LEGS_TOPIC, encoding.arrow_type)
            self._legs = LegsWriter(channel, encoding, frame, wanted.legs)
        self._description = wanted.description
        self._description_channel = 0
        if wanted.description is not None:
            self._description_channel = added.declare(ROBOT_DESCRIPTION_TOPIC, wanted.description)
        self.event_channels = _event_channels(encoding, added)

    def robot_description(self, urdf: str, log_time: int) -> MessageRecords:
        """Return the message that describes the robot."""
        if self._description is None:
            raise AssertionError("the output has no channel for a robot description")
        payload = np.frombuffer(description_message(urdf, self._description), np.uint8)
        time, start, end = np.array([[log_time], [0], [len(payload)]])
        channel = np.array([self._description_channel])
        return recorded(channel, start, time, time, payload, start, end)

    def messages(self, columns: AnnotationColumns) -> Iterator[MessageRecords]:
        """Yield the messages of a batch; see `by_channel`."""
        return by_channel(self._parts(columns))

    def _parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of a batch, channel by channel."""
        stamps = self._timed.stamps
        if self._base is not None:
            yield self._base.records(columns.transforms)
        if self._links is not None:
            for links in columns.links:
                yield self._links.records(links)
        for arrows in columns.arrows:
            yield from self._arrows.records(arrows, stamps("stamp", arrows.stamp))
        for loads in columns.loads:
            yield from self._loads.records(loads, stamps("stamp", loads.stamp))
        for labels in columns.labels:
            yield from self._labels.records(labels, stamps("stamp", labels.stamp))
        yield from self._scene_parts(columns)

    def _scene_parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of what is drawn of the whole robot."""
        stamps = self._timed.stamps
        if self._support is not None:
            for scene in columns.support:
                yield from self._support.records(scene, stamps("stamp", scene.stamp))
        if self._legs is not None:
            for legs in columns.legs:
                yield from self._legs.records(legs, stamps("stamp", legs.stamp))


def _event_channels(encoding: Encoding, added: AddedChannels) -> EventChannels:
    events = added.declare(EVENTS_TOPIC, encoding.event_type)
    gait = added.declare(GAIT_TOPIC, encoding.gait_type)
    kind = encoding.span_type
    return EventChannels(events, gait, None if kind is None else added.declare(SPANS_TOPIC, kind))
