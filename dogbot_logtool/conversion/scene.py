"""All that is drawn of a walk: decided and prepared once, before the first annotation is made."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final, Literal, NamedTuple

from dogbot_logtool.conversion.findings import arrow_findings, no_support, second_tf
from dogbot_logtool.core.arrays import concatenated, picked
from dogbot_logtool.core.base.poses import Odometry, usable_poses
from dogbot_logtool.core.checks.recorded import transform_findings
from dogbot_logtool.core.clock import first_at_each_tick
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.kinematics import TransformMessages, from_opening
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import WorldFrames
from dogbot_logtool.core.scene.arrows import (
    ARROW_STYLES,
    LIFETIME_S,
    Arrows,
    ArrowScale,
    ArrowStyle,
    arrow_scale,
)
from dogbot_logtool.core.scene.feet import DrawnFoot, drawn_foot, opening_load, silences
from dogbot_logtool.core.stability import NEAR_NS
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.recording import in_time_order
from dogbot_logtool.robot.description import (
    RobotDescription,
    moved_links,
    robot_description,
)
from dogbot_logtool.robot.measuring.legs import sensor_points
from dogbot_logtool.robot.recorded import time_limits
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.urdf import RobotOfUrdf
from dogbot_logtool.writer.annotations import Drawn, WantedAnnotations
from dogbot_logtool.writer.encodings.registry import encoding_named
from dogbot_logtool.writer.markers import Look

ESTIMATED_WIDTH: Final = 0.5
"""Width of arrows whose forces are estimated, over that of measured ones."""


class Scene(NamedTuple):
    """All that is drawn of a walk; columns are sorted by log time."""

    walk: Walk
    selection: Selection
    options: ConvertOptions
    style: ArrowStyle
    wanted: WantedAnnotations
    description: RobotDescription
    """Of the robot, with hips only where the lines of `/legs` are drawn."""
    arrow_scale: ArrowScale
    feet: tuple[DrawnFoot, ...]
    poses: Odometry
    """Those that support and legs are drawn at."""
    others: Sequence[Drawn]
    """What is made of neither samples nor these poses: transforms of base and links, arrows of
    contact states as they were recorded, and loads where the log and silences begin."""
    opening: int | None
    """ns, log time of the output's first message; None: the log is empty."""
    end: int
    """ns, of its last."""
    findings: tuple[Finding, ...]


def make_scene(
    log: Log,
    selection: Selection,
    model: RobotOfUrdf | None,
    walk: Walk,
    options: ConvertOptions,
    left_out: frozenset[int],
    recorded: Arrows | None,
) -> Scene:
    """Decide what is drawn, and prepare it.

    Args:
        log: the log.
        selection: its topics.
        model: the robot's description, where joint states move it.
        walk: that is drawn; contact that findings void is not known.
        options: what the user asks for.
        left_out: ids of the channels that are not copied.
        recorded: arrows of contact states, for a style that draws these.

    Raises:
        CallError: the log has no such time; the file of the robot cannot be read.
    """
    style, settings, frames = ARROW_STYLES[options.style], walk.settings, walk.frames
    turns = settings.wrench_frame is WrenchFrame.LINK
    links = frames.links if turns else (None,) * len(settings.feet)
    placed = frames.follow(links, sensor_points(selection, frames, settings))
    samples, sample_findings = _placed_samples(placed, walk)
    feet = tuple(_feet(samples, walk))
    unsupported = no_support(selection)
    second = second_tf(selection, frames, options, left_out) if options.tf == "auto" else None
    writes_base = selection.has_base and options.tf != "never" and second is None
    description = robot_description(log, selection, model, walk, options)
    if unsupported is not None:
        description = description._replace(hips=None)
    given, weight_n = selection.robot.newtons_per_metre, settings.body_weight_n
    weight_n = weight_n or settings.estimated_weight_n
    start, end = time_limits(log, options.start, options.end)
    last, opening = log.end_time or 0, log.start_time if start is None else start
    end, begin = last if end is None else min(end, last), opening or 0
    poses = walk.recording.base.pick(usable_poses(walk.recording.base))
    poses = poses.pick(first_at_each_tick(poses.time, options.tf_rate))
    transforms = [_of_base(poses)] if writes_base else []
    if description.joints:
        moved = moved_links(description.joints, walk.recording.joints[0])
        transforms.append(picked(moved, first_at_each_tick(moved.stamp, options.tf_rate)))
    loads = [opening_load(foot, settings.body_weight_n, begin) for foot in feet]
    return Scene(
        walk=walk,
        selection=selection,
        options=options,
        style=style,
        wanted=WantedAnnotations(
            [foot.name for foot in selection.robot.feet],
            frames.world,
            frames.base,
            _look(selection, style, options.tf_rate),
            links=[(joint.parent, joint.child) for joint in description.joints],
            has_transforms=writes_base or bool(description.joints),
            has_support=unsupported is None,
            has_legs=description.hips is not None,
            description=_profile(log, options) if description.urdf is not None else "",
        ),
        description=description,
        arrow_scale=arrow_scale(given, weight_n, description.height_m, by_weight=style.along_force),
        feet=feet,
        poses=_opened(poses, begin),
        others=[
            *(from_opening(each, begin) for each in transforms),
            *([recorded] if recorded is not None else []),
            in_time_order(concatenated([*loads, silences(feet, begin, end)])),
        ],
        opening=opening,
        end=end,
        findings=(
            *([unsupported] if unsupported else []),
            *arrow_findings(selection, style, placed, settings, weight_n),
            *description.findings,
            *([second] if second else []),
            *sample_findings,
        ),
    )


