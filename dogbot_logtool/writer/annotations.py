"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

import struct
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, repeat
from typing import Any, Final, Protocol

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.core.frames.kinematics import LinkTransforms, Transforms
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.loads import Labels, Loads
from dogbot_logtool.core.scene.support_scene import LegLines, SupportScene
from dogbot_logtool.writer import drawing
from dogbot_logtool.writer.channels import AddedChannels
from dogbot_logtool.writer.drawing import Drawing, Look, parts
from dogbot_logtool.writer.encodings.encoding import LOAD_STATES, Encoding, MessageType
from dogbot_logtool.writer.message_records import MessageRecords, by_channel, recorded
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


Drawn = Transforms | Arrows | Loads | Labels | SupportScene | LegLines
"""Columns of one kind of annotation."""


@dataclass(frozen=True, slots=True)
class WantedAnnotations:
    """Which annotations an output has, and how they look."""

    feet: Sequence[str]
    world_frame: str
    base_frame: str
    look: Look
    links: Sequence[tuple[str, str]] = ()
    """Frames of links, parent and child, whose transforms are written."""
    has_transforms: bool = True
    has_support: bool = False
    has_legs: bool = False
    description: MessageType | None = None
    """Type of the robot's description; None: there is none."""


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
        self.encoding, self._wanted = encoding, wanted
        types = {
            TF_TOPIC: encoding.transform_type if wanted.has_transforms else None,
            **{arrow_topic(foot): encoding.arrow_type for foot in wanted.feet},
            **{load_topic(foot): encoding.load_type for foot in wanted.feet},
            **{label_topic(foot): encoding.arrow_type for foot in wanted.feet},
            SUPPORT_TOPIC: encoding.support_type if wanted.has_support else None,
            LEGS_TOPIC: encoding.arrow_type if wanted.has_legs else None,
            ROBOT_DESCRIPTION_TOPIC: wanted.description,
            EVENTS_TOPIC: encoding.event_type,
            GAIT_TOPIC: encoding.gait_type,
            SPANS_TOPIC: encoding.span_type,
        }
        self.channels = {topic: added.declare(topic, kind) for topic, kind in types.items() if kind}
        """Ids by topic, whatever the log calls it."""

    def robot_description(self, urdf: str, log_time: int) -> MessageRecords:
        """Return the message that describes the robot."""
        if self._wanted.description is None:
            raise AssertionError("the output has no channel for a robot description")
        payload = np.frombuffer(_description_message(urdf, self._wanted.description), np.uint8)
        channel = self.channels[ROBOT_DESCRIPTION_TOPIC]
        time, start, end = np.array([[log_time], [0], [len(payload)]])
        return recorded(np.array([channel]), start, time, time, payload, start, end)

    def messages(self, drawn: Iterable[Drawn]) -> Iterator[MessageRecords]:
        """Yield the messages of a batch; see `by_channel`."""
        return by_channel(chain.from_iterable(map(self._records, drawn)))

    def _records(self, drawn: Drawn) -> Iterator[Records]:
        """Yield the records of one kind of annotation, channel by channel."""
        wanted = self._wanted
        frame, feet, look = wanted.world_frame, wanted.feet, wanted.look
        match drawn:
            case LinkTransforms():
                records = self._transforms(tuple(wanted.links), drawn)
            case Transforms():
                records = self._transforms(((frame, wanted.base_frame),), drawn)
            case Arrows():
                shapes = [drawing.arrow(foot, frame, look) for foot in feet]
                records = self._at_feet(arrow_topic, shapes, drawn, drawing.arrow_columns(drawn))
            case Labels():
                shapes = list(map(drawing.label, feet, repeat(frame), short_names(feet)))
                records = self._at_feet(label_topic, shapes, drawn, drawing.label_columns(drawn))
            case Loads():
                records = self._loads(drawn)
            case SupportScene():
                records = self._supports(drawn)
            case LegLines():
                records = self._leg_lines(drawn)
        return records

    def _transforms(
        self, pairs: tuple[tuple[str, str], ...], drawn: Transforms
    ) -> Iterator[Records]:
        """Yield messages of the transforms of k parents and children."""
        columns: dict[str, Any] = {}
        for index in range(len(pairs)):
            columns |= parts("xyz", drawn.translation[:, index], f"{index}.")
            columns |= parts("xyzw", drawn.rotation[:, index], f"{index}.q")
        template = kept_template(self.encoding.transforms, pairs)
        same = np.zeros(len(drawn.stamp), np.int64)
        return self._grouped(same, lambda _: (TF_TOPIC, template), drawn, columns)

    def _at_feet(
        self,
        topic_of: Callable[[str], str],
        drawings: Sequence[Drawing],
        shown: Arrows | Labels,
        columns: Columns,
    ) -> Iterator[Records]:
        """Yield messages that draw something at a foot, or remove it."""

        def template_of(group: int) -> tuple[str, Template]:
            foot, removed = divmod(group, 2)
            make = self.encoding.removal if removed else self.encoding.drawing
            return topic_of(self._wanted.feet[foot]), kept_template(make, drawings[foot])

        return self._grouped(2 * shown.foot + ~shown.shown, template_of, shown, columns)

    def _loads(self, loads: Loads) -> Iterator[Records]:
        def template_of(group: int) -> tuple[str, Template]:
            foot, state = divmod(group, len(LOAD_STATES))
            template = kept_template(self.encoding.load, LOAD_STATES[state])
            return load_topic(self._wanted.feet[foot]), template

        force, weights = loads.force, loads.body_weights
        columns = {"in_contact": loads.in_contact, "force": force, "force_bw": weights}
        group = len(LOAD_STATES) * loads.foot + loads.state
        return self._grouped(group, template_of, loads, columns)

    def _supports(self, scene: SupportScene) -> Iterator[Records]:
        """Yield messages of what the robot stands on, those of one size at a time."""
        points = drawing.support_points(scene).values()
        sizes = [each.shape[1] + 1 for each in points]
        counts = [np.isfinite(each[:, :, 0]).sum(axis=1) for each in points]

        def template_of(group: int) -> tuple[str, Template]:
            shape = list(map(int, np.unravel_index(group, sizes)))
            drawn = drawing.support(shape, self._wanted.world_frame, self._wanted.look)
            return SUPPORT_TOPIC, kept_template(self.encoding.drawing, drawn)

        group = np.ravel_multi_index(counts, sizes)
        return self._grouped(group, template_of, scene, drawing.support_columns(scene))

    def _leg_lines(self, lines: LegLines) -> Iterator[Records]:
        """Yield messages of legs, those of the same standing feet at a time."""
        standing = np.isfinite(lines.ends[:, :, 0, 0])
        patterns, group = np.unique(standing, axis=0, return_inverse=True)

        def template_of(group: int) -> tuple[str, Template]:
            feet = tuple(np.flatnonzero(patterns[group]).tolist())
            make = self.encoding.drawing if feet else self.encoding.removal
            drawn = drawing.legs(feet, self._wanted.world_frame, self._wanted.look)
            return LEGS_TOPIC, kept_template(make, drawn)

        columns = drawing.leg_columns(lines)
        return self._grouped(group.reshape(-1), template_of, lines, columns)

    def _grouped(
        self,
        group: Ints,
        template_of: Callable[[int], tuple[str, Template]],
        timed: Timed,
        columns: Columns,
    ) -> Iterator[Records]:
        """Yield the messages of rows that share a topic and a template.

        Args:
            group: (n,) number of each row's topic and template.
            template_of: returns these.
            timed: (n,) times.
            columns: (n,) of all slots but the stamps.
        """
        stamped = {**columns, **self.encoding.stamp_columns(timed.stamp)}
        for number, rows in rows_by_group(group):
            topic, template = template_of(number)
            yield template.records(self.channels[topic], timed.log_time, stamped, rows)


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
