"""Checks of what corrections found: names of frames, the frame of the wrenches, transforms."""

from collections.abc import Iterator
from math import atan, degrees

from dogbot_logtool.core.frames.wrench_frame import FrameFit, WrenchFrame, WrenchFrameEvidence
from dogbot_logtool.core.known_frames import Counts, WorldFrames
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found


def frames_known(walk: Walk) -> Iterator[Finding]:
    """Yield what is odd in the names of frames, and which frame the wrenches are in."""
    yield from name_findings(walk.recording)
    settings, seen = walk.settings, walk.frames.wrench_frame
    if not settings.contact_from and any(foot.has_force for foot in settings.feet):
        cases = ("unknown",) if seen.frame is WrenchFrame.UNKNOWN else ()
        yield found("WRENCH_FRAME", *cases, say=seen.frame, evidence=_evidence(seen))


def columns_corrected(walk: Walk) -> Iterator[Finding]:
    """Yield what was left out, what transforms did not tell, and which plan is apart."""
    if walk.recording.implausible:
        yield found("NOT_FINITE", say="implausible", count=walk.recording.implausible)
    if walk.corrected.turned is not None:
        yield from transform_findings(*walk.corrected.turned)
    if walk.plan_apart:
        yield found("PLANNED", "not_compared", plan=walk.plan_apart)


def zero_stamps(recording: Recording, settings: WalkSettings) -> frozenset[str]:
    """Return the topics of feet and base whose header stamps are all zero."""
    used = {*(foot.topic for foot in settings.feet), settings.odometry_topic}
    stamps = {topic: times.stamp for topic, times in recording.topics.items() if topic in used}
    return frozenset(
        topic for topic, stamp in stamps.items() if stamp is not None and not stamp.any()
    )


def stamp_findings(recording: Recording, settings: WalkSettings) -> Iterator[Finding]:
    """Yield which topics have no header stamps."""
    if zeros := zero_stamps(recording, settings):
        used = {foot.topic for foot in settings.feet} | {settings.odometry_topic or min(zeros)}
        topics = "everywhere" if zeros >= used else "on " + ", ".join(sorted(zeros))
        yield found("BAD_STAMPS", say="zero", topics=topics)


def name_findings(recording: Recording) -> Iterator[Finding]:
    """Yield what is odd in the names of frames; no viewer of today accepts a slash."""
    names = [*recording.world_frames, *recording.base_frames]
    slashed = [each for each in {*names, *recording.slashed_frames} if each.startswith("/")]
    if slashed:
        yield found("FRAME_NAMES", say="slashed", names=", ".join(sorted(slashed)))
    if len(recording.world_frames) > 1 or len(recording.base_frames) > 1:
        yield found("FRAME_NAMES", say="several", names=", ".join(names))


def _evidence(seen: WrenchFrameEvidence) -> str:
    """Return the numbers that decided the frame of the wrenches, in words."""
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


def transform_findings(frames: WorldFrames, counts: Counts) -> Iterator[Finding]:
    """Yield how often the frames told what was asked of them."""
    points, (turned, placed) = [point for point in frames.points if point], counts
    for wanted, (done, left), what in (
        (any(frames.links), turned, "forces"),
        (any(point.recorded for point in points), placed, "positions"),
        (not all(point.recorded for point in points), placed, "origins"),
    ):
        if wanted:
            cases = ("none",) if not left else ("forces",) if what == "forces" else ()
            missing = f"; transforms were missing for {left:,}" if left else ""
            yield found("TRANSFORMS_MISSING", *cases, say=what, done=done, missing=missing)
