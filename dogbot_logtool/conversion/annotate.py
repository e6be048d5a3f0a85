"""What is drawn of a walk in any span of log time: looked up, so that spans need no order."""

from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np

from dogbot_logtool.conversion.plan import ConversionPlan
from dogbot_logtool.core.arrays import Ints, picked
from dogbot_logtool.core.base.poses import (
    Odometry,
    base_transforms,
    from_opening,
    usable_poses,
)
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.core.events.log_messages import event_messages, gait_states, to_log_time
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.scene.arrows import ArrowCounts, ArrowInput, Arrows, removals
from dogbot_logtool.core.scene.feet import DrawnFoot, drawn_foot
from dogbot_logtool.core.scene.labels import foot_labels
from dogbot_logtool.core.scene.legs import leg_lines
from dogbot_logtool.core.scene.loads import Loads, foot_loads, silences
from dogbot_logtool.core.scene.support_scene import SupportScene, opening_support, support_scene
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.reader.recording import in_time_order
from dogbot_logtool.robot.frames.world_frames import frame_findings
from dogbot_logtool.writer.annotations import AnnotationColumns


@dataclass(frozen=True, slots=True)
class DrawnCounts:
    """Annotations of a span, or of the whole log, that lack something."""

    arrows: ArrowCounts = field(default_factory=ArrowCounts)
    support_unknown: int = 0
    """Support messages without a polygon: contact or contact point of some foot unknown."""
    support_unweighed: int = 0
    """Support messages with a polygon, but a vertical force unknown."""

    def __add__(self, other: "DrawnCounts") -> "DrawnCounts":
        return DrawnCounts(
            self.arrows + other.arrows,
            self.support_unknown + other.support_unknown,
            self.support_unweighed + other.support_unweighed,
        )


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


def draw(
    plan: ConversionPlan,
    recording: Recording,
    stats: Stats,
    metrics: WalkMetrics,
    end: int,
    recorded: Arrows,
) -> Scene:
    """Prepare what is drawn of a walk.

    Args:
        plan: what is drawn.
        recording: the columns that were measured.
        stats: what was measured.
        metrics: made of that; contact that findings void is not known.
        end: ns, log time of the log's last message.
        recorded: arrows of contact states, for a style that draws these.
    """
    opening = 0 if plan.opening is None else plan.opening
    samples, findings = _placed(plan, recording, stats)
    feet = _feet(plan, samples, stats, metrics)
    poses = recording.base.pick(usable_poses(recording.base))
    at_ticks = first_at_each_tick(poses.time, plan.options.tf_rate)
    first = [int(foot.samples.log_time[0]) for foot in feet if len(foot.samples.log_time)]
    known_from = max([opening, *first])
    events, gaits = event_messages(stats), gait_states(stats)
    times = (np.array([one.time for one in each], np.int64) for each in (events, gaits))
    event_log_time, gait_log_time = (to_log_time(stats, time, opening, end) for time in times)
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


def _placed(
    plan: ConversionPlan, recording: Recording, stats: Stats
) -> tuple[tuple[Samples, ...], tuple[Finding, ...]]:
    """Return the samples of all feet; those without contact points are where their frames are."""
    if plan.frames is None:
        return recording.feet, ()
    points = tuple(None if p and p.recorded else p for p in plan.frames.points)
    if not any(points):
        return recording.feet, ()
    # Forces are in the world already, as far as they can be turned.
    links, clock = (None,) * len(points), stats.settings.clock
    frames = replace(plan.frames, points=points, links=links, clock=clock)
    placed = frames.place(recording.feet, frames.tracks(recording.transforms, recording.base))
    return placed.samples, tuple(frame_findings(frames, placed))


def _feet(
    plan: ConversionPlan, samples: Sequence[Samples], stats: Stats, metrics: WalkMetrics
) -> tuple[DrawnFoot, ...]:
    """Put what was measured of all feet beside their samples."""
    settings = stats.settings
    return tuple(
        drawn_foot(
            number,
            each,
            foot.record,
            contact_known=metrics.feet[foot.name].contact_fraction is not None,
            has_force=plan.selection.knows_force(number),
            force_in_world=settings.force_in_world,
        )
        for number, (each, foot) in enumerate(zip(samples, stats.feet, strict=True))
    )


