"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.core.frames.kinematics import LinkTransforms, TransformMessages
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.loads import Labels, Loads
from dogbot_logtool.core.scene.support_scene import LegLines, SupportScene
from dogbot_logtool.writer import described, markers
from dogbot_logtool.writer.channels import AddedChannels
from dogbot_logtool.writer.described import LOAD_STATES, Described
from dogbot_logtool.writer.encodings.encoding import Encoding
from dogbot_logtool.writer.encodings.registry import texts
from dogbot_logtool.writer.markers import Look
from dogbot_logtool.writer.message_records import MessageRecords, by_channel, of_payloads
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


Drawn = TransformMessages | Arrows | Loads | Labels | SupportScene | LegLines
"""Columns of one kind of annotation."""
DescribedBy = tuple[str, Callable[..., Described], tuple[Hashable, ...]]
"""A topic, the function that describes its message, and what that takes."""
Groups = tuple[Ints, Callable[[int], DescribedBy], Columns]
"""(n,) the group of each message; what describes a group's messages; and their columns."""


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
    description: str = ""
    """Profile of the robot's description, ``ros1`` or ``ros2``; empty: there is none."""


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
        names = {
            TF_TOPIC: described.TF if wanted.has_transforms else "",
            **{arrow_topic(foot): described.MARKER for foot in wanted.feet},
            **{load_topic(foot): described.LOAD for foot in wanted.feet},
            **{label_topic(foot): described.MARKER for foot in wanted.feet},
            SUPPORT_TOPIC: described.MARKERS if wanted.has_support else "",
            LEGS_TOPIC: described.MARKER if wanted.has_legs else "",
            ROBOT_DESCRIPTION_TOPIC: "",
            EVENTS_TOPIC: described.LOG,
            GAIT_TOPIC: described.GAIT,
            SPANS_TOPIC: described.SPAN,
        }
        types = {topic: encoding.types.get(name) for topic, name in names.items()}
        if wanted.description:
            describing = texts(wanted.description)
            types[ROBOT_DESCRIPTION_TOPIC] = describing.types[described.STRING]
        self.channels = {topic: added.declare(topic, kind) for topic, kind in types.items() if kind}
        """Ids by topic, whatever the log calls it."""

    def robot_description(self, urdf: str, log_time: int) -> MessageRecords:
        """Return the message that describes the robot."""
        describing = texts(self._wanted.description)
        made = describing.message(described.text(urdf))
        channel = self.channels[ROBOT_DESCRIPTION_TOPIC]
        return of_payloads(channel, [made], np.array([log_time]))

    def messages(self, drawn: Iterable[Drawn]) -> Iterator[MessageRecords]:
        """Yield the messages of a batch; see `by_channel`."""
        return by_channel(chain.from_iterable(map(self._records, drawn)))

    def _records(self, drawn: Drawn) -> Iterator[Records]:
        """Yield the messages of one kind of annotation, those of one topic and template at once."""
        group, described_by, columns = self._groups(drawn)
        columns = {**columns, **self.encoding.stamp_columns(drawn.stamp)}
        for number, rows in rows_by_group(group):
            topic, describe, of = described_by(number)
            template = _kept_template(self.encoding, describe, *of)
            yield template.records(self.channels[topic], drawn.log_time, columns, rows)

    def _groups(self, drawn: Drawn) -> Groups:
        """Return which messages share a topic and a template, what these are, and the columns."""
        frame, feet, look = self._wanted.world_frame, self._wanted.feet, self._wanted.look
        match drawn:
            case LinkTransforms():
                groups = _transforms(tuple(self._wanted.links), drawn)
            case TransformMessages():
                groups = _transforms(((frame, self._wanted.base_frame),), drawn)
            case Arrows():
                arrows = [(arrow_topic(foot), markers.arrow, (foot, frame, look)) for foot in feet]
                groups = _visible_or_not(drawn, arrows, markers.arrow_columns(drawn))
            case Labels():
                labels = [
                    (label_topic(foot), markers.label, (foot, frame, name))
                    for foot, name in zip(feet, short_names(feet), strict=True)
                ]
                groups = _visible_or_not(drawn, labels, markers.label_columns(drawn))
            case Loads():
                groups = _loads(drawn, feet)
            case SupportScene():
                groups = _supports(drawn, frame, look)
            case LegLines():
                groups = _leg_lines(drawn, frame, look)
        return groups


def _transforms(pairs: tuple[tuple[str, str], ...], drawn: TransformMessages) -> Groups:
    """Group the transforms of k parents and children."""
    columns = described.transform_columns(drawn.translation, drawn.rotation)
    group = np.zeros(len(drawn.stamp), np.int64)
    return group, lambda _: (TF_TOPIC, described.transforms, (pairs,)), columns


def _visible_or_not(
    drawn: Arrows | Labels, by_foot: Sequence[DescribedBy], columns: Columns
) -> Groups:
    """Group what is drawn at a foot, or removed from it."""

    def described_by(group: int) -> DescribedBy:
        foot, removed = divmod(group, 2)
        topic, describe, of = by_foot[foot]
        return topic, describe, (*of, not removed)

    return 2 * drawn.foot + ~drawn.visible, described_by, columns


def _loads(loads: Loads, feet: Sequence[str]) -> Groups:
    def described_by(group: int) -> DescribedBy:
        foot, rest = divmod(group, 2 * len(LOAD_STATES))
        state, touches = divmod(rest, 2)
        return load_topic(feet[foot]), described.load, (LOAD_STATES[state], bool(touches))

    group = 2 * (len(LOAD_STATES) * loads.foot + loads.state) + loads.in_contact
    return group, described_by, {"force": loads.force, "force_bw": loads.body_weights}


def _supports(scene: SupportScene, frame: str, look: Look) -> Groups:
    """Group messages of what the robot stands on by their numbers of points."""
    points = markers.support_points(scene).values()
    sizes = [each.shape[1] + 1 for each in points]
    counts = [np.isfinite(each[:, :, 0]).sum(axis=1) for each in points]

    def described_by(group: int) -> DescribedBy:
        shape = tuple(map(int, np.unravel_index(group, sizes)))
        return SUPPORT_TOPIC, markers.support, (shape, frame, look)

    return np.ravel_multi_index(counts, sizes), described_by, markers.support_columns(scene)


def _leg_lines(lines: LegLines, frame: str, look: Look) -> Groups:
    """Group messages of legs by their standing feet."""
    standing = np.isfinite(lines.ends[:, :, 0, 0])
    patterns, group = np.unique(standing, axis=0, return_inverse=True)

    def described_by(group: int) -> DescribedBy:
        feet = tuple(np.flatnonzero(patterns[group]).tolist())
        return LEGS_TOPIC, markers.legs, (feet, frame, look)

    return group.reshape(-1), described_by, markers.leg_columns(lines)


@lru_cache(_TEMPLATES_KEPT)
def _kept_template(
    encoding: Encoding, describe: Callable[..., Described], *of: Hashable
) -> Template:
    """Return the template of what a function describes, which outputs that are alike share."""
    return encoding.template(describe(*of))
