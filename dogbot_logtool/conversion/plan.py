"""The plan of `convert` for a log, made before the first message is written."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.conversion.copying import channels_left_out, copy_findings
from dogbot_logtool.core.checks.frames import stamp_findings
from dogbot_logtool.core.checks.sensors import sensor_findings
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.scene.arrows import ArrowScale, arrow_scale
from dogbot_logtool.core.scene.styles import ARROW_STYLES, ArrowStyle
from dogbot_logtool.core.settings import WalkSettings, body_weight_n
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.world_frames import WorldFrames
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.robot.places import sensor_points
from dogbot_logtool.robot.robot_model.description import RobotDescription, robot_description
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.time_span import time_limits
from dogbot_logtool.writer.encodings.registry import ENCODINGS, OutputEncoding

_MOST_FEET: Final = 16
"""Feet for which support is drawn: the work grows with the cube of their number."""


@dataclass(frozen=True, slots=True)
class ConversionPlan:
    """The plan of `convert` for one log."""

    selection: Selection
    options: ConvertOptions
    style: ArrowStyle
    encoding: OutputEncoding
    world_frame: str
    base_frame: str
    write_tf: bool
    frames: WorldFrames | None
    """How the links' frames are connected to the world; None: not needed, or not connected."""
    body_weight_n: float | None
    arrow_scale: ArrowScale
    draws_support: bool
    """Whether `/support` is written."""
    description: RobotDescription
    """Of the robot, with hips only where the lines of `/legs` are drawn."""
    opening: int | None
    """ns, log time of the output's first message; None: the log is empty."""
    findings: tuple[Finding, ...]
    left_out: frozenset[int] = frozenset()
    """Ids of the channels that are not copied."""


def make_plan(
    log: Log, selection: Selection, walk: Walk, options: ConvertOptions
) -> ConversionPlan:
    """Decide what to do.

    Args:
        log: the log.
        selection: its topics.
        walk: what was measured.
        options: what the user asks for.

    Raises:
        CallError: the log has no such time; the file of the robot cannot be read.
    """
    style, encoding = ARROW_STYLES[options.style], ENCODINGS[options.encoding]
    robot, settings, frames = selection.robot, walk.settings, walk.frames
    findings = [*selection.findings, *stamp_findings(walk.recording, settings)]
    known_weight_n = body_weight_n(robot.mass_kg)
    weight_n = known_weight_n or settings.estimated_weight_n
    sensors = [settings.sensor(row) for row in range(len(robot.feet))]
    findings.extend(sensor_findings([foot.name for foot in robot.feet], sensors, weight_n))
    draws_support = _can_draw_support(selection, walk, findings)
    turns = settings.wrench_frame is WrenchFrame.LINK
    links = frames.links if turns else (None,) * len(robot.feet)
    placed = frames.follow(settings, links, sensor_points(selection, frames, settings))
    # A scale of the robot's file has colours of its own.
    scale_n = known_weight_n if robot.newtons_per_metre is not None else weight_n
    findings.extend(_arrow_findings(selection, style, placed, settings, scale_n))
    left_out = channels_left_out(log, options)
    findings.extend(copy_findings(log, options, left_out))
    start_time, _ = time_limits(log, options.start, options.end)
    base = frames.base
    description = robot_description(log, selection, frames, base, options.urdf, copy=options.copy)
    findings.extend(description.findings)
    return ConversionPlan(
        selection=selection,
        options=options,
        style=style,
        encoding=encoding,
        world_frame=frames.world,
        base_frame=base,
        write_tf=writes_tf(selection, frames, options, left_out, findings),
        frames=placed,
        body_weight_n=known_weight_n,
        arrow_scale=arrow_scale(robot.newtons_per_metre, weight_n, description.height_m),
        draws_support=draws_support,
        description=replace(
            description,
            hips=description.hips if draws_support else None,
            motion=description.motion if options.tf != "never" else None,
        ),
        opening=log.start_time if start_time is None else start_time,
        findings=tuple(dict.fromkeys(findings)),
        left_out=left_out,
    )


def _arrow_findings(
    selection: Selection,
    style: ArrowStyle,
    frames: WorldFrames | None,
    settings: WalkSettings,
    weight_n: float | None,
) -> Iterator[Finding]:
    """Yield findings about what arrows of a style lack.

    Args:
        selection: topics of the feet.
        style: of the arrows.
        frames: how links hang in the world.
        settings: of the walk.
        weight_n: N, by which arrows may be coloured; None: not known.
    """
    yield from _without_points(selection, frames, settings)
    if style.along_force and not settings.force_in_world:
        yield from _magnitude_only(selection, frames)
    if style.along_force and not weight_n:
        text = "the robot's mass is unknown: arrows are coloured by newtons (give it with --mass)"
        yield Finding("MASS_UNKNOWN", text)
    if style.needs_contact_states:
        yield from _without_states(selection, style)


