"""Checks of what corrections found: names of frames, the frame of the wrenches, transforms."""

from collections.abc import Iterator
from math import atan, degrees

from dogbot_logtool.core.frames.wrench_frame import FrameFit, WrenchFrame, WrenchFrameEvidence
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.world_frames import PlacedCounts, WorldFrames
from dogbot_logtool.finding import Finding


def frames_known(walk: Walk) -> Iterator[Finding]:
    """Say what is odd in the names of frames, and which frame the wrenches are in."""
    yield from name_findings(walk.frames)
    settings = walk.settings
    if not settings.contact_from and any(foot.has_force for foot in settings.feet):
        yield wrench_frame_finding(walk.frames.wrench_frame)


def columns_corrected(walk: Walk) -> Iterator[Finding]:
    """Say what was left out, what transforms did not tell, and which plan is apart."""
    settings = walk.settings
    if zero := [foot.name for foot in settings.feet if foot.forces_are_zero]:
        text = f"all wrenches of {', '.join(zero)} are zero: contacts without forces"
        yield Finding("NO_FORCE", text)
    if walk.recording.implausible:
        yield Finding("NOT_FINITE", f"{walk.recording.implausible:,} {IMPLAUSIBLE}")
    if walk.turned is not None:
        yield from transform_findings(*walk.turned)
    if topic := walk.plan_apart:
        text = f"{topic} is a plan on another clock than the feet: they are not compared"
        yield Finding("PLANNED", text, cases=("not_compared",))


def zero_stamps(recording: Recording, settings: WalkSettings) -> frozenset[str]:
    """Return the topics of feet and base whose header stamps are all zero."""
    used = {*(foot.topic for foot in settings.feet), settings.odometry_topic}
    found = {topic: times.stamp for topic, times in recording.topics.items() if topic in used}
    return frozenset(
        topic for topic, stamp in found.items() if stamp is not None and not stamp.any()
    )


def stamp_findings(recording: Recording, settings: WalkSettings) -> Iterator[Finding]:
    """Say which topics have no header stamps."""
    if zeros := zero_stamps(recording, settings):
        used = {foot.topic for foot in settings.feet} | {settings.odometry_topic or min(zeros)}
        topics = "everywhere" if zeros >= used else "on " + ", ".join(sorted(zeros))
        yield Finding("BAD_STAMPS", f"header stamps are zero {topics}: log time is used instead")


def name_findings(frames: KnownFrames) -> Iterator[Finding]:
    """Say what is odd in the names of frames."""
    if frames.slashed_frames:
        names = ", ".join(frames.slashed_frames)
        text = f"frame ids begin with a slash, which viewers of today do not accept: {names}"
        yield Finding("FRAME_NAMES", text)
    if len(frames.world_frames) > 1 or len(frames.base_frames) > 1:
        names = ", ".join((*frames.world_frames, *frames.base_frames))
        yield Finding("FRAME_NAMES", f"the odometry names several frames: {names}")


def wrench_frame_finding(seen: WrenchFrameEvidence) -> Finding:
    """Say which frame the wrenches are in."""
    if seen.frame is WrenchFrame.UNKNOWN:
        text = (
            f"the frame of the wrenches is not known ({_evidence(seen)}): only magnitudes are "
            "used; --set wrench_frame says which"
        )
        return Finding("WRENCH_FRAME", text, cases=("unknown",))
    if seen.frame is WrenchFrame.WORLD:
        return Finding("WRENCH_FRAME", f"wrenches are in the world frame ({_evidence(seen)})")
    return Finding(
        "WRENCH_FRAME",
        f"wrenches are not in the world frame but in a link's ({_evidence(seen)})",
    )


def _evidence(seen: WrenchFrameEvidence) -> str:
    """Return the numbers that decided the frame, in words."""
    if seen.world is None:
        if seen.frame is WrenchFrame.UNKNOWN:
            return "too few loaded samples with normals were seen"
        return "as their type promises"
    text = f"as recorded, {_fit_text(seen.world)}"
    if seen.link is not None:
        text += f"; turned from the links' frames, {_fit_text(seen.link)}"
    return f"{text}; {seen.samples} samples"


def _fit_text(fit: FrameFit) -> str:
    return (
        f"{fit.in_cone:.0%} of the load lies within the friction cone and its sum leans "
        f"{degrees(atan(fit.net_tilt)):.0f} degrees from the vertical"
    )


def transform_findings(frames: WorldFrames, counts: PlacedCounts) -> Iterator[Finding]:
    """Say how often the frames told what was asked of them."""
    forces = "link-frame forces turned into the world by the log's own transforms"
    recorded = "positions of feet in the base's frame turned into the world"
    origins = "contacts without a point placed at the origins of the feet's frames"
    points = [point for point in frames.points if point]
    for wanted, (done, left), cases, text in (
        (any(frames.links), counts.forces, ("forces",), forces),
        (any(point.recorded for point in points), counts.points, (), recorded),
        (not all(point.recorded for point in points), counts.points, (), origins),
    ):
        if wanted and left:
            missing = f"{text}: {done:,}; transforms were missing for {left:,}"
            yield Finding("TRANSFORMS_MISSING", missing, cases=cases)
        elif wanted:
            yield Finding("TRANSFORMS_MISSING", f"{text}: {done:,}", cases=("none",))
