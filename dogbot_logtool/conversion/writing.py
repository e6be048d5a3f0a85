"""The annotated log: the recorded messages first, then what is drawn of the walk, span by span."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from dogbot_logtool.conversion.annotate import Scene, annotations_between
from dogbot_logtool.conversion.plan import ConversionPlan
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.scene.styles import LIFETIME_S
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.writer.annotations import Annotations, WantedAnnotations, description_type
from dogbot_logtool.writer.channels import AddedChannels, IdSource
from dogbot_logtool.writer.chunks import FinishedChunk, finish_chunks
from dogbot_logtool.writer.drawing import ArrowLook, SupportLook
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.message_records import MessageRecords, recorded
from dogbot_logtool.writer.topics import FALLBACK_PREFIX

SPAN_ROWS = 40_000
"""Samples of feet in a span: enough to make the cost of a numpy call small, and few enough to be
annotated in some 60 MB."""
ESTIMATED_WIDTH = 0.5
"""Width of arrows whose forces are estimated, over that of measured ones."""
_TIMES = np.iinfo(np.int64)
TimeSpan = tuple[int, int]
"""ns, log times from which on and before which is annotated."""


@dataclass(frozen=True, slots=True)
class WrittenSpan:
    """The annotations of a span of log time as chunks of the output."""

    chunks: tuple[FinishedChunk, ...]
    counts: Counter[str]


def time_spans(scene: Scene) -> list[TimeSpan]:
    """Cut log time into spans with about as many rows of what is drawn."""
    columns = [scene.poses.log_time, *(foot.samples.log_time for foot in scene.feet)]
    times = max(columns, key=len)
    spans = sum(map(len, columns)) // SPAN_ROWS + 1
    cuts = sorted({*times[np.arange(1, spans) * len(times) // spans].tolist()})
    return list(zip([_TIMES.min, *cuts], [*cuts, _TIMES.max], strict=True))


@dataclass(frozen=True, slots=True)
class SpanWriter:
    """Annotates spans of log time, in any process and in any order."""

    scene: Scene
    annotations: Annotations

    def __call__(self, _log: Log, span: TimeSpan) -> WrittenSpan:
        """Return the chunks of a span."""
        columns, counts = annotations_between(self.scene, *span)
        compression = self.scene.plan.options.compression or "zstd"
        chunks: list[FinishedChunk] = []
        for messages in self.annotations.messages(columns):
            chunks += finish_chunks(messages, compression)
        for messages in event_records(self.annotations, self.scene, *span):
            chunks += finish_chunks(messages, compression)
        return WrittenSpan(tuple(chunks), counts)


def event_records(
    annotations: Annotations, scene: Scene, start: int, end: int
) -> list[MessageRecords]:
    """Return the messages of `/gait` and `/events` of a span of log time, ns, a group each."""
    encoding, channels = annotations.encoding, annotations.event_channels
    gait, event = (
        slice(*np.searchsorted(each, [start, end]).tolist())
        for each in (scene.gait_log_time, scene.event_log_time)
    )
    gaits, events = scene.gaits[gait], scene.events[event]
    log_time = scene.event_log_time[event]
    # A viewer's timeline shows what calls for a look; steps are in the log panel.
    odd = [row for row, each in enumerate(events) if not each.is_step]
    parts: list[tuple[int, list[bytes], Ints]] = [
        (channels.gait, [encoding.gait(each) for each in gaits], scene.gait_log_time[gait]),
        (channels.events, [encoding.event(each) for each in events], log_time),
    ]
    if channels.spans is not None:
        spans = [encoding.span(events[row]) for row in odd]
        parts.append((channels.spans, spans, log_time[odd]))
    return [_records(*part) for part in parts if part[1]]


def _records(channel: int, payloads: Sequence[bytes], log_time: Ints) -> MessageRecords:
    size = np.array([len(each) for each in payloads], np.int64)
    end = np.cumsum(size)
    count = len(payloads)
    return recorded(
        np.full(count, channel, np.int64),
        np.zeros(count, np.int64),
        log_time,
        log_time,
        np.frombuffer(b"".join(payloads), np.uint8),
        end - size,
        end,
    )


@dataclass(frozen=True, slots=True)
class _FreeTopics:
    """Finds topics that carry no other type or encoding."""

    taken: Mapping[str, tuple[str, str]]
    """Type and encoding of the recorded topics that are copied."""
    moved: dict[str, str] = field(default_factory=dict)
    """New names of topics of ours, by their own."""

    def __call__(self, topic: str, kind: MessageType) -> str:
        """Return a topic for messages of a type."""
        name, ours = topic, (short_type_name(kind.name), kind.message_encoding)
        while self.taken.get(name, ours) != ours:
            name = FALLBACK_PREFIX + name
        if name != topic:
            self.moved[topic] = name
        return name


def annotations_of(log: Log, plan: ConversionPlan) -> tuple[Annotations, Mapping[str, str]]:
    """Return the annotation channels of a log's output.

    Returns:
        the channels, and by topic the new names of those that the log uses for something else.
    """
    options, robot = plan.options, plan.selection.robot
    copied = log.channels.values() if options.copy else ()
    free = _FreeTopics(
        {
            channel.topic: (channel.type_name, channel.message_encoding)
            for channel in copied
            if channel.id not in plan.left_out
        }
    )
    profile = plan.encoding.profile or (log.profile if options.copy else "")
    description, fixed = plan.description, plan.style.shaft_diameter_m
    # At a low rate, support lasts until the next message.
    lifetime_s = max(LIFETIME_S, 2.0 / options.tf_rate if options.tf_rate else 0.0)
    look = SupportLook(robot.shaft_diameter_m / 2.0, robot.shaft_diameter_m, lifetime_s)
    shaft_m = robot.shaft_diameter_m if fixed is None else fixed
    estimated = plan.selection.contact_from
    if estimated and fixed is None:
        shaft_m *= ESTIMATED_WIDTH
    wanted = WantedAnnotations(
        [foot.name for foot in robot.feet],
        plan.world_frame,
        plan.base_frame,
        ArrowLook(shaft_m, plan.style.lifetime_s),
        base_transform=plan.write_tf,
        links=description.motion.pairs if description.motion else (),
        support=look if plan.draws_support else None,
        legs=None if description.hips is None else look,
        description=description_type(profile) if description.urdf is not None else None,
    )
    # Chunks that are copied as they are may describe channels that are left out.
    schema_ids = IdSource({channel.schema.id for channel in copied if channel.schema})
    channel_ids = IdSource({channel.id for channel in copied})
    notes = {"contact_from": estimated} if estimated else {}
    added = AddedChannels(schema_ids, channel_ids, free, notes)
    return Annotations(plan.encoding.load(), wanted, added), free.moved
