"""What `convert` will do with a log, decided before the first message is written."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.core.contact.foot_tracker import Hearing
from dogbot_logtool.core.contact.footfall import contact_rule
from dogbot_logtool.core.contact.silent_swing import MISSED_INTERVALS
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.load.loads import body_weight_n
from dogbot_logtool.core.scene.arrows import CLASSIC_DIAMETER_M, LIFETIME_S
from dogbot_logtool.errors import LogError
from dogbot_logtool.finding import Finding, by_severity, note, warning
from dogbot_logtool.pipeline.batches import BatchReader
from dogbot_logtool.pipeline.options import ConvertOptions, Style
from dogbot_logtool.pipeline.probe import Evidence, evidence_findings, frame_names
from dogbot_logtool.pipeline.selection import Selection, nothing_to_do
from dogbot_logtool.pipeline.time_span import TimeLimits, time_limits
from dogbot_logtool.pipeline.world_frames import WorldFrames, follow_frames
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.writer.encodings.encoding import ArrowStyle, SupportStyle

_MOST_FEET: Final = 16
"""Feet of which support is drawn: the work grows with the cube of their number."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Decisions."""

    selection: Selection
    options: ConvertOptions
    world_frame: str
    base_frame: str
    write_tf: bool
    force_in_world: bool
    """Whether wrenches are recorded in the world frame."""
    frames: WorldFrames | None
    """How links' frames hang in the world; None: not needed, or not connected."""
    body_weight_n: float | None
    arrow_style: ArrowStyle
    support_style: SupportStyle
    hearings: tuple[Hearing, ...]
    """How to understand each foot where support is drawn; empty where it is not."""
    swing_intervals: Mapping[int, int]
    """ns between messages in contact, by foot, of the feet that are silent in swing."""
    swings_from: int | None
    """ns, log time from which a foot that was not heard yet may be said to swing; None: none."""
    start_time: int | None
    """ns, log time from which on messages are taken; None: all; also `end_time`."""
    end_time: int | None
    findings: tuple[Finding, ...]

    @property
    def limits(self) -> TimeLimits:
        """Log times of the messages that are taken."""
        return self.start_time, self.end_time

    @property
    def reader(self) -> BatchReader:
        """What reads the log's batches."""
        # Only arrows along the force may have to stand along a normal instead.
        feet = replace(self.selection.foot_channels(), normals=self.options.style == "force")
        return BatchReader(
            self.selection,
            feet,
            self.frames,
            self.limits,
            reads_transforms=self.base_may_have_parent,
        )

    @property
    def base_may_have_parent(self) -> bool:
        """Whether transforms that are copied may yet turn out to place the base, against ours."""
        return self.write_tf and self.options.copy and self.options.tf != "always"


def make_plan(log: Log, selection: Selection, evidence: Evidence, options: ConvertOptions) -> Plan:
    """Decide what to do.

    Raises:
        LogError: the log has neither odometry nor contacts.
        CallError: the log has no such time as is asked for.
    """
    if not selection.odometry and not selection.contacts:
        raise LogError(nothing_to_do(log, selection))
    robot = selection.robot
    findings = [*selection.findings, *evidence_findings(selection, evidence)]
    world, base = frame_names(robot, evidence)
    wrench_frame = _wrench_frame(evidence, options)
    hearings = _hearings(selection, evidence, options, findings)
    frames = follow_frames(
        selection,
        evidence,
        world,
        base,
        _clock(selection, evidence),
        # The centre of pressure of a support needs vertical forces too.
        turn_forces=wrench_frame is WrenchFrame.LINK
        and (options.style == "force" or bool(hearings)),
        place_sensors=options.style != "classic",
    )
    findings.extend(_without_points(selection, frames))
    if options.style == "force" and wrench_frame is not WrenchFrame.WORLD:
        findings.extend(_magnitude_only(selection, frames))
    weight = body_weight_n(robot.mass_kg)
    if options.style == "force" and weight is None:
        text = "the robot's mass is not known: arrows are coloured by newtons (--mass tells it)"
        findings.append(note("NO_MASS", text))
    if options.style == "classic":
        findings.extend(_without_classic(selection))
    start_time, end_time = time_limits(log, options.start_s, options.end_s)
    return Plan(
        selection=selection,
        options=options,
        world_frame=world,
        base_frame=base,
        write_tf=_write_tf(selection, evidence, options, (world, base), findings),
        force_in_world=wrench_frame is WrenchFrame.WORLD,
        frames=frames,
        body_weight_n=weight,
        arrow_style=_arrow_style(options.style, robot.shaft_diameter_m),
        support_style=_support_style(robot.shaft_diameter_m, options.tf_rate_hz),
        hearings=hearings,
        swing_intervals=evidence.intervals,
        swings_from=log.start_time if start_time is None else None,
        start_time=start_time,
        end_time=end_time,
        findings=tuple(sorted(findings, key=by_severity)),
    )


def without_tf(plan: Plan, parent: str) -> Plan:
    """Return the plan for a log whose own transforms turn out to place the base."""
    finding = _second_parent(plan.base_frame, [parent])
    return replace(
        plan, write_tf=False, findings=tuple(sorted((*plan.findings, finding), key=by_severity))
    )


