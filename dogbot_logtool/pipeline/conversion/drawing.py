"""What is drawn and told of a batch: transforms, arrows, loads and support."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry, base_transforms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import Footing
from dogbot_logtool.core.contact.silent_swing import with_swings
from dogbot_logtool.core.geometry.clock import first_at_each_tick
from dogbot_logtool.core.load.loads import Loads, foot_loads
from dogbot_logtool.core.scene.arrows import (
    ArrowCounts,
    Arrows,
    classic_arrows,
    force_arrows,
    no_arrows,
    pressure_arrows,
)
from dogbot_logtool.core.scene.support_scene import support_scene
from dogbot_logtool.pipeline.conversion.carried import Carried
from dogbot_logtool.pipeline.conversion.reading import ReadBatch
from dogbot_logtool.pipeline.plan import Plan
from dogbot_logtool.reader.messages.contacts.registry import ContactsRead
from dogbot_logtool.writer.annotations import AnnotationColumns


@dataclass(frozen=True, slots=True)
class Drawn:
    """The annotations of a batch, still as columns."""

    columns: AnnotationColumns
    skipped: ArrowCounts


def draw(
    read: ReadBatch,
    placed: Sequence[Samples],
    footings: Sequence[Footing],
    carried: Carried,
    plan: Plan,
) -> Drawn:
    """Compute what is to be written about a batch.

    Args:
        read: the batch.
        placed: its contacts, placed in the world as far as frames tell.
        footings: each foot's way through the batch, if support is to be drawn.
        carried: what all earlier batches hand on.
        plan: what is to be done.
    """
    arrows: list[Arrows] = []
    loads: list[Loads] = []
    skipped = ArrowCounts()
    for contacts, in_world in zip(read.columns.contacts, placed, strict=True):
        samples = contacts.felt.samples
        felt = _with_swings(contacts, samples, carried, plan)
        loads.append(foot_loads(felt, plan.body_weight_n))
        if in_world is not samples:
            felt = _with_swings(contacts, _as_drawn(samples, in_world, plan), carried, plan)
        drawn, left_out = _arrows(contacts, felt, plan)
        arrows.append(drawn)
        skipped += left_out
    poses = _at_ticks(read.poses, carried.odometry, plan.options.tf_rate_hz)
    support = support_scene(poses, footings) if footings else None
    return Drawn(AnnotationColumns(base_transforms(poses), arrows, loads, support), skipped)


def _as_drawn(recorded: Samples, in_world: Samples, plan: Plan) -> Samples:
    """Return samples that were placed, with forces as the style wants them.

    Turning a force changes its magnitude in the last digit, so loads and the arrows that show
    nothing else are those of the recorded one.
    """
    if plan.options.style == "force":
        return in_world
    return replace(in_world, force=recorded.force)


def _with_swings(read: ContactsRead, samples: Samples, carried: Carried, plan: Plan) -> Samples:
    """Return the samples, and swings where the sensor is silent in swing."""
    if not read.source.silent_in_swing:
        return samples
    return with_swings(samples, plan.swing_intervals, carried.contacts, plan.swings_from)


def _at_ticks(poses: Odometry, previous_time: int | None, rate_hz: float) -> Odometry:
    """Return the base's poses at the ticks of the clock."""
    return poses.pick(first_at_each_tick(poses.time, rate_hz, previous_time))


def _arrows(read: ContactsRead, samples: Samples, plan: Plan) -> tuple[Arrows, ArrowCounts]:
    feet = range(len(plan.selection.robot.feet))
    known = [foot for foot in feet if plan.selection.knows_force(foot)]
    if len(known) < len(feet):
        samples = samples.pick(np.isin(samples.foot, known))
    if not len(samples.foot):
        return no_arrows(), ArrowCounts()
    newtons_per_metre = plan.selection.robot.newtons_per_metre
    match plan.options.style:
        case "classic":
            contacts = read.felt.contacts
            return (no_arrows(), ArrowCounts()) if contacts is None else classic_arrows(contacts)
        case "pressure":
            return pressure_arrows(samples, newtons_per_metre)
        case "force":
            return force_arrows(
                samples,
                force_in_world=plan.force_in_world,
                body_weight_n=plan.body_weight_n,
                newtons_per_metre=newtons_per_metre,
            )
