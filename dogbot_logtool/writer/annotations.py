"""The messages that we add: transforms, arrows, loads and support, made of columns."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import Final

import numpy as np
from mcap import records
from numpy.typing import NDArray

from dogbot_logtool.core.base.odometry import Transforms
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.geometry.arrays import Floats, Ints, rows_by_group
from dogbot_logtool.core.load.loads import Loads
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.provenance import ANNOTATION_MARK
from dogbot_logtool.writer.encodings.encoding import (
    LABEL_WIDTH,
    LOAD_STATES,
    SHAFT_SHARE,
    ArrowLook,
    Encoding,
    MessageType,
    SupportLook,
)
from dogbot_logtool.writer.legs import LegsWriter
from dogbot_logtool.writer.message_records import (
    MessageRecords,
    by_channel,
    record_template,
    recorded,
    write_log_time,
)
from dogbot_logtool.writer.robot_description import ROBOT_DESCRIPTION_TOPIC, description_message
from dogbot_logtool.writer.support import SupportWriter
from dogbot_logtool.writer.template import Stamps, Template

TF_TOPIC: Final = "/tf"
SUPPORT_TOPIC: Final = "/support"
LEGS_TOPIC: Final = "/legs"
EVENTS_TOPIC: Final = "/events"
SPANS_TOPIC: Final = "/events/spans"
GAIT_TOPIC: Final = "/gait"
FALLBACK_PREFIX: Final = "/dogbot_logtool"
_MAX_ID: Final = 0xFFFF
_LARGEST_LABEL_N: Final = 9999.0
_BEYOND: Final = ">10 kN"

ResolveTopic = Callable[[str, MessageType], str]
"""Returns the topic under which messages of a type are written."""


def arrow_topic(foot: str) -> str:
    """Return the topic of a foot's arrows."""
    return f"/marker_basic_{foot}_foot"


def load_topic(foot: str) -> str:
    """Return the topic of a foot's load."""
    return f"/load/{foot}"


def label_topic(foot: str) -> str:
    """Return the topic of the label beside a foot."""
    return f"/label/{foot}"


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
class EventChannels:
    """Ids of the channels of what is known when the whole log was measured."""

    events: int
    gait: int
    spans: int | None
    """None: the encoding has no message for spans of time."""


class IdSource:
    """Unused schema or channel ids: those above the input's highest first."""

    def __init__(self, used: AbstractSet[int]) -> None:
        highest = max(used, default=0)
        above = range(highest + 1, _MAX_ID + 1)
        self._free: Iterator[int] = iter([*above, *(n for n in range(1, highest) if n not in used)])

    def take(self) -> int:
        """Return a free id.

        Raises:
            LogtoolError: all are in use.
        """
        number = next(self._free, None)
        if number is None:
            raise LogtoolError("the log uses all 65535 ids that an MCAP file can have")
        return number


