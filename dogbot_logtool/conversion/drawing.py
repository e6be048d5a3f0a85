"""What is drawn and told of a batch: transforms, arrows and loads."""

from dataclasses import dataclass

import numpy as np

from dogbot_logtool.conversion.carried import Carried
from dogbot_logtool.conversion.reading import ReadBatch
from dogbot_logtool.core.arrows import (
    ArrowCounts,
    Arrows,
    classic_arrows,
    force_arrows,
    no_arrows,
    pressure_arrows,
)
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.link_frames import FrameCounts
from dogbot_logtool.core.loads import Loads, foot_loads
from dogbot_logtool.core.odometry import (
    Odometry,
    Transforms,
    base_transforms,
    first_at_each_tick,
)
from dogbot_logtool.core.silent_swing import with_swings
from dogbot_logtool.core.transform_buffer import TransformBuffer
from dogbot_logtool.plan import Plan
from dogbot_logtool.reader.contact_sources.registry import ContactsRead
from dogbot_logtool.writer.annotations import AnnotationColumns


@dataclass(frozen=True, slots=True)
class Drawn:
    """The annotations of a batch, still as columns."""

    columns: AnnotationColumns
    skipped: ArrowCounts
    placed: FrameCounts
    """What the log's own frames told of the contacts that are drawn."""


def draw(read: ReadBatch, carried: Carried, plan: Plan, log_start: int | None) -> Drawn:
    """Compute what is to be written about a batch.

    Args:
        read: the batch.
        carried: what all earlier batches hand on.
        plan: what is to be done.
        log_start: ns, log time at which the log begins.
    """
    start = None if plan.start_time is not None else log_start
    arrows: list[Arrows] = []
    loads: list[Loads] = []
    skipped, told = ArrowCounts(), FrameCounts()
    around = read.frames.around(carried.transforms) if read.frames else TransformBuffer()
    for contacts in read.contacts:
        samples = contacts.felt.samples
        if contacts.source.silent_in_swing:
            samples = with_swings(samples, plan.swing_intervals, carried.contacts, start)
        loads.append(foot_loads(samples, plan.body_weight_n))
        if plan.frames is not None:
            samples, counts = plan.frames.place(samples, around)
            told += counts
        drawn, left_out = _arrows(contacts, samples, plan)
        arrows.append(drawn)
        skipped += left_out
    transforms = _transforms(read.poses, carried.odometry, plan.options.tf_rate_hz)
    return Drawn(AnnotationColumns(transforms, arrows, loads), skipped, told)


def _transforms(poses: Odometry, previous_time: int | None, rate_hz: float) -> Transforms:
    """Return the base's transforms at the ticks of the clock."""
    return base_transforms(poses.pick(first_at_each_tick(poses.time, rate_hz, previous_time)))


def _arrows(read: ContactsRead, samples: Samples, plan: Plan) -> tuple[Arrows, ArrowCounts]:
    feet = range(len(plan.selection.robot.feet))
    known = [foot for foot in feet if plan.selection.knows_force(foot)]
    if not np.isin(known, np.unique(samples.foot)).any():
        return no_arrows(), ArrowCounts()
    if len(known) < len(feet):
        samples = samples.pick(np.isin(samples.foot, known))
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
