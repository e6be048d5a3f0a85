"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dogbot_logtool.core import metrics
from dogbot_logtool.core.analysis import analyse
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import (
    Log,
    damage_of,
    malformed_messages,
    wrong_statistics,
)
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.part import TimeLimits
from dogbot_logtool.reader.recording import Alongside, ReadLog, read_recording
from dogbot_logtool.results import Measurement
from dogbot_logtool.robot.measuring.plan import MeasuringPlan, make_plan, prepare
from dogbot_logtool.robot.recorded import open_recorded, refuse_empty_span
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.run.runner import OnProgress

if TYPE_CHECKING:
    from dogbot_logtool.robot.urdf import RobotOfUrdf


def measure(
    path: Location, options: MeasureOptions, progress: OnProgress | None = None
) -> Measurement:
    """Work out all metrics of a log.

    Args:
        path: the log.
        options: what is asked for.
        progress: called with bytes done and bytes in all.

    Raises:
        CallError: no such file, or a topic or time in the options that the log does not have.
        LogError: it is no log, or has nothing to measure.
    """
    log = open_recorded(path, options.joined)
    try:
        measured = measure_log(log, options, progress).measurement
        # Of the samples, only what figures draw is kept.
        corrected = measured.walk.corrected._replace(recording=Recording())
        return replace(measured, walk=replace(measured.walk, corrected=corrected))
    finally:
        log.close()


class MeasuredLog(NamedTuple):
    """A measured log, and what it was measured by."""

    measurement: Measurement
    selection: Selection
    model: "RobotOfUrdf | None"
    """The robot's description, where joint states move it."""
    read: ReadLog
    known: tuple[Finding, ...]
    """Found before the walk was measured."""


def measure_log(
    log: Log, options: MeasureOptions, progress: OnProgress | None = None
) -> MeasuredLog:
    """Work out all metrics of an open log, and keep its columns; see `measure`."""
    return measure_planned(log, make_plan(log, options), options, progress)


def measure_planned(
    log: Log,
    plan: MeasuringPlan,
    options: MeasureOptions,
    progress: OnProgress | None = None,
    alongside: Alongside | None = None,
) -> MeasuredLog:
    """Work out all metrics of an open log by a plan; see `measure` and `read_recording`."""
    read = read_recording(log, plan.wanted, options.jobs, progress, alongside=alongside)
    damage = damage_of(log, _losses(log, read, plan.wanted.limits))
    prepared = prepare(log, read.recording, plan, options)
    known = (*prepared.findings, *_order_findings(read.recording.out_of_order))
    lost = [Finding("LOST", damage.text)] if damage.losses else []
    walk = analyse(
        prepared.recording,
        prepared.settings,
        prepared.find_legs,
        prepared.planned,
        log=_what_was_read(log, read, damage.messages, damage.bytes),
        known=(*lost, *known),
    )
    return MeasuredLog(Measurement(walk, damage), prepared.selection, prepared.model, read, known)


def _losses(log: Log, read: ReadLog, limits: TimeLimits) -> list[Loss]:
    """Return everything that could not be read of a log.

    Raises:
        CallError: nothing was recorded in the span that is asked for.
    """
    losses = [*log.losses, *read.losses, *malformed_messages(log.channels, read.malformed)]
    if not losses:
        refuse_empty_span(log, limits, sum(read.counts.values()))
    if limits == (None, None):
        losses.extend(wrong_statistics(log, read.counts, losses))
    return losses


def _what_was_read(
    log: Log, read: ReadLog, lost_messages: int | None, lost_bytes: int | None
) -> metrics.Log:
    start, end = log.start_time, log.end_time
    return metrics.Log(
        path=name_of(log.source.path),
        container=log.container,
        profile=log.profile,
        start_s=None if start is None else start / 1e9,
        duration_s=None if start is None or end is None else (end - start) / 1e9,
        messages=sum(read.counts.values()),
        lost_messages=lost_messages,
        lost_bytes=lost_bytes,
    )


def _order_findings(out_of_order: int) -> Iterator[Finding]:
    """Say that messages were sorted.

    Args:
        out_of_order: messages that stood behind later ones of their channel.
    """
    if out_of_order:
        yield found("OUT_OF_ORDER", say="file", count=out_of_order)
