"""The messages that we add: transforms, arrows, loads, support and the robot, made of columns."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import lru_cache
from itertools import chain
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints, rows_by_group
from dogbot_logtool.core.frames.kinematics import LinkTransforms, TransformMessages
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.feet import Labels, Loads, short_names
from dogbot_logtool.core.scene.support_scene import LegLines, SupportScene
from dogbot_logtool.writer import described, markers, topics
from dogbot_logtool.writer.chunks import MessageRecords, by_channel, of_payloads
from dogbot_logtool.writer.described import LOAD_STATES, Described
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType
from dogbot_logtool.writer.encodings.registry import texts
from dogbot_logtool.writer.markers import Look
from dogbot_logtool.writer.template import Records, Template

_TEMPLATES_KEPT: Final = 1024
"""Templates that are kept for later messages and for other logs of a run."""


Drawn = TransformMessages | Arrows | Loads | Labels | SupportScene | LegLines
"""Columns of one kind of annotation."""
DescribedBy = tuple[str, Callable[..., Described], tuple[Hashable, ...]]
"""A topic, the function that describes its message, and what that takes."""


class WantedAnnotations(NamedTuple):
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


def types_by_topic(encoding: Encoding, wanted: WantedAnnotations) -> dict[str, MessageType]:
    """Return the topics of an output's annotations, and the types of their messages."""
    names = {
        topics.TF: described.TF if wanted.has_transforms else "",
        **{topics.arrow(foot): described.MARKER for foot in wanted.feet},
        **{topics.load(foot): described.LOAD for foot in wanted.feet},
        **{topics.label(foot): described.MARKER for foot in wanted.feet},
        topics.SUPPORT: described.MARKERS if wanted.has_support else "",
        topics.LEGS: described.MARKER if wanted.has_legs else "",
        topics.EVENTS: described.LOG,
        topics.GAIT: described.GAIT,
        topics.SPANS: described.SPAN,
    }
    types = {topic: encoding.types.get(name) for topic, name in names.items()}
    if wanted.description:
        types[topics.ROBOT_DESCRIPTION] = texts(wanted.description).types[described.STRING]
    return {topic: kind for topic, kind in types.items() if kind}


class Annotations:
    """The annotations of one output; called in several threads or processes at once."""

    def __init__(
        self, encoding: Encoding, wanted: WantedAnnotations, channels: Mapping[str, int]
    ) -> None:
        """Set up.

        Args:
            encoding: of the messages.
            wanted: which there are.
            channels: ids by topic, whatever the log calls it.
        """
        self.encoding, self._wanted, self.channels = encoding, wanted, channels

    def robot_description(self, urdf: str, log_time: int) -> MessageRecords:
        """Return the message that describes the robot."""
        describing = texts(self._wanted.description)
        made = describing.message(described.text(urdf))
        channel = self.channels[topics.ROBOT_DESCRIPTION]
        return of_payloads(channel, [made], np.array([log_time]))

    def messages(self, drawn: Iterable[Drawn]) -> Iterator[MessageRecords]:
        """Yield the messages of a batch; see `by_channel`."""
        return by_channel(chain.from_iterable(map(self._records, drawn)))

    def _records(self, drawn: Drawn) -> Iterator[Records]:
        """Yield the messages of one kind of annotation, those of one topic and template at once."""
        columns = {field.name: getattr(drawn, field.name) for field in fields(drawn)}
        columns |= self.encoding.stamp_columns(drawn.stamp)
        for layout, rows in _alike(_layouts(drawn), len(drawn.stamp)):
            topic, describe, of = self._described_by(drawn, layout)
            template = _kept_template(self.encoding, describe, *of)
            yield template.records(self.channels[topic], drawn.log_time, columns, rows)

    def _described_by(self, drawn: Drawn, layout: Sequence[int]) -> DescribedBy:
        """Return the topic of messages of one layout, and what describes them."""
        frame, look = self._wanted.world_frame, self._wanted.look
        foot = self._wanted.feet[layout[0]] if hasattr(drawn, "foot") else ""
        match drawn:
            case TransformMessages():
                base = ((frame, self._wanted.base_frame),)
                pairs = self._wanted.links if isinstance(drawn, LinkTransforms) else base
                return topics.TF, described.transforms, (tuple(pairs),)
            case Arrows():
                return topics.arrow(foot), markers.arrow, (foot, frame, look, not layout[1])
            case Labels():
                short = short_names(self._wanted.feet)[layout[0]]
                return topics.label(foot), markers.label, (foot, frame, short, not layout[1])
            case Loads():
                return topics.load(foot), described.load, (LOAD_STATES[layout[1]], bool(layout[2]))
            case SupportScene():
                return topics.SUPPORT, markers.support, (layout, frame, look)
            case LegLines():
                return topics.LEGS, markers.legs, (layout, frame, look)


def _layouts(drawn: Drawn) -> Sequence[Ints | Flags]:
    """Return numbers, each (n,); messages that share them differ in the values of slots alone."""
    match drawn:
        case Arrows() | Labels():
            return drawn.foot, ~drawn.visible
        case Loads():
            return drawn.foot, drawn.state, drawn.in_contact
        case SupportScene():
            points = (getattr(drawn, name) for name in markers.SUPPORT_POINTS)
            return [np.isfinite(each[:, :, 0]).sum(axis=1) for each in points]
        case LegLines():
            return tuple(np.isfinite(drawn.ends[:, :, 0, 0]).T)
    return ()


def _alike(layouts: Sequence[Ints | Flags], count: int) -> Iterator[tuple[tuple[int, ...], Ints]]:
    """Yield each layout of some messages, with the rows that have it."""
    group, sizes = np.zeros(count, np.int64), []
    for numbers in layouts:
        sizes.append(int(numbers.max(initial=0)) + 1)
        group = group * sizes[-1] + numbers
    for number, rows in rows_by_group(group):
        yield tuple(map(int, np.unravel_index(number, sizes))), rows


@lru_cache(_TEMPLATES_KEPT)
def _kept_template(
    encoding: Encoding, describe: Callable[..., Described], *of: Hashable
) -> Template:
    """Return the template of what a function describes, which outputs that are alike share."""
    return encoding.template(describe(*of))
