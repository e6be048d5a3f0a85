"""What is drawn of a walk in any span of log time: looked up, so that spans need no order."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dogbot_logtool.conversion.plan import ConversionPlan
from dogbot_logtool.core.arrays import Ints, picked
from dogbot_logtool.core.base.poses import (
    Odometry,
    base_transforms,
    usable_poses,
)
from dogbot_logtool.core.base.poses import from_opening as transforms_from_opening
from dogbot_logtool.core.checks.frames import transform_findings
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.core.events.log_messages import event_messages, gait_states, to_log_time
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.scene.arrows import Arrows, force_arrows, pressure_arrows, removals
from dogbot_logtool.core.scene.feet import DrawnFoot, drawn_foot, from_opening
from dogbot_logtool.core.scene.labels import foot_labels
from dogbot_logtool.core.scene.legs import leg_lines
from dogbot_logtool.core.scene.loads import Loads, foot_loads, silences
from dogbot_logtool.core.scene.support_scene import SupportScene, support_scene
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.reader.recording import in_time_order
from dogbot_logtool.writer.annotations import AnnotationColumns


@dataclass(frozen=True, slots=True)
class Scene:
    """All that is drawn of a walk."""

    plan: ConversionPlan
    feet: tuple[DrawnFoot, ...]
    poses: Odometry
    """Those of the base that are written, by log time."""
    links: Sequence[LinkTransforms]
    """Those that joint states move, by log time."""
    silences: Loads
    recorded: Arrows | None
    """Those of contact states as they were recorded, by log time; None: arrows show the walk."""
    events: Sequence[EventMessage]
    event_log_time: Ints
    """(events,) ns."""
    gaits: Sequence[GaitState]
    gait_log_time: Ints
    """(gaits,) ns."""
    opening: int
    """ns, the output's first log time."""
    known_from: int
    """ns, log time from which the state of every foot is known, if that is soon."""
    findings: tuple[Finding, ...]
    """Found while sensors without contact points were placed."""


