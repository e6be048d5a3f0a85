"""Declare the annotations of a log, and compute those of a batch: arrows, loads, support ..."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry, base_transforms, from_opening
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import FootTracker
from dogbot_logtool.core.contact.silent_swing import swings_in_batch
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.clock import first_at_each_tick
from dogbot_logtool.core.geometry.support_polygon import NEAR_NS
from dogbot_logtool.core.load.loads import Loads, all_known_from, foot_loads, opening_loads
from dogbot_logtool.core.scene.arrows import ArrowCounts, ArrowInput, Arrows, no_arrows
from dogbot_logtool.core.scene.labels import Labels, foot_labels
from dogbot_logtool.core.scene.legs import LegLines, leg_lines
from dogbot_logtool.core.scene.support_scene import SupportScene, opening_support, support_scene
from dogbot_logtool.pipeline.conversion.batch_state import BatchState
from dogbot_logtool.pipeline.conversion.plan import ConversionPlan
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import short_type_name
from dogbot_logtool.reader.messages.contact_messages import DecodedContacts
from dogbot_logtool.writer.annotations import AnnotationColumns, Annotations, WantedAnnotations
from dogbot_logtool.writer.channels import AddedChannels, IdSource
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.messages.robot_description import description_type
from dogbot_logtool.writer.topics import FALLBACK_PREFIX


def compute_annotations(
    contacts: Sequence[DecodedContacts],
    in_world: Sequence[Samples],
    poses: Odometry,
    trackers: Sequence[FootTracker],
    silences: Loads,
    state: BatchState,
    plan: ConversionPlan,
) -> tuple[AnnotationColumns, ArrowCounts]:
    """Compute what is written about a batch.

    Args:
        contacts: of the batch.
        in_world: the samples of each of `contacts`, in the world as far as frames are known.
        poses: usable odometry of the batch.
        trackers: of each foot in the batch.
        silences: where feet fall silent.
        state: what all earlier batches pass on.
        plan: what to write.

    Returns:
        the columns, and the samples that could not become an arrow.
    """
    arrows: list[Arrows] = []
    labels: list[Labels] = []
    loads: list[Loads] = []
    skipped = ArrowCounts()
    for decoded, turned in zip(contacts, in_world, strict=True):
        recorded = decoded.reduced.samples
        samples = _with_swings(decoded, recorded, state, plan)
        loads.append(foot_loads(samples, trackers, plan.body_weight_n))
        if turned is not recorded:
            # Turning a force changes the last digit of its magnitude: styles that do not show its
            # direction use the recorded one, as loads do.
            drawn = turned if plan.style.needs_directions else replace(turned, force=recorded.force)
            samples = _with_swings(decoded, drawn, state, plan)
        samples = _of_known_force(samples, plan)
        of_type, left_out = _arrows(decoded, samples, plan)
        arrows.append(of_type)
        skipped += left_out
        if plan.draws_labels:
            last = state.last_contact_times
            labels.append(foot_labels(samples, of_type, last, state.feet_down))
    at_ticks = poses.pick(
        first_at_each_tick(poses.time, plan.options.tf_rate_hz, state.last_pose_time)
    )
    support = _support(at_ticks, loads, trackers, state, plan)
    if plan.opening_time is not None:
        new = state.feet_without_messages(len(plan.sensors))
        if new:
            loads = [*(opening_loads(each, plan.opening_time, new) for each in loads), *loads]
    transforms = base_transforms(at_ticks)
    if state.last_pose_time is None and plan.opening_time is not None:
        transforms = from_opening(transforms, plan.opening_time)
    legs = [] if plan.hips is None else [_legs(at_ticks, trackers, plan.hips, state, plan)]
    columns = AnnotationColumns(transforms, arrows, [*loads, silences], support, labels, legs)
    return columns, skipped


def links_at_ticks(
    links: Sequence[LinkTransforms], state: BatchState, plan: ConversionPlan
) -> Sequence[LinkTransforms]:
    """Return the links that are written: as often as the base, and at the log's first time."""
    previous, chosen = state.last_link_time, []
    for each in links:
        rows = first_at_each_tick(each.stamp, plan.options.tf_rate_hz, previous)
        chosen.append(each.pick(rows))
        previous = int(each.stamp[-1]) if len(each.stamp) else previous
    if chosen and state.last_link_time is None and plan.opening_time is not None:
        chosen[0] = chosen[0].from_opening(plan.opening_time)
    return chosen


def _support(
    poses: Odometry,
    loads: Sequence[Loads],
    trackers: Sequence[FootTracker],
    state: BatchState,
    plan: ConversionPlan,
) -> list[SupportScene]:
    """Return what the robot stands on at poses, and at the log's first time.

    At poses before every foot has sent a message nothing is known: what follows at once stands at
    the log's first time instead.

    Args:
        poses: of the base, at ticks.
        loads: of the feet's messages in the batch.
        trackers: of each foot in the batch.
        state: what all earlier batches pass on.
        plan: what to write.
    """
    if not plan.draws_support:
        return []
    com_offset_m, opening = plan.selection.robot.com_offset_m or (0.0, 0.0, 0.0), plan.opening_time
    if state.last_pose_time is not None or opening is None:
        return [support_scene(poses, trackers, com_offset_m)]
    known_from = all_known_from(loads, opening)
    known_from = known_from if known_from - opening <= NEAR_NS else opening
    later = poses.pick((poses.log_time >= known_from) & (poses.log_time > opening))
    return [
        opening_support(poses, trackers, opening, known_from, com_offset_m),
        support_scene(later, trackers, com_offset_m),
    ]


def _legs(
    poses: Odometry,
    trackers: Sequence[FootTracker],
    hips: Floats,
    state: BatchState,
    plan: ConversionPlan,
) -> LegLines:
    """Return the lines of the legs; those at the first pose stand at the log's first time, too."""
    legs = leg_lines(poses, trackers, hips)
    opening = plan.opening_time
    if state.last_pose_time is not None or opening is None or not len(legs.log_time):
        return legs
    if not 0 < legs.log_time[0] - opening <= NEAR_NS:
        return legs
    return LegLines(
        np.concatenate([[opening], legs.log_time]),
        np.concatenate([[opening], legs.stamp]),
        np.concatenate([legs.ends[:1], legs.ends]),
    )


def _with_swings(
    decoded: DecodedContacts, samples: Samples, state: BatchState, plan: ConversionPlan
) -> Samples:
    """Return the samples, and swings where the sensor is silent in swing."""
    if not decoded.source.silent_in_swing:
        return samples
    return swings_in_batch(samples, plan.silent, state.last_messages, plan.swings_from)


def _of_known_force(samples: Samples, plan: ConversionPlan) -> Samples:
    """Return the samples of feet whose force is known."""
    feet = range(len(plan.selection.robot.feet))
    known = [foot for foot in feet if plan.selection.knows_force(foot)]
    return samples if len(known) == len(feet) else samples.pick(np.isin(samples.foot, known))


def _arrows(
    decoded: DecodedContacts, samples: Samples, plan: ConversionPlan
) -> tuple[Arrows, ArrowCounts]:
    """Compute the arrows of one contact type."""
    if not len(samples.foot):
        return no_arrows(), ArrowCounts()
    return plan.style.compute(
        ArrowInput(
            samples=samples,
            contacts=decoded.reduced.contacts,
            force_in_world=plan.force_in_world,
            body_weight_n=plan.body_weight_n,
            scale=plan.arrow_scale,
        )
    )


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