def _links(plan: ConversionPlan, recording: Recording, opening: int) -> list[LinkTransforms]:
    """Return the links that are written: as often as the base, and at the log's first time."""
    motion = plan.description.motion
    tables = () if motion is None else recording.joints
    found = []
    for table in tables:
        if motion is not None and table.topic == motion.channel.topic:
            samples = table.samples
            times = samples.log_time, samples.stamp
            moved = motion.links(table.names, *times, samples.position.astype(np.float64))
            rows = first_at_each_tick(moved.stamp, plan.options.tf_rate)
            found.append(moved.pick(rows).from_opening(opening))
    return found


def annotations_between(
    scene: Scene, start: int, end: int
) -> tuple[AnnotationColumns, DrawnCounts]:
    """Return what is drawn from a log time on and before another, ns."""
    plan = scene.plan
    feet = [(foot, foot.between(start, end)) for foot in scene.feet]
    with_force = [each for each in feet if each[0].has_force]
    if scene.recorded is None:
        drawn = [_arrows(scene, *each) for each in with_force]
    else:
        own = picked(scene.recorded, _rows(scene.recorded.log_time, start, end))
        drawn = [([own], ArrowCounts())]
    rows = _rows(scene.poses.log_time, start, end)
    poses = picked(scene.poses, rows)
    opens = rows.start == 0 < rows.stop
    support = _support(scene, poses, opens=opens) if plan.draws_support else []
    hips, transforms = plan.description.hips, base_transforms(poses)
    opening = scene.opening if opens else None
    columns = AnnotationColumns(
        transforms if opening is None else from_opening(transforms, opening),
        [arrows for of_foot, _ in drawn for arrows in of_foot],
        [
            *(foot_loads(*each, plan.body_weight_n, scene.opening) for each in feet),
            picked(scene.silences, _rows(scene.silences.log_time, start, end)),
        ],
        support,
        [foot_labels(*each) for each in with_force],
        [] if hips is None else [leg_lines(poses, scene.feet, hips, opening)],
        [each.pick(_rows(each.log_time, start, end)) for each in scene.links],
    )
    counts = DrawnCounts(
        sum((counts for _, counts in drawn), ArrowCounts()),
        sum(each.unknown for each in support),
        sum(each.unweighed for each in support),
    )
    return columns, counts


def _rows(log_time: Ints, start: int, end: int) -> slice:
    """Return the rows from a log time on and before another, ns."""
    first, behind = np.searchsorted(log_time, [start, end]).tolist()
    return slice(first, behind)


def _arrows(scene: Scene, foot: DrawnFoot, rows: slice) -> tuple[list[Arrows], ArrowCounts]:
    """Return the arrows of samples that touch, and the removals of all others."""
    touching = foot.touching[rows]
    samples = foot.samples.pick(rows.start + np.flatnonzero(touching))
    samples = replace(
        samples,
        force=samples.force.astype(np.float64),
        normal=samples.normal.astype(np.float64),
    )
    drawn, skipped = scene.plan.style.compute(
        ArrowInput(
            samples,
            None,
            foot.force_in_world,
            scene.plan.body_weight_n,
            scene.plan.arrow_scale,
        )
    )
    removed = removals(foot.samples.pick(rows.start + np.flatnonzero(~touching)))
    return [drawn, removed], skipped


def _support(scene: Scene, poses: Odometry, *, opens: bool) -> list[SupportScene]:
    """Return what the robot stands on at poses, and at the log's first time.

    At poses before every foot has sent a message nothing is known: what follows at once stands at
    the log's first time instead.
    """
    plan, feet, opening = scene.plan, scene.feet, scene.opening
    com_offset_m = plan.selection.robot.com_offset_m or (0.0, 0.0, 0.0)
    known = (poses.log_time >= scene.known_from) & (poses.log_time > opening)
    later = support_scene(poses.pick(known), feet, com_offset_m)
    if not opens:
        return [later]
    return [opening_support(poses, feet, opening, scene.known_from, com_offset_m), later]
