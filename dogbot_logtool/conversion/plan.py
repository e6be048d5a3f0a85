"""The plan of `convert` for a log, made before the first annotation is written."""

from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.conversion.findings import arrow_findings, copy_findings, no_support, second_tf
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import WorldFrames
from dogbot_logtool.core.scene.arrows import ArrowScale, arrow_scale
from dogbot_logtool.core.scene.styles import ARROW_STYLES, LIFETIME_S, ArrowStyle
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.measuring.legs import sensor_points
from dogbot_logtool.robot.recorded import time_limits
from dogbot_logtool.robot.robot_model.description import RobotDescription, robot_description
from dogbot_logtool.robot.robot_model.urdf import RobotOfUrdf
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.writer.annotations import WantedAnnotations
from dogbot_logtool.writer.encodings.registry import encoding_named
from dogbot_logtool.writer.markers import Look

ESTIMATED_WIDTH: Final = 0.5
"""Width of arrows whose forces are estimated, over that of measured ones."""


@dataclass(frozen=True, slots=True)
class ConversionPlan:
    """The plan of `convert` for one log."""

    selection: Selection
    options: ConvertOptions
    style: ArrowStyle
    wanted: WantedAnnotations
    writes_base: bool
    """Whether the base's transforms are written."""
    frames: WorldFrames | None
    """How the links' frames are connected to the world; None: not needed, or not connected."""
    arrow_scale: ArrowScale
    description: RobotDescription
    """Of the robot, with hips only where the lines of `/legs` are drawn."""
    opening: int | None
    """ns, log time of the output's first message; None: the log is empty."""
    end: int
    """ns, of its last."""
    findings: tuple[Finding, ...]


def make_plan(
    log: Log,
    selection: Selection,
    model: RobotOfUrdf | None,
    walk: Walk,
    options: ConvertOptions,
    left_out: frozenset[int],
) -> ConversionPlan:
    """Decide what to do.

    Args:
        log: the log.
        selection: its topics.
        model: the robot's description, where joint states move it.
        walk: what was measured.
        options: what the user asks for.
        left_out: ids of the channels that are not copied.

    Raises:
        CallError: the log has no such time; the file of the robot cannot be read.
    """
    style, settings, frames = ARROW_STYLES[options.style], walk.settings, walk.frames
    given = selection.robot.newtons_per_metre
    weight_n = settings.body_weight_n or settings.estimated_weight_n
    turns = settings.wrench_frame is WrenchFrame.LINK
    links = frames.links if turns else (None,) * len(settings.feet)
    placed = frames.follow(links, sensor_points(selection, frames, settings))
    unsupported = no_support(selection)
    second = second_tf(selection, frames, options, left_out) if options.tf == "auto" else None
    description = robot_description(log, selection, model, walk, options)
    description = replace(
        description,
        hips=None if unsupported else description.hips,
        joints=description.joints if options.tf != "never" else (),
    )
    writes_base = selection.has_base and options.tf != "never" and second is None
    pairs = [(joint.parent, joint.child) for joint in description.joints]
    profile = encoding_named(options.encoding).profile or (options.copy and log.profile)
    # A scale of the robot's file has colours of its own.
    colour_n = weight_n if given is None else settings.body_weight_n
    start, end = time_limits(log, options.start, options.end)
    last = log.end_time or 0
    return ConversionPlan(
        selection=selection,
        options=options,
        style=style,
        wanted=WantedAnnotations(
            [foot.name for foot in selection.robot.feet],
            frames.world,
            frames.base,
            _look(selection, style, options.tf_rate),
            links=pairs,
            has_transforms=writes_base or bool(pairs),
            has_support=unsupported is None,
            has_legs=description.hips is not None,
            description="" if description.urdf is None else "ros1" if profile == "ros1" else "ros2",
        ),
        writes_base=writes_base,
        frames=placed,
        arrow_scale=arrow_scale(given, colour_n, description.height_m, by_weight=style.along_force),
        description=description,
        opening=log.start_time if start is None else start,
        end=last if end is None else min(end, last),
        findings=(
            *([unsupported] if unsupported else []),
            *arrow_findings(selection, style, placed, settings, colour_n),
            *copy_findings(log, options, left_out),
            *description.findings,
            *([second] if second else []),
        ),
    )


def _look(selection: Selection, style: ArrowStyle, tf_rate: float) -> Look:
    """Return how all that is drawn looks."""
    mark_m = selection.robot.shaft_diameter_m
    shaft_m = mark_m * (ESTIMATED_WIDTH if selection.contact_from else 1.0)
    # At a low rate, support lasts until the next message.
    lifetime_s = max(LIFETIME_S, 2.0 / tf_rate if tf_rate else 0.0)
    return Look(style.shaft_diameter_m or shaft_m, style.lifetime_s, mark_m, lifetime_s)
