"""The channels that `convert` adds to a log."""

from collections.abc import Mapping

from dogbot_logtool.pipeline.conversion.plan import ConversionPlan
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.writer.annotations import Annotations, WantedAnnotations
from dogbot_logtool.writer.channels import AddedChannels, IdSource
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.messages.robot_description import description_type
from dogbot_logtool.writer.topics import FALLBACK_PREFIX


def annotations_of(log: Log, plan: ConversionPlan) -> tuple[Annotations, Mapping[str, str]]:
    """Return the annotation channels of a log's output.

    Returns:
        the channels, and by topic the new names of those that the log uses for something else.
    """
    copied = log.channels.values() if plan.options.copy else ()
    recorded = {channel.topic: channel for channel in copied if channel.id not in plan.left_out}
    moved: dict[str, str] = {}

    def resolve_topic(topic: str, kind: MessageType) -> str:
        """Return a topic that carries no other type or encoding."""
        name = topic
        while (existing := recorded.get(name)) is not None:
            ours = short_type_name(kind.name), kind.message_encoding
            if (existing.type_name, existing.message_encoding) == ours:
                break
            name = FALLBACK_PREFIX + name
        if name != topic:
            moved[topic] = name
        return name

    profile = plan.encoding.profile or (log.profile if plan.options.copy else "")
    wanted = WantedAnnotations(
        [foot.name for foot in plan.selection.robot.feet],
        plan.world_frame,
        plan.base_frame,
        plan.arrow_look,
        base_transform=plan.write_tf,
        links=plan.motion.pairs if plan.motion else (),
        support=plan.support_look if plan.draws_support else None,
        legs=None if plan.hips is None else plan.support_look,
        labels=plan.draws_labels,
        description=description_type(profile) if plan.urdf is not None else None,
        events=plan.options.events,
    )
    # Chunks that are copied as they are may describe channels that are left out.
    schema_ids = IdSource({channel.schema.id for channel in copied if channel.schema})
    channel_ids = IdSource({channel.id for channel in copied})
    added = AddedChannels(schema_ids, channel_ids, resolve_topic)
    return Annotations(plan.encoding.load(), wanted, added), moved
