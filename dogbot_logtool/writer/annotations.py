"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

import struct
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Protocol

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, rows_by_group
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
from dogbot_logtool.writer.drawing import ArrowLook, Drawing, SupportLook, SupportShape
from dogbot_logtool.writer.encodings.encoding import LOAD_STATES, Encoding, MessageType
from dogbot_logtool.writer.message_records import MessageRecords, by_channel, recorded
from dogbot_logtool.writer.messages import (
    arrow_columns,
    label_columns,
    leg_columns,
    load_columns,
    support_columns,
    support_points,
    transform_columns,
)
from dogbot_logtool.writer.template import Columns, Records, Template
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

_TEMPLATES_KEPT: Final = 1024
"""Templates that are kept for later messages and for other logs of a run."""
_CDR_HEAD: Final = b"\x00\x01\x00\x00"
"""Little-endian CDR."""


class Timed(Protocol):
    """Columns with times."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""

    @property
    def stamp(self) -> Ints:
        """(n,) ns."""


class Shown(Timed, Protocol):
    """Columns of what is shown at feet, or removed."""

    @property
    def foot(self) -> Ints:
        """(n,) index of the foot."""

    @property
    def shown(self) -> Flags:
        """(n,) False: it is removed."""


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
        """Declare their channels.

        Args:
            encoding: of the messages.
            wanted: which there are.
            added: takes the channels.

        Raises:
            LogtoolError: the log uses all ids that there are.
        """
        self.encoding, self.added, self._wanted = encoding, added, wanted

        def of_feet(topic_of: Callable[[str], str], kind: MessageType) -> list[int]:
            return [added.declare(topic_of(foot), kind) for foot in wanted.feet]

        self._tf = self._support = self._legs = self._description = 0
        if wanted.base_transform or wanted.links:
            self._tf = added.declare(TF_TOPIC, encoding.transform_type)
        self._arrows = of_feet(arrow_topic, encoding.arrow_type)
        self._loads = of_feet(load_topic, encoding.load_type)
        self._labels = of_feet(label_topic, encoding.arrow_type)
        if wanted.support is not None:
            self._support = added.declare(SUPPORT_TOPIC, encoding.support_type)
        if wanted.legs is not None:
            self._legs = added.declare(LEGS_TOPIC, encoding.arrow_type)
        if wanted.description is not None:
            self._description = added.declare(ROBOT_DESCRIPTION_TOPIC, wanted.description)
        self.event_channels = _event_channels(encoding, added)

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

    def _parts(self, columns: AnnotationColumns) -> Iterator[Records]:
        """Yield the records of a batch, channel by channel."""
        wanted = self._wanted
        if wanted.base_transform:
            base = columns.transforms
            pair = (wanted.world_frame, wanted.base_frame)
            yield from self._transforms(
                (pair,), base, base.translation[:, None], base.rotation[:, None]
            )
        for links in columns.links if wanted.links else ():
            poses = links.poses
            yield from self._transforms(
                tuple(wanted.links), links, poses.translation, poses.rotation
            )
        draw_arrow = [
            drawing.arrow(foot, wanted.world_frame, wanted.arrows) for foot in wanted.feet
        ]
        for arrows in columns.arrows:
            yield from self._shown(self._arrows, draw_arrow, arrows, arrow_columns(arrows))
        for loads in columns.loads:
            group = len(LOAD_STATES) * loads.foot + loads.state
            yield from self._grouped(group, self._load, loads, load_columns(loads))
        names = zip(wanted.feet, short_names(wanted.feet), strict=True)
        draw_label = [drawing.label(foot, wanted.world_frame, name) for foot, name in names]
        for labels in columns.labels:
            yield from self._shown(self._labels, draw_label, labels, label_columns(labels))
        if wanted.support is not None:
            for scene in columns.support:
                yield from self._supports(scene, wanted.support)
        if wanted.legs is not None:
            for lines in columns.legs:
                yield from self._leg_lines(lines, wanted.legs)

    def _transforms(
        self,
        pairs: tuple[tuple[str, str], ...],
        timed: Timed,
        translation: Floats,
        rotation: Floats,
    ) -> Iterator[Records]:
        """Yield messages of the transforms of some parents and children."""
        template = kept_template(self.encoding.transforms, pairs)
        columns = transform_columns(translation, rotation)
        same = np.zeros(len(timed.stamp), np.int64)
        return self._grouped(same, lambda _: (self._tf, template), timed, columns)

    def _shown(
        self,
        channels: Sequence[int],
        drawings: Sequence[Drawing],
        shown: Shown,
        columns: Columns,
    ) -> Iterator[Records]:
        """Yield messages that draw something at a foot, or remove it."""

        def template_of(group: int) -> tuple[int, Template]:
            foot, removed = divmod(group, 2)
            make = self.encoding.removal if removed else self.encoding.drawing
            return channels[foot], kept_template(make, drawings[foot])

        return self._grouped(2 * shown.foot + ~shown.shown, template_of, shown, columns)

    def _load(self, group: int) -> tuple[int, Template]:
        foot, state = divmod(group, len(LOAD_STATES))
        return self._loads[foot], kept_template(self.encoding.load, LOAD_STATES[state])

    def _supports(self, scene: SupportScene, look: SupportLook) -> Iterator[Records]:
        """Yield messages of what the robot stands on, those of one shape at a time."""
        points = [each for _, each in support_points(scene)]
        sizes = [each.shape[1] + 1 for each in points]
        counts = [np.isfinite(each[:, :, 0]).sum(axis=1) for each in points]

        def template_of(group: int) -> tuple[int, Template]:
            shape = SupportShape(*map(int, np.unravel_index(group, sizes)))
            drawn = drawing.support(shape, self._wanted.world_frame, look)
            return self._support, kept_template(self.encoding.drawing, drawn)

        group = np.ravel_multi_index(counts, sizes)
        return self._grouped(group, template_of, scene, support_columns(scene))

    def _leg_lines(self, lines: LegLines, look: SupportLook) -> Iterator[Records]:
        """Yield messages of legs, those of the same standing feet at a time."""
        standing = np.isfinite(lines.ends[:, :, 0, 0])
        patterns, group = np.unique(standing, axis=0, return_inverse=True)

        def template_of(group: int) -> tuple[int, Template]:
            feet = tuple(np.flatnonzero(patterns[group]).tolist())
            make = self.encoding.drawing if feet else self.encoding.removal
            drawn = drawing.legs(feet, self._wanted.world_frame, look)
            return self._legs, kept_template(make, drawn)

        return self._grouped(group.reshape(-1), template_of, lines, leg_columns(lines))

    def _grouped(
        self,
        group: Ints,
        template_of: Callable[[int], tuple[int, Template]],
        timed: Timed,
        columns: Columns,
    ) -> Iterator[Records]:
        """Yield the messages of rows that share a channel and a template.

        Args:
            group: (n,) number of each row's channel and template.
            template_of: returns these.
            timed: (n,) times.
            columns: (n,) of all slots but the stamps.
        """
        stamped = {**columns, **self.encoding.stamp_columns(timed.stamp)}
        for number, rows in rows_by_group(group):
            channel, template = template_of(number)
            yield template.records(channel, timed.log_time, stamped, rows)


@lru_cache(_TEMPLATES_KEPT)
def kept_template(make: Callable[..., Template], *of: Hashable) -> Template:
    """Return a template, which outputs that are alike share.

    Args:
        make: method of an encoding that makes it.
        of: what the method takes.
    """
    return make(*of)


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
