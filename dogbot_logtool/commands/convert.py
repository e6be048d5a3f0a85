"""`dogbot-logtool convert`: write an annotated MCAP of a log."""

from collections import Counter
from functools import partial

from dogbot_logtool.commands.stats import MeasuredLog, measure_planned
from dogbot_logtool.conversion.annotated_log import AnnotatedLog, channels_left_out, copied_chunks
from dogbot_logtool.conversion.findings import copy_findings, count_findings
from dogbot_logtool.conversion.scene import Scene, make_scene
from dogbot_logtool.core.base.poses import usable_poses
from dogbot_logtool.core.checks.recorded import columns_corrected, frames_known
from dogbot_logtool.core.scene.arrows import ARROW_STYLES
from dogbot_logtool.finding import Severity, by_severity, found
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import (
    Log,
    damage_of,
    malformed_messages,
    wrong_statistics,
)
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.recording import Alongside
from dogbot_logtool.results import Conversion
from dogbot_logtool.robot.measuring.plan import make_plan as plan_measuring
from dogbot_logtool.robot.recorded import open_recorded
from dogbot_logtool.run.runner import OnProgress


def convert(
    source: Location,
    target: Location,
    options: ConvertOptions,
    progress: OnProgress | None = None,
) -> Conversion:
    """Write the annotated MCAP of a log.

    Args:
        source: a ROS 1 bag, a ROS 2 bag or an MCAP.
        target: the file to write; it appears when it is complete.
        options: what the user asks for.
        progress: called with the bytes done and the bytes in all.

    Raises:
        CallError: no such file, a target that may not be written, a topic or time that the log
            does not have.
        LogError: the log cannot be read, or has nothing to annotate.
        LogtoolError: the target cannot be written.
    """
    refuse_bad_target(target, (source, *options.joined), overwrite=options.overwrite)
    log = open_recorded(source, options.joined)
    try:
        plan = plan_measuring(log, options)
        draws_states = ARROW_STYLES[options.style].needs_contact_states
        plan = plan._replace(wanted=plan.wanted._replace(draws_states=draws_states))
        left_out = channels_left_out(log, options)
        with whole_file(target, overwrite=options.overwrite) as file:
            output = AnnotatedLog(file, log, options, left_out)
            copy = partial(copied_chunks, left_out, options.compression)
            measured = measure_planned(
                log,
                plan,
                options,
                _half(progress, 0),
                alongside=Alongside(copy, output.add) if options.copy else None,
            )
            walk, read = measured.measurement.walk, measured.read
            scene = make_scene(
                log, measured.selection, measured.model, walk, options, left_out, read.arrows
            )
            output.annotate(scene, _half(progress, 1))
            losses = _finish(log, output, measured, scene)
    finally:
        log.close()
    written, added = output.messages, {each.id: each.topic for each in output.added.values()}
    moved = {old: each.topic for old, each in output.added.items() if each.topic != old}
    bad_poses = int((~usable_poses(walk.recording.base)).sum())
    counts = Counter({**output.counts, **read.without_arrows, "bad_poses": bad_poses})
    findings = [
        *measured.known,
        *frames_known(walk),
        *columns_corrected(walk),
        *(each for each in walk.findings if _is_warning(each.code, each.severity)),
        *scene.findings,
        *copy_findings(log, options, left_out),
        *(found("TOPIC_MOVED", where=name, topic=old, name=name) for old, name in moved.items()),
        *count_findings(walk.recording, counts, scene.style),
    ]
    return Conversion(
        source=log.source.path,
        target=target,
        container=log.container,
        robot=scene.selection.robot,
        style=options.style,
        encoding=options.encoding,
        odometry_topics=tuple(sorted({each.topic for each in scene.selection.odometry})),
        world_frame=scene.wanted.world_frame,
        base_frame=scene.wanted.base_frame,
        messages=sum(read.counts.values()),
        copied=sum(count for channel, count in written.items() if channel not in added),
        annotations={topic: written.get(channel, 0) for channel, topic in added.items()},
        counts=counts,
        findings=tuple(sorted(dict.fromkeys(findings), key=by_severity)),
        damage=damage_of(log, losses),
    )


def _half(progress: OnProgress | None, half: int) -> OnProgress | None:
    """Return a callback for one half of the work: to read, and to annotate."""
    if progress is None:
        return None
    return lambda done, total: progress(half * total + done, 2 * total)


def _is_warning(code: str, severity: Severity) -> bool:
    """Tell whether a finding about the walk is shown; what was lost stands in the damage."""
    return code != "LOST" and severity is not Severity.NOTE


def _finish(log: Log, output: AnnotatedLog, measured: MeasuredLog, scene: Scene) -> list[Loss]:
    """Write what follows the messages; return all that could not be read."""
    read, options = measured.read, scene.options
    losses = [*log.losses, *read.losses, *output.copy_extras()]
    if options.start is None and options.end is None:
        losses += wrong_statistics(log, read.counts, losses)
    losses += malformed_messages(log.channels, read.malformed, ": copied, but not annotated")
    output.finish(scene, losses)
    return losses
