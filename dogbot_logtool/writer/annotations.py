"""The messages that we add: transforms, arrows, loads and support, stamped out of columns."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Final

import numpy as np
from mcap import records
from numpy.typing import NDArray

from dogbot_logtool.core.base.odometry import Transforms
from dogbot_logtool.core.geometry.arrays import Floats, Ints, rows_by_group
from dogbot_logtool.core.load.loads import Loads
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.provenance import ANNOTATION_MARK
from dogbot_logtool.writer.encodings.encoding import (
    SHAFT_SHARE,
    ArrowStyle,
    Encoding,
    MessageType,
    SupportStyle,
)
from dogbot_logtool.writer.outgoing import (
    Outgoing,
    by_channel,
    record_template,
    write_log_time,
)
from dogbot_logtool.writer.support import SupportStamper
from dogbot_logtool.writer.template import Stamps, Template

TF_TOPIC: Final = "/tf"
SUPPORT_TOPIC: Final = "/support"
FALLBACK_PREFIX: Final = "/dogbot_logtool"
_MAX_ID: Final = 0xFFFF

ResolveTopic = Callable[[str, MessageType], str]
"""Says under which topic messages of a type are written."""


def arrow_topic(foot: str) -> str:
    """Return the topic of a foot's arrows."""
    return f"/marker_basic_{foot}_foot"


def load_topic(foot: str) -> str:
    """Return the topic of a foot's load."""
    return f"/load/{foot}"


@dataclass(frozen=True, slots=True)
class AnnotationColumns:
    """What a batch is annotated with."""

    transforms: Transforms
    arrows: Sequence[Arrows]
    loads: Sequence[Loads]
    support: SupportScene | None = None
    """None: not to be written."""


class IdSource:
    """Gives out schema or channel ids that the input does not use, above its highest if it can."""

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
    """The annotation channels of one output, and what stamps out their messages."""

    def __init__(
        self,
        encoding: Encoding,
        feet: Sequence[str],
        style: ArrowStyle,
        *,
        world_frame: str,
        base_frame: str,
        with_tf: bool,
        support_style: SupportStyle | None = None,
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
        if with_tf:
            channel = self._declare(TF_TOPIC, encoding.transform_type)
            self._tf = record_template(encoding.transform(world_frame, base_frame), channel)
        self._arrows: list[tuple[Template, Template]] = []
        for foot in feet:
            channel = self._declare(arrow_topic(foot), encoding.arrow_type)
            arrow = record_template(encoding.arrow(foot, world_frame, style), channel)
            removal = record_template(encoding.removal(foot, world_frame), channel)
            self._arrows.append((arrow, removal))
        self._load = encoding.load()
        self._loads = [
            record_template(self._load, self._declare(load_topic(foot), encoding.load_type))
            for foot in feet
        ]
        self._support: SupportStamper | None = None
        if support_style is not None:
            channel = self._declare(SUPPORT_TOPIC, encoding.support_type)
            self._support = SupportStamper(channel, encoding, world_frame, support_style)

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

    def outgoing(self, columns: AnnotationColumns) -> Iterator[Outgoing]:
        """Stamp out the messages of a batch; see `by_channel`."""
        return by_channel(self._parts(columns))

    def _parts(self, columns: AnnotationColumns) -> Iterator[NDArray[np.void]]:
        """Yield the records of a batch, channel by channel."""
        if self._tf is not None:
            yield _transforms(self._tf, columns.transforms)
        # All messages of an encoding write times alike, so they are put in form only once.
        for arrows in columns.arrows:
            stamps = self._load.stamps("stamp", arrows.stamp)
            for group, rows in rows_by_group(2 * arrows.foot + ~arrows.shown):
                arrow, removal = self._arrows[group // 2]
                if group % 2:
                    yield _timed(removal, arrows, stamps, rows)
                else:
                    yield _shown(arrow, arrows, stamps, rows)
        for loads in columns.loads:
            stamps = self._load.stamps("stamp", loads.stamp)
            for foot, rows in rows_by_group(loads.foot):
                yield _loaded(self._loads[foot], loads, stamps, rows)
        if self._support is not None and columns.support is not None:
            stamps = self._load.stamps("stamp", columns.support.stamp)
            yield from self._support.outgoing(columns.support, stamps)


def _transforms(template: Template, transforms: Transforms) -> NDArray[np.void]:
    records = template.copies(len(transforms.log_time))
    write_log_time(records, transforms.log_time)
    template.write_time(records, "stamp", transforms.stamp)
    _write_pose(records, transforms.translation, transforms.rotation)
    return records


def _shown(template: Template, arrows: Arrows, stamps: Stamps, rows: Ints) -> NDArray[np.void]:
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
    template: Template, columns: Arrows | Loads, stamps: Stamps, rows: Ints
) -> NDArray[np.void]:
    """Return records of some rows with their times, which is all that a removal tells."""
    records = template.copies(len(rows))
    write_log_time(records, columns.log_time[rows])
    template.write_stamps(records, "stamp", stamps.pick(rows))
    return records


def _loaded(template: Template, loads: Loads, stamps: Stamps, rows: Ints) -> NDArray[np.void]:
    records = _timed(template, loads, stamps, rows)
    records["in_contact"] = loads.in_contact[rows]
    records["force"] = loads.force[rows]
    records["force_bw"] = loads.body_weights[rows]
    return records


def _write_pose(records: NDArray[np.void], position: Floats, orientation: Floats) -> None:
    for axis, column in zip("xyz", position.T, strict=True):
        records[axis] = column
    for axis, column in zip("xyzw", orientation.T, strict=True):
        records[f"q{axis}"] = column
