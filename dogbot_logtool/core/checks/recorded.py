"""Checks of clocks and topics, of frames, of commands and of the accelerometer."""

from collections.abc import Iterator
from math import atan, degrees
from typing import Final

import numpy as np

from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame, WrenchFrameEvidence
from dogbot_logtool.core.known_frames import Counts
from dogbot_logtool.core.loads import WEIGHT_TOLERANCE
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

FAR_S: Final = 10.0
"""s: stamps further from log time are on another clock, not only delayed."""
OTHER_SPEED_PPM: Final = 1e4
"""Millionths by which a clock may run faster or slower than log time."""
_ODD_TIMES: Final = (
    ("BAD_STAMPS", "zero_stamps", "with a zero header stamp"),
    ("BAD_STAMPS", "stamps_ahead", "with a header stamp later than those that follow"),
    ("BAD_STAMPS", "backward_stamps", "with a header stamp that goes backwards"),
    ("BAD_STAMPS", "duplicate_stamps", "with the header stamp of the one before"),
    ("OUT_OF_ORDER", "backward_log_times", "logged out of order"),
    ("OUT_OF_ORDER", "duplicate_log_times", "with the log time of the one before"),
)
"""Code, count among a topic's timing, and what is counted."""


def clock_set(walk: Walk) -> Iterator[Finding]:
    """Yield why stamps are not used, and where the clock was set."""
    settings, where = walk.settings, "settings.time_source"
    if settings.time_source_reason:
        yield found("LOG_TIME_USED", where=where, why=settings.time_source_reason)
    on_log_time = settings.clock is TimeSource.LOG
    steps = {step: each.topic for each in walk.corrected.topics for step in each.clock_steps}
    for step, topic in steps.items():
        at = f" at {walk.seconds(np.array([step.after]))[0]:.2f} s" if on_log_time else ""
        way, seconds = "back" if step.by_ns < 0 else "forward", abs(step.by_ns) / 1e9
        yield found("CLOCK_SET", where=where, topic=topic, way=way, seconds=seconds, at=at)


def clocks_differ(walk: Walk) -> Iterator[Finding]:
    """Yield topics whose clocks differ from that of the feet, by stamps or by physics."""
    base_topic, delay = walk.settings.odometry_topic, walk.base_delay
    feet = walk.feet_on_poses
    for each in walk.corrected.clocks:
        if not each.is_apart:
            continue
        case = "base" if each.topic == base_topic else "feet"
        case = case if each.topic in walk.clocks_apart else "little"
        seconds, way = abs(each.behind_s), "behind" if each.behind_s > 0.0 else "ahead of"
        words: Words = {"topic": each.topic, "seconds": seconds, "way": way}
        yield found("CLOCK_OFFSET", case, feet=feet, clock=each, **words)
    if delay is not None:
        seconds, way = abs(delay.delay_s), "after" if delay.delay_s > 0.0 else "before"
        words = {"topic": base_topic, "seconds": seconds, "way": way}
        yield found("CLOCK_OFFSET", "base", say="heave", feet=feet, delay=delay, **words)


def topics_timed(walk: Walk) -> Iterator[Finding]:
    """Yield what is odd in the timing of topics; commands may pause while no one steers."""
    for each in walk.corrected.topics:
        topic, offset_s, drift_ppm = each.topic, each.clock_offset_s, each.clock_drift_ppm
        if each.gaps and topic != walk.settings.command_topic:
            yield found("GAPS", where=topic, timing=each)
        for code, field, what in _ODD_TIMES:
            if count := getattr(each, field):
                yield found(code, topic=topic, count=count, messages=each.messages, what=what)
        if offset_s is not None and abs(offset_s) > FAR_S:
            way, seconds = "before" if offset_s > 0.0 else "after", abs(offset_s)
            yield found("CLOCK_OFFSET", "little", say="far", topic=topic, seconds=seconds, way=way)
        if drift_ppm is not None and abs(drift_ppm) > OTHER_SPEED_PPM:
            rate = 1.0 / (1.0 + drift_ppm / 1e6)
            yield found("CLOCK_OFFSET", "little", say="speed", topic=topic, rate=rate)


