"""The channels that `convert` adds to a log, and what writes their messages."""

from collections.abc import Mapping

from dogbot_logtool.pipeline.options import EncodingName
from dogbot_logtool.pipeline.plan import Plan
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.writer.annotations import FALLBACK_PREFIX, Annotations, IdSource
from dogbot_logtool.writer.encodings.encoding import Encoding, MessageType


def annotations_of(log: Log, plan: Plan) -> tuple[Annotations, Mapping[str, str]]:
    """Choose the channels of the annotations: the same ones whoever asks.

    Returns:
        The channels, and new names of the topics that the log uses for something else.
    """
    copied = log.channels.values() if plan.options.copy else ()
    recorded = {channel.topic: channel for channel in copied}
    moved: dict[str, str] = {}

    def resolve_topic(topic: str, kind: MessageType) -> str:
        """One topic must never carry two types or encodings."""
        name = topic
        while (there := recorded.get(name)) is not None:
            ours = short_type_name(kind.name), kind.message_encoding
            if (there.type_name, there.message_encoding) == ours:
                break
            name = FALLBACK_PREFIX + name
        if name != topic:
            moved[topic] = name
        return name

    annotations = Annotations(
        encoding_named(plan.options.encoding),
        [foot.name for foot in plan.selection.robot.feet],
        plan.arrow_style,
        world_frame=plan.world_frame,
        base_frame=plan.base_frame,
        with_tf=plan.write_tf,
        support_style=plan.support_style if plan.hearings else None,
        schema_ids=IdSource({channel.schema.id for channel in copied if channel.schema}),
        channel_ids=IdSource({channel.id for channel in copied}),
        resolve_topic=resolve_topic,
    )
    return annotations, moved


def encoding_named(name: EncodingName) -> Encoding:
    """Return an encoding of the annotations."""
    # Imported late: each brings the libraries of its message format.
    match name:
        case "ros1":
            from dogbot_logtool.writer.encodings.ros1 import Ros1Encoding  # noqa: PLC0415

            return Ros1Encoding()
        case "ros2":
            from dogbot_logtool.writer.encodings.ros2 import Ros2Encoding  # noqa: PLC0415

            return Ros2Encoding()
        case "foxglove":
            from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding  # noqa: PLC0415

            return FoxgloveEncoding()