def _wrench_frame(evidence: Evidence, options: ConvertOptions) -> WrenchFrame:
    """Return the frame of the recorded wrenches: what the user says, else what was seen."""
    if options.wrench_frame == "auto":
        return evidence.wrench_frame.frame
    return WrenchFrame(options.wrench_frame)


def _clock(selection: Selection, evidence: Evidence) -> TimeSource:
    """Return the clock of samples and transforms: header stamps, where all have them."""
    all_stamped = all(source.has_header for source in selection.sources)
    return TimeSource.HEADER if all_stamped and not evidence.zero_stamps else TimeSource.LOG


def _without_points(selection: Selection, frames: WorldFrames | None) -> Iterator[Finding]:
    """Say where the arrows of sensors stand that tell a force but no contact point."""
    places = frames.points if frames else (None,) * len(selection.robot.feet)
    at_frames: list[str] = []
    nowhere: list[str] = []
    for number, (foot, place) in enumerate(zip(selection.robot.feet, places, strict=True)):
        sources = selection.sources_of(number)
        if place is not None:
            at_frames.append(f"{foot.name} at {place.frame}")
        elif selection.knows_force(number) and any(not source.has_points for source in sources):
            nowhere.append(foot.name)
    if at_frames:
        text = f"sensors tell no contact points: arrows stand at frames, {', '.join(at_frames)}"
        yield note("FEET_AT_FRAMES", text)
    if nowhere:
        text = (
            f"neither a contact point nor a frame of {', '.join(nowhere)} is known: loads are "
            "written, but no arrows are drawn (`frame` in the robot's file names one)"
        )
        yield note("NO_POINTS", text)


def _magnitude_only(selection: Selection, frames: WorldFrames | None) -> Iterator[Finding]:
    """Say of which feet only the magnitude of the force is known, so far as that is sure."""
    feet = selection.robot.feet
    links = frames.links if frames else (None,) * len(feet)
    lacking = [foot.name for foot, link in zip(feet, links, strict=True) if link is None]
    if lacking:
        whose = "" if len(lacking) == len(feet) else f" of {', '.join(lacking)}"
        text = (
            f"only the magnitude of forces{whose} is known: arrows stand along the contact normals"
        )
        yield warning("MAGNITUDE_ONLY", text)


def _without_classic(selection: Selection) -> list[Finding]:
    return [
        warning("NO_CLASSIC", f"{source.type_name} has no contact states: nothing classic to draw")
        for source in selection.sources
        if source.has_force and not source.has_points
    ]


def _write_tf(
    selection: Selection,
    evidence: Evidence,
    options: ConvertOptions,
    frames: tuple[str, str],
    findings: list[Finding],
) -> bool:
    if not selection.odometry or options.tf == "never":
        return False
    world, base = frames
    # The same transform once more does no harm; only another parent breaks the tree.
    others = evidence.parents.get(base, frozenset()) - {world}
    if others and options.copy and options.tf == "auto":
        findings.append(_second_parent(base, sorted(others)))
        return False
    return True


def _second_parent(base: str, parents: list[str]) -> Finding:
    text = (
        f"the log's own transforms place {base} in {', '.join(parents)}; a second parent would "
        "break the tree, so none is written (--tf always does)"
    )
    return warning("TF_HAS_PARENT", text)


def _arrow_style(style: Style, shaft_diameter_m: float) -> ArrowStyle:
    if style == "classic":
        return ArrowStyle(CLASSIC_DIAMETER_M, lifetime_s=0.0)
    return ArrowStyle(shaft_diameter_m, LIFETIME_S)


def _support_style(shaft_diameter_m: float, tf_rate_hz: float) -> SupportStyle:
    return SupportStyle(
        line_m=shaft_diameter_m / 2.0,
        mark_m=shaft_diameter_m,
        # What is drawn anew at a low rate must last until then.
        lifetime_s=max(LIFETIME_S, 2.0 / tf_rate_hz if tf_rate_hz else 0.0),
    )


def _hearings(
    selection: Selection,
    evidence: Evidence,
    options: ConvertOptions,
    findings: list[Finding],
) -> tuple[Hearing, ...]:
    """Return how to understand each foot; nothing where support is not drawn, with a reason."""
    wanted = options.style != "classic" if options.scene is None else options.scene
    if not wanted:
        return ()
    robot = selection.robot
    why_not = ""
    if not selection.odometry:
        why_not = "the log has no odometry"
    elif not any(source.has_points for source in selection.sources):
        why_not = "the log has no contact points"
    elif len(robot.feet) > _MOST_FEET:
        why_not = f"{len(robot.feet)} feet are more than {_MOST_FEET}"
    if why_not:
        findings.append(note("NO_SUPPORT", f"there is no /support: {why_not}"))
        return ()
    idle = [foot.name for number, foot in enumerate(robot.feet) if number not in evidence.touching]
    if idle:
        text = f"/support has no polygon until these feet touch, which were not seen to: {idle[0]}"
        findings.append(note("NOT_SEEN_TOUCHING", ", ".join([text, *idle[1:]])))
    weight = body_weight_n(robot.mass_kg)
    rule = contact_rule(robot.contact_on_n, robot.contact_off_n, robot.debounce_s, weight)
    return tuple(
        Hearing(
            rule,
            round(MISSED_INTERVALS * evidence.intervals[foot])
            if foot in evidence.intervals
            else None,
            works=foot in evidence.touching,
        )
        for foot in range(len(robot.feet))
    )