def draw(plan: ConversionPlan, walk: Walk, end: int, recorded: Arrows) -> Scene:
    """Prepare what is drawn of a walk.

    Args:
        plan: what is drawn.
        walk: that is drawn; contact that findings void is not known.
        end: ns, log time of the log's last message.
        recorded: arrows of contact states, for a style that draws these.
    """
    recording, opening = walk.recording, 0 if plan.opening is None else plan.opening
    samples, findings = _placed(plan, walk)
    feet = _feet(samples, walk)
    poses = recording.base.pick(usable_poses(recording.base))
    at_ticks = first_at_each_tick(poses.time, plan.options.tf_rate)
    first = [int(foot.samples.log_time[0]) for foot in feet if len(foot.samples.log_time)]
    known_from = max([opening, *first])
    events, gaits = event_messages(walk), gait_states(walk)
    times = (np.array([one.time for one in each], np.int64) for each in (events, gaits))
    event_log_time, gait_log_time = (to_log_time(walk, time, opening, end) for time in times)
    return Scene(
        plan=plan,
        feet=feet,
        poses=poses.pick(at_ticks),
        links=_links(plan, recording, opening),
        silences=silences(feet, opening, end),
        recorded=in_time_order(recorded) if plan.style.needs_contact_states else None,
        events=events,
        event_log_time=event_log_time,
        gaits=gaits,
        gait_log_time=gait_log_time,
        opening=opening,
        known_from=known_from if known_from - opening <= NEAR_NS else opening,
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
    links, clock = (None,) * len(points), walk.settings.clock
    frames = replace(plan.frames, points=points, links=links, clock=clock)
    tracks = frames.tracks(recording.transforms, recording.base)
    samples, counts = frames.place(recording.feet, tracks)
    return samples, tuple(transform_findings(frames, counts))


def _feet(samples: Sequence[Samples], walk: Walk) -> tuple[DrawnFoot, ...]:
    """Put what was measured of all feet beside their samples."""
    settings = walk.settings
    return tuple(
        drawn_foot(
            number,
            each,
            foot.record,
            contact_known=walk.metrics.feet[foot.name].contact_fraction is not None,
            has_force=settings.feet[number].has_force,
            force_in_world=settings.force_in_world,
        )
        for number, (each, foot) in enumerate(zip(samples, walk.feet, strict=True))
    )


def _links(plan: ConversionPlan, recording: Recording, opening: int) -> list[LinkTransforms]:
    """Return the links that are written: as often as the base, and at the log's first time."""
    motion, rate_hz = plan.description.motion, plan.options.tf_rate
    if motion is None:
        return []
    moved = (motion.links(table) for table in recording.joints if table.topic == motion.topic)
    return [
        each.pick(first_at_each_tick(each.stamp, rate_hz)).from_opening(opening) for each in moved
    ]


def annotations_between(
    scene: Scene, start: int, end: int
) -> tuple[AnnotationColumns, Counter[str]]:
    """Return what is drawn from a log time on and before another, ns.

    Returns:
        annotations, and how many lack something: arrows as in `core/scene/arrows.py`,
        ``support_unknown`` without a polygon, since contact or contact point of some foot is
        unknown, ``support_unweighed`` with a polygon, but a vertical force unknown.
    """
    plan, opening = scene.plan, scene.opening
    feet = [(foot, _rows(foot.samples.log_time, start, end)) for foot in scene.feet]
    with_force = [each for each in feet if each[0].has_force]
    if scene.recorded is None:
        drawn = [_arrows(scene, *each) for each in with_force]
    else:
        own = picked(scene.recorded, _rows(scene.recorded.log_time, start, end))
        drawn = [([own], Counter[str]())]
    rows = _rows(scene.poses.log_time, start, end)
    poses = picked(scene.poses, rows)
    opens = rows.start == 0 < rows.stop
    support = _support(scene, poses, opens=opens) if plan.draws_support else None
    transforms, legs = base_transforms(poses), []
    if opens:
        transforms = transforms_from_opening(transforms, opening)
    if plan.description.hips is not None:
        lines = leg_lines(poses, scene.feet, plan.description.hips)
        legs = [from_opening(lines, opening) if opens else lines]
    columns = AnnotationColumns(
        transforms,
        [arrows for of_foot, _ in drawn for arrows in of_foot],
        [
            *(foot_loads(*each, plan.body_weight_n, opening) for each in feet),
            picked(scene.silences, _rows(scene.silences.log_time, start, end)),
        ],
        [] if support is None else [support],
        [foot_labels(*each) for each in with_force],
        legs,
        [each.pick(_rows(each.log_time, start, end)) for each in scene.links],
    )
    counts = sum((skipped for _, skipped in drawn), Counter[str]())
    if support is not None:
        counts += Counter(support_unknown=support.unknown, support_unweighed=support.unweighed)
    return columns, counts


def _rows(log_time: Ints, start: int, end: int) -> slice:
    """Return the rows from a log time on and before another, ns."""
    first, behind = np.searchsorted(log_time, [start, end]).tolist()
    return slice(first, behind)


def _arrows(scene: Scene, foot: DrawnFoot, rows: slice) -> tuple[list[Arrows], Counter[str]]:
    """Return the arrows of samples that touch, and the removals of all others."""
    plan, touching = scene.plan, foot.touching[rows]
    samples = foot.samples.pick(rows.start + np.flatnonzero(touching))
    samples = replace(
        samples,
        force=samples.force.astype(np.float64),
        normal=samples.normal.astype(np.float64),
    )
    if plan.style.along_force:
        drawn, skipped = force_arrows(
            samples,
            force_in_world=foot.force_in_world,
            body_weight_n=plan.body_weight_n,
            scale=plan.arrow_scale,
        )
    else:
        drawn, skipped = pressure_arrows(samples, plan.arrow_scale)
    return [drawn, removals(foot.samples.pick(rows.start + np.flatnonzero(~touching)))], skipped


def _support(scene: Scene, poses: Odometry, *, opens: bool) -> SupportScene:
    """Return what the robot stands on at poses, and at the log's first time.

    At poses before every foot has sent a message nothing is known: what follows at once stands at
    the log's first time instead, as the first of all poses does.
    """
    opening, known_from = scene.opening, scene.known_from
    first = [0] if opens and poses.log_time[0] - opening <= NEAR_NS else []
    known = np.flatnonzero((poses.log_time >= known_from) & (poses.log_time > opening))
    poses = poses.pick(np.array([*first, *known], np.int64))
    log_time, stamp, looked_up = poses.log_time.copy(), poses.time.copy(), poses.log_time.copy()
    log_time[: len(first)] = stamp[: len(first)] = opening
    looked_up[: len(first)] = np.maximum(looked_up[: len(first)], known_from)
    com_offset_m = scene.plan.selection.robot.com_offset_m or (0.0, 0.0, 0.0)
    support = support_scene(replace(poses, log_time=looked_up), scene.feet, com_offset_m)
    return replace(support, log_time=log_time, stamp=stamp)