def refuse_unknown_names(options: ConvertOptions) -> None:
    """Refuse a style or an encoding that there is not.

    Raises:
        CallError: there is no such one.
    """
    for kind, name, known in (
        ("arrow style", options.style, [*ARROW_STYLES]),
        ("encoding", options.encoding, [*ENCODINGS]),
    ):
        if name not in known:
            raise CallError(f"there is no {kind} {name!r}; known: {', '.join(known)}")


def _without_points(
    selection: Selection, frames: WorldFrames | None, settings: WalkSettings
) -> Iterator[Finding]:
    """Yield findings about sensors with forces but without contact points."""
    points = frames.points if frames else (None,) * len(selection.robot.feet)
    at_frames: list[str] = []
    nowhere: list[str] = []
    for number, (foot, point) in enumerate(zip(selection.robot.feet, points, strict=True)):
        sources = selection.sources_of(number)
        if point is not None and point.recorded:
            continue
        if point is not None:
            at_frames.append(f"{foot.name} at {point.frame}")
        elif settings.feet[number].has_force and any(
            source.in_base or not source.has_points for source in sources
        ):
            nowhere.append(foot.name)
    if at_frames:
        text = f"sensors without contact points: arrows start at frames, {', '.join(at_frames)}"
        yield Finding("TRANSFORMS_MISSING", text, cases=("none",))
    if nowhere:
        text = (
            f"no contact point and no frame known for {', '.join(nowhere)}: loads are written, "
            "but no arrows (set `frame` in the robot's file)"
        )
        yield Finding("NOT_DRAWN", text, cases=("no_points",))


def _magnitude_only(selection: Selection, frames: WorldFrames | None) -> Iterator[Finding]:
    """Yield a finding about feet of which only the magnitude of the force is known."""
    feet = selection.robot.feet
    links = frames.links if frames else (None,) * len(feet)
    lacking = [foot.name for foot, link in zip(feet, links, strict=True) if link is None]
    if lacking:
        whose = "" if len(lacking) == len(feet) else f" of {', '.join(lacking)}"
        text = (
            f"only the magnitude of forces{whose} is known: arrows point along the contact normals"
        )
        yield Finding("NOT_DRAWN", text)


def _without_states(selection: Selection, style: ArrowStyle) -> list[Finding]:
    return [
        Finding("NOT_DRAWN", f"{source.row.name} has no contact states: no {style.name} arrows")
        for source in selection.sources
        if source.has_force and not source.has_points
    ]


def writes_tf(
    selection: Selection,
    frames: KnownFrames,
    options: ConvertOptions,
    left_out: frozenset[int],
    findings: list[Finding],
) -> bool:
    """Tell whether `/tf` is written; a finding says why not."""
    if not selection.has_base or options.tf == "never":
        return False
    world, base = frames.world, frames.base
    may_repeat = options.tf == "always"
    from_transforms = selection.base is not None and selection.base.source.is_transform
    if from_transforms and not may_repeat and _copies(selection.odometry, options, left_out):
        text = f"the log's own transforms place {base} in {world}: /tf is not written again"
        findings.append(Finding("TF_NOT_WRITTEN", text))
        return False
    # The same transform twice is harmless; only another parent breaks the tree.
    others = frames.parents.get(base, frozenset()) - {world}
    if others and not may_repeat and _copies(selection.transforms, options, left_out):
        findings.append(_second_parent(base, sorted(others)))
        return False
    return True


def _copies(channels: Iterable[Channel], options: ConvertOptions, left_out: frozenset[int]) -> bool:
    """Tell whether the output has recorded messages of some channels."""
    return options.copy and any(channel.id not in left_out for channel in channels)


def _second_parent(base: str, parents: list[str]) -> Finding:
    text = (
        f"the log's own transforms already give {base} a parent ({', '.join(parents)}): /tf is not "
        "written, since a second one would break the tree (--tf always writes it)"
    )
    return Finding("TF_NOT_WRITTEN", text, cases=("other_parent",))


def _can_draw_support(selection: Selection, walk: Walk, findings: list[Finding]) -> bool:
    """Tell whether the log has what support needs; a finding says what it lacks."""
    robot = selection.robot
    why_not = ""
    if not selection.has_base:
        why_not = "the log has no odometry"
    elif not selection.has_points:
        why_not = "the log has no contact points"
    elif len(robot.feet) > _MOST_FEET:
        why_not = f"the robot has {len(robot.feet)} feet, more than {_MOST_FEET}"
    if why_not:
        findings.append(Finding("NO_SUPPORT_DRAWN", f"/support is not written: {why_not}"))
        return False
    pairs = zip(robot.feet, walk.recording.feet, strict=True)
    idle = [foot.name for foot, samples in pairs if not samples.in_contact.any()]
    if idle:
        text = f"no contact was seen of {', '.join(idle)}: /support has no polygon"
        findings.append(Finding("NO_SUPPORT_DRAWN", text))
    return True