def _profile(log: Log, options: ConvertOptions) -> Literal["ros1", "ros2"]:
    """Return as whose message the robot is described."""
    profile = encoding_named(options.encoding).profile or (options.copy and log.profile)
    return "ros1" if profile == "ros1" else "ros2"


def _look(selection: Selection, style: ArrowStyle, tf_rate: float) -> Look:
    """Return how all that is drawn looks."""
    mark_m = selection.robot.shaft_diameter_m
    shaft_m = mark_m * (ESTIMATED_WIDTH if selection.contact_from else 1.0)
    # At a low rate, support lasts until the next message.
    lifetime_s = max(LIFETIME_S, 2.0 / tf_rate if tf_rate else 0.0)
    return Look(style.shaft_diameter_m or shaft_m, style.lifetime_s, mark_m, lifetime_s)


def _placed_samples(
    frames: WorldFrames | None, walk: Walk
) -> tuple[tuple[Samples, ...], tuple[Finding, ...]]:
    """Return the samples of all feet; those without contact points are where their frames are."""
    feet = walk.recording.feet
    points = tuple(p and (None if p.recorded else p) for p in frames.points) if frames else ()
    if frames is None or not any(points):
        return feet, ()
    # Forces are in the world already, as far as they can be turned.
    frames = frames._replace(points=points, links=(None,) * len(points))
    samples, counts = frames.place(feet)
    return samples, tuple(transform_findings(counts))


def _feet(samples: Sequence[Samples], walk: Walk) -> Iterator[DrawnFoot]:
    settings = walk.settings
    for number, (each, foot) in enumerate(zip(samples, walk.feet, strict=True)):
        yield drawn_foot(
            number,
            replace(each, in_world=each.in_world | settings.force_in_world),
            foot.record,
            contact_known=walk.metrics.feet[foot.name].contact_fraction is not None,
            has_force=settings.feet[number].has_force,
        )


def _opened(poses: Odometry, opening: int) -> Odometry:
    """Let the first pose stand at the log's first time if it follows at once."""
    near = slice(0, int((poses.log_time[:1] - opening <= NEAR_NS).any()))
    log_time, stamp = poses.log_time.copy(), poses.stamp.copy()
    log_time[near] = stamp[near] = opening
    return replace(poses, log_time=log_time, stamp=stamp)


def _of_base(poses: Odometry) -> TransformMessages:
    """Return the transforms of the base."""
    place = poses.position[:, None], poses.orientation[:, None]
    return TransformMessages(poses.log_time, poses.time, *place)