TILTED_DEG: Final = 5.0
"""A mounting that is less off is as good as mountings are."""
_NAMES: Final = {"forward": "forward speed", "lateral": "sideways speed", "yaw": "yaw rate"}


def refused(walk: Walk) -> Iterator[Finding]:
    """Yield messages of commands or of the accelerometer that are left out for their numbers."""
    for case, each in (("commands", walk.corrected.commands), ("imu", walk.corrected.inertial)):
        if each is not None and each.refused:
            yield found("NOT_FINITE", case, where=each.topic, say="beside", beside=each)


def followed(walk: Walk) -> Iterator[Finding]:
    """Yield what is odd in the commands' axes and times, and where the base does the opposite."""
    track = walk.command_track
    if track is None:
        return
    if not track.axes_known:
        names = ", ".join(track.history.frames)
        frames = f" (their frame is {names})" if names else ""
        yield found("COMMAND_AXES", "unknown", where="commands.axes", frames=frames)
    for axis in track.opposed:
        yield found("COMMAND_AXES", where=f"commands.{axis}", axis=_NAMES[axis])
    if track.history.on_log_time and walk.settings.clock is TimeSource.HEADER:
        where, topic = "commands.on_log_time", track.history.topic
        yield found("LOG_TIME_USED", "no_header", where=where, topic=topic)
    without, timeout = track.no_command_s, track.timeout_ns / 1e9
    if without > timeout:
        where, seconds = "commands.no_command_s", without + track.commanded_s
        yield found("NO_COMMAND", where=where, without=without, seconds=seconds, timeout=timeout)


def mounting(walk: Walk) -> Iterator[Finding]:
    """Yield what the accelerometer reads instead of gravity, and how it is turned."""
    imu = walk.imu
    if imu is None:
        return
    topic, tilt = imu.metrics.topic or "", np.degrees(imu.metrics.tilt_rad or 0.0)
    if imu.reading != "m/s^2":
        cases = ("undecided",) if imu.reading in {"nothing", "unclear"} else ()
        yield found("IMU_READS", *cases, where=topic, say=imu.reading, imu=imu)
    if tilt > TILTED_DEG:
        yield found("IMU_TURNED", where="imu.tilt_rad", topic=topic, tilt=tilt)


def forces(walk: Walk) -> Iterator[Finding]:
    """Yield that sensors' forces are not what the accelerometer and the poses say."""
    imu = walk.imu
    ratio = imu.metrics.forces_over_accelerometer if imu else None
    if imu is None or ratio is None or walk.settings.contact_from:
        return
    if abs(ratio - 1.0) <= WEIGHT_TOLERANCE:
        return
    code, case = "IMPULSE_IS_NOT_WEIGHT", "accelerometer"
    if imu.odd_foot is None:
        yield found(code, case, where="imu.forces_over_accelerometer", say=case, ratio=ratio)
    else:
        row, factor = imu.odd_foot
        feet, share = (walk.feet[row].name,), 1.0 / factor
        yield found(code, "foot", say="foot", feet=feet, ratio=ratio, share=share)


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
    yield from transform_findings(walk.corrected.turned)
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
    fits = {"as recorded": seen.world, "turned from the links' frames": seen.link}
    told = [
        f"{how}, {fit.in_cone:.0%} of the load lies within the friction cone and its sum leans "
        f"{degrees(atan(fit.net_tilt)):.0f} degrees from the vertical"
        for how, fit in fits.items()
        if fit is not None
    ]
    return f"{'; '.join(told)}; {seen.world.samples} samples"


FEW: Final = 0.005
"""Share of messages that may lack transforms: those before the first pose, say."""


def transform_findings(counts: Counts) -> Iterator[Finding]:
    """Yield how often the frames told what was asked of them."""
    for what, (done, left) in counts.items():
        few = left <= FEW * done
        cases = ("few",) if few else ("forces",) if what == "forces" else ()
        missing = f"; transforms were missing for {left:,}" if left else ""
        yield found("TRANSFORMS_MISSING", *cases, say=what, done=done, missing=missing)