class Annotations:
    """The annotation channels of one output, and the templates of their messages."""

    def __init__(
        self,
        encoding: Encoding,
        feet: Sequence[str],
        style: ArrowLook,
        *,
        world_frame: str,
        base_frame: str,
        with_tf: bool,
        links: Sequence[tuple[str, str]] = (),
        support_look: SupportLook | None = None,
        with_labels: bool = False,
        legs_look: SupportLook | None = None,
        description: MessageType | None = None,
        with_events: bool = False,
        schema_ids: IdSource,
        channel_ids: IdSource,
        resolve_topic: ResolveTopic,
    ) -> None:
        self.schemas: list[records.Schema] = []
        self.channels: list[records.Channel] = []
        self._ids = channel_ids
        self._schema_ids = schema_ids
        self._resolve = resolve_topic
        self._tf: Template | None = None
        self._links: Template | None = None
        if with_tf or links:
            channel = self._declare(TF_TOPIC, encoding.transform_type)
            if with_tf:
                self._tf = record_template(encoding.transform(world_frame, base_frame), channel)
            if links:
                self._links = record_template(encoding.transforms(links), channel)
        self._arrows: list[tuple[Template, Template]] = []
        for foot in feet:
            channel = self._declare(arrow_topic(foot), encoding.arrow_type)
            arrow = record_template(encoding.arrow(foot, world_frame, style), channel)
            removal = record_template(encoding.removal(foot, world_frame), channel)
            self._arrows.append((arrow, removal))
        self._load = encoding.load(LOAD_STATES[0])
        self._loads = [
            [record_template(encoding.load(state), channel) for state in LOAD_STATES]
            for channel in (self._declare(load_topic(foot), encoding.load_type) for foot in feet)
        ]
        self._labels: list[tuple[Template, Template]] = []
        for foot, name in zip(feet, short_names(feet), strict=True) if with_labels else ():
            channel = self._declare(label_topic(foot), encoding.arrow_type)
            label = record_template(encoding.label(foot, world_frame, name, LIFETIME_S), channel)
            removal = record_template(encoding.removal(foot, world_frame), channel)
            self._labels.append((label, removal))
        self._support: SupportWriter | None = None
        if support_look is not None:
            channel = self._declare(SUPPORT_TOPIC, encoding.support_type)
            self._support = SupportWriter(channel, encoding, world_frame, support_look)
        self._legs: LegsWriter | None = None
        if legs_look is not None:
            channel = self._declare(LEGS_TOPIC, encoding.arrow_type)
            self._legs = LegsWriter(channel, encoding, world_frame, legs_look)
        self._description = description
        self._description_channel = 0
        if description is not None:
            self._description_channel = self._declare(ROBOT_DESCRIPTION_TOPIC, description)
        self.encoding = encoding
        self.event_channels: EventChannels | None = None
        if with_events:
            events = self._declare(EVENTS_TOPIC, encoding.event_type)
            gait = self._declare(GAIT_TOPIC, encoding.gait_type)
            kind = encoding.span_type
            spans = None if kind is None else self._declare(SPANS_TOPIC, kind)
            self.event_channels = EventChannels(events, gait, spans)

    def _declare(self, topic: str, kind: MessageType) -> int:
        schema = next((one for one in self.schemas if one.name == kind.name), None)
        if schema is None:
            schema = records.Schema(
                id=self._schema_ids.take(),
                name=kind.name,
                encoding=kind.schema_encoding,
                data=kind.schema,
            )
            self.schemas.append(schema)
        channel = records.Channel(
            id=self._ids.take(),
            topic=self._resolve(topic, kind),
            message_encoding=kind.message_encoding,
            metadata=dict(ANNOTATION_MARK),
            schema_id=schema.id,
        )
        self.channels.append(channel)
        return int(channel.id)

    def topics(self) -> Mapping[int, str]:
        """Return the topic of every annotation channel."""
        return {channel.id: channel.topic for channel in self.channels}

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
        if self._tf is not None:
            yield _transform_records(self._tf, columns.transforms)
        if self._links is not None:
            for links in columns.links:
                yield _link_records(self._links, links)
        # All messages of an encoding have times in the same form, so they are converted once.
        for arrows in columns.arrows:
            stamps = self._load.stamps("stamp", arrows.stamp)
            for group, rows in rows_by_group(2 * arrows.foot + ~arrows.shown):
                arrow, removal = self._arrows[group // 2]
                if group % 2:
                    yield _timed(removal, arrows, stamps, rows)
                else:
                    yield _arrow_records(arrow, arrows, stamps, rows)
        for loads in columns.loads:
            stamps = self._load.stamps("stamp", loads.stamp)
            states = len(LOAD_STATES)
            for group, rows in rows_by_group(states * loads.foot + loads.state):
                template = self._loads[group // states][group % states]
                yield _load_records(template, loads, stamps, rows)
        yield from self._scene_parts(columns)

    def _scene_parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of what is drawn besides arrows."""
        if self._labels:
            yield from self._label_parts(columns.labels)
        if self._support is not None:
            for scene in columns.support:
                yield from self._support.records(scene, self._load.stamps("stamp", scene.stamp))
        if self._legs is not None:
            for legs in columns.legs:
                yield from self._legs.records(legs, self._load.stamps("stamp", legs.stamp))

    def _label_parts(self, columns: Sequence[Labels]) -> Iterator[NDArray[np.void]]:
        for labels in columns:
            stamps = self._load.stamps("stamp", labels.stamp)
            for group, rows in rows_by_group(2 * labels.foot + ~labels.shown):
                label, removal = self._labels[group // 2]
                if group % 2:
                    yield _timed(removal, labels, stamps, rows)
                else:
                    yield _label_records(label, labels, stamps, rows)


def _transform_records(template: Template, transforms: Transforms) -> NDArray[np.void]:
    records = template.copies(len(transforms.log_time))
    write_log_time(records, transforms.log_time)
    template.write_time(records, "stamp", transforms.stamp)
    _write_pose(records, transforms.translation, transforms.rotation)
    return records


def _link_records(template: Template, links: LinkTransforms) -> NDArray[np.void]:
    records = template.copies(len(links.log_time))
    write_log_time(records, links.log_time)
    for index in range(links.poses.translation.shape[1]):
        template.write_time(records, f"{index}.stamp", links.stamp)
        position, turn = links.poses.translation[:, index], links.poses.rotation[:, index]
        _write_pose(records, position, turn, f"{index}.")
    return records


def _arrow_records(
    template: Template, arrows: Arrows, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    records = _timed(template, arrows, stamps, rows)
    _write_pose(records, arrows.position.take(rows, 0), arrows.orientation.take(rows, 0))
    length = arrows.length[rows]
    if "length" in template.kinds:
        records["length"] = length
    else:
        records["shaft"] = SHAFT_SHARE * length
        records["head"] = (1.0 - SHAFT_SHARE) * length
    for part, column in zip("rgba", arrows.colour.take(rows, 0).T, strict=True):
        records[part] = column
    return records


def _timed(
    template: Template, columns: Arrows | Labels | Loads, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    """Return records of some rows with their times: a removal has nothing else."""
    records = template.copies(len(rows))
    write_log_time(records, columns.log_time[rows])
    template.write_stamps(records, "stamp", stamps.pick(rows))
    return records


def _load_records(template: Template, loads: Loads, stamps: Stamps, rows: Ints) -> NDArray[np.void]:
    records = _timed(template, loads, stamps, rows)
    records["in_contact"] = loads.in_contact[rows]
    records["force"] = loads.force[rows]
    records["force_bw"] = loads.body_weights[rows]
    return records


def _label_records(
    template: Template, labels: Labels, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    records = _timed(template, labels, stamps, rows)
    for axis, column in zip("xyz", labels.position.take(rows, 0).T, strict=True):
        records[axis] = column
    records["text"] = [
        (_BEYOND if force > _LARGEST_LABEL_N else f"{force:.0f} N").center(LABEL_WIDTH).encode()
        for force in labels.force[rows].tolist()
    ]
    return records


def _write_pose(
    records: NDArray[np.void], position: Floats, orientation: Floats, prefix: str = ""
) -> None:
    for axis, column in zip("xyz", position.T, strict=True):
        records[prefix + axis] = column
    for axis, column in zip("xyzw", orientation.T, strict=True):
        records[f"{prefix}q{axis}"] = column
