"""Findings of the probe: stamps, frames, and the frame of the wrenches."""

from collections.abc import Iterator
from math import atan, degrees

from dogbot_logtool.core.frames.wrench_frame import FrameFit, WrenchFrame, WrenchFrameEvidence
from dogbot_logtool.finding import Finding
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.probe import Probe
from dogbot_logtool.robot.topics.selection import Selection


def probe_findings(selection: Selection, probe: Probe) -> list[Finding]:
    """Return them, in the order in which they are printed."""
    findings = [*stamp_findings(selection, probe), *name_findings(probe)]
    feet = range(len(selection.robot.feet))
    if any(selection.sources_of(foot) and selection.knows_force(foot) for foot in feet):
        findings.append(_wrench_frame_finding(probe))
    return findings


def stamp_findings(selection: Selection, probe: Probe) -> Iterator[Finding]:
    """Say which topics have no header stamps."""
    if probe.zero_stamps:
        used = {c.topic for c in (*selection.odometry, *selection.contacts)}
        everywhere = probe.zero_stamps >= used
        topics = "everywhere" if everywhere else "on " + ", ".join(sorted(probe.zero_stamps))
        text = f"header stamps are zero {topics}: log time is used instead"
        yield Finding("BAD_STAMPS", text)


def name_findings(probe: Probe) -> Iterator[Finding]:
    """Say what is odd in the names of frames."""
    if probe.slashed_frames:
        frames = ", ".join(probe.slashed_frames)
        text = f"frame ids begin with a slash, which viewers of today do not accept: {frames}"
        yield Finding("FRAME_NAMES", text)
    if len(probe.world_frames) > 1 or len(probe.base_frames) > 1:
        frames = ", ".join((*probe.world_frames, *probe.base_frames))
        yield Finding("FRAME_NAMES", f"the odometry names several frames: {frames}")


def order_findings(log: Log, out_of_order: int) -> Iterator[Finding]:
    """Say that messages were sorted.

    Args:
        log: the log.
        out_of_order: messages that stood behind later ones of their channel, in a batch.
    """
    if log.is_reordered or out_of_order:
        count = f": {out_of_order:,} go back" if out_of_order else ""
        text = f"messages stand out of order in the file{count}; they are read by their log times"
        yield Finding("OUT_OF_ORDER", text)


def _wrench_frame_finding(probe: Probe) -> Finding:
    seen = probe.wrench_frame
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
