"""What is drawn of a walk in any span of log time: looked up, so that spans need no order."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dogbot_logtool.conversion.plan import ConversionPlan
from dogbot_logtool.core.arrays import AnyColumns, Ints, concatenated, picked
from dogbot_logtool.core.base.poses import Odometry, usable_poses
from dogbot_logtool.core.checks.frames import transform_findings
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.frames.kinematics import TransformMessages, from_opening
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.scene.arrows import Arrows, force_arrows, pressure_arrows
from dogbot_logtool.core.scene.feet import DrawnFoot, drawn_foot
from dogbot_logtool.core.scene.loads import foot_labels, foot_loads, opening_load, silences
from dogbot_logtool.core.scene.support_scene import leg_lines, support_scene
from dogbot_logtool.core.stability import NEAR_NS
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.reader.recording import in_time_order
from dogbot_logtool.robot.robot_model.description import moved_links
from dogbot_logtool.writer.annotations import Drawn


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Scene:
    """All that is drawn of a walk; columns are sorted by log time."""

    plan: ConversionPlan
    walk: Walk
    feet: tuple[DrawnFoot, ...]
    poses: Odometry
    """Those that support and legs are drawn at."""
    others: Sequence[Drawn]
    """What is made of neither samples nor these poses: transforms of base and links, arrows of
    contact states as they were recorded, and loads where the log and silences begin."""
    known_from: int
    """ns, log time from which the state of every foot is known, if that is soon."""
    findings: tuple[Finding, ...]
    """Found while sensors without contact points were placed."""


def draw(plan: ConversionPlan, walk: Walk, recorded: Sequence[Arrows]) -> Scene:
    """Prepare what is drawn of a walk.

    Args:
        plan: what is drawn.
        walk: that is drawn; contact that findings void is not known.
        recorded: arrows of contact states, for a style that draws these.
    """
    recording, opening = walk.recording, plan.opening or 0
    samples, findings = _placed(plan, walk)
    feet = tuple(
        drawn_foot(
            number,
            replace(each, in_world=each.in_world | walk.settings.force_in_world),
            foot.record,
            contact_known=walk.metrics.feet[foot.name].contact_fraction is not None,
            has_force=walk.settings.feet[number].has_force,
        )
        for number, (each, foot) in enumerate(zip(samples, walk.feet, strict=True))
    )
    poses = recording.base.pick(usable_poses(recording.base))
    poses = poses.pick(first_at_each_tick(poses.time, plan.options.tf_rate))
    first = [int(foot.samples.log_time[0]) for foot in feet if len(foot.samples.log_time)]
    known_from = max([opening, *first])
    known_from = known_from if known_from - opening <= NEAR_NS else opening
    loads = [opening_load(foot, walk.settings.body_weight_n, opening) for foot in feet]
    loads.append(silences(feet, opening, plan.end))
    return Scene(
        plan=plan,
        walk=walk,
        feet=feet,
        poses=_known_poses(poses, opening, known_from),
        others=[
            *_transforms(plan, recording, poses, opening),
            *([in_time_order(concatenated(recorded))] if recorded else []),
            in_time_order(concatenated(loads)),
        ],
        known_from=known_from,
        findings=findings,
    )


def _placed(plan: ConversionPlan, walk: Walk) -> tuple[tuple[Samples, ...], tuple[Finding, ...]]:
    """Return the samples of all feet; those without contact points are where their frames are."""
    recording = walk.recording
    if plan.frames is None:
        return recording.feet, ()
    points = tuple(None if p and p.recorded else p for p in plan.frames.points)
    if not any(points):
        return recording.feet, ()
    # Forces are in the world already, as far as they can be turned.
    frames = replace(plan.frames, points=points, links=(None,) * len(points))
    samples, counts = frames.place(recording.feet)
    return samples, tuple(transform_findings(frames, counts))


def _known_poses(poses: Odometry, opening: int, known_from: int) -> Odometry:
    """Return the poses at which the state of every foot is known.

    The first stands at the log's first time, too, if it follows at once.
    """
    known = poses.pick(poses.log_time >= known_from)
    if not len(poses.log_time) or poses.log_time[0] - opening > NEAR_NS:
        return known
    time = np.array([opening])
    first = replace(picked(poses, slice(0, 1)), log_time=time, stamp=time)
    return concatenated([first, known.pick(known.log_time > opening)])


def _transforms(
    plan: ConversionPlan, recording: Recording, poses: Odometry, opening: int
) -> Iterator[TransformMessages]:
    """Yield the transforms of the base and of the links, and what they are at the first time."""
    if plan.writes_base:
        place = poses.position[:, None], poses.orientation[:, None]
        yield from_opening(TransformMessages(poses.log_time, poses.time, *place), opening)
    joints, rate_hz = plan.description.joints, plan.options.tf_rate
    for table in recording.joints if joints else ():
        if table.topic == recording.joints[0].topic:
            links = moved_links(joints, table)
            yield from_opening(picked(links, first_at_each_tick(links.stamp, rate_hz)), opening)


def annotations_between(scene: Scene, start: int, end: int) -> tuple[list[Drawn], Counter[str]]:
    """Return what is drawn from a log time on and before another, ns.

    Returns:
        annotations, and how many lack something: arrows as in `core/scene/arrows.py`,
        ``support_unknown`` without a polygon, since contact or contact point of some foot is
        unknown, ``support_unweighed`` with a polygon, but a vertical force unknown.
    """

    def rows(log_time: Ints) -> slice:
        return slice(*np.searchsorted(log_time, [start, end]).tolist())

    def within(columns: AnyColumns, log_time: Ints) -> AnyColumns:
        return picked(columns, rows(log_time))

    plan, wanted, counts = scene.plan, scene.plan.wanted, Counter[str]()
    feet = [(foot, rows(foot.samples.log_time)) for foot in scene.feet]
    forced = [each for each in feet if each[0].has_force]
    drawn: list[Drawn] = [within(each, each.log_time) for each in scene.others]
    for foot, own in () if plan.style.needs_contact_states else forced:
        arrows, skipped = _arrows(plan, foot, own)
        drawn.append(arrows)
        counts += skipped
    drawn += [foot_loads(*each, scene.walk.settings.body_weight_n) for each in feet]
    drawn += [foot_labels(*each) for each in forced]
    poses = within(scene.poses, scene.poses.log_time)
    # Before the feet are known, what they do at once.
    states = replace(poses, log_time=np.maximum(poses.log_time, scene.known_from))
    if wanted.has_support:
        support = support_scene(states, scene.feet, plan.selection.robot.com_offset_m or (0, 0, 0))
        counts += Counter(support_unknown=support.unknown, support_unweighed=support.unweighed)
        drawn.append(replace(support, log_time=poses.log_time, stamp=poses.time))
    if plan.description.hips is not None:
        lines = leg_lines(states, scene.feet, plan.description.hips)
        drawn.append(replace(lines, log_time=poses.log_time, stamp=poses.time))
    return drawn, counts


def _arrows(plan: ConversionPlan, foot: DrawnFoot, rows: slice) -> tuple[Arrows, Counter[str]]:
    """Return the arrows of samples that touch, and the removals of all others."""
    samples = picked(foot.samples, rows)
    samples = replace(
        samples,
        in_contact=samples.in_contact & foot.touching[rows],
        force=samples.force.astype(np.float64),
        normal=samples.normal.astype(np.float64),
    )
    made = force_arrows if plan.style.along_force else pressure_arrows
    return made(samples, plan.arrow_scale)
