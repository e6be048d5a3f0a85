"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

from dogbot_logtool.core import metrics
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.checks.frames import columns_corrected, frames_known
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.walk_metrics.rest import Chosen
from dogbot_logtool.core.walk_metrics.walk import metrics_of
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.recording import Alongside, ReadLog, read_recording
from dogbot_logtool.reader.salvage.losses import (
    damage_of,
    malformed_messages,
    wrong_statistics,
)
from dogbot_logtool.reader.workers import Start
from dogbot_logtool.results import LogFacts, Measurement
from dogbot_logtool.robot.annotated import open_recorded
from dogbot_logtool.robot.measuring.plan import MeasuringPlan, make_plan, measure_recording
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.time_span import TimeLimits, refuse_empty_span
from dogbot_logtool.run.runner import OnProgress


def measure(
    path: Location,
    options: MeasureOptions,
    progress: OnProgress | None = None,
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
        found = measure_log(log, options, progress).measurement
        # Of the samples, only what figures draw is kept.
        return replace(found, walk=replace(found.walk, recording=Recording()))
    finally:
        log.close()


@dataclass(frozen=True, slots=True)
class MeasuredLog:
    """All metrics of a log, and what they were read from."""

    measurement: Measurement
    selection: Selection
    read: ReadLog


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
    *,
    alongside: Alongside | None = None,
    start: Start | None = None,
) -> MeasuredLog:
    """Work out all metrics of an open log by a plan; see `measure` and `read_recording`."""
    read = read_recording(
        log, plan.wanted, options.jobs, progress, start=start, alongside=alongside
    )
    losses = _losses(log, read, plan.wanted.limits)
    walk, selection = measure_recording(log, read.recording, plan, options)
    found = [
        *selection.findings,
        *frames_known(walk),
        *plan.side.findings,
        *columns_corrected(walk),
        *_order_findings(log, read.recording.out_of_order),
    ]
    facts = _facts(log, read, selection, found, losses)
    return MeasuredLog(measurement_of(walk, facts), selection, read)


def measurement_of(stats: Walk, facts: LogFacts) -> Measurement:
    """Return the metrics and findings of a log.

    Args:
        stats: what was worked out of it.
        facts: what is known of the log itself.
    """
    damage = facts.damage
    lost = [Finding("LOST", damage.text)] if damage.losses else []
    findings = sorted([*lost, *findings_of(stats), *facts.findings], key=attrgetter("severity"))
    log = metrics.Log(
        path=facts.path,
        container=facts.container,
        profile=facts.profile,
        start_s=facts.start_s,
        duration_s=facts.duration_s,
        messages=facts.messages,
        lost_messages=damage.messages,
        lost_bytes=damage.bytes,
    )
    chosen = Chosen(facts.robot, facts.robot_is_guessed, facts.contact_is_planned)
    found = metrics_of(stats, log, chosen, findings)
    return Measurement(stats, facts, tuple(findings), found)


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


def _facts(
    log: Log,
    read: ReadLog,
    selection: Selection,
    findings: Sequence[Finding],
    losses: Sequence[Loss],
) -> LogFacts:
    duration = None
    if log.start_time is not None and log.end_time is not None:
        duration = (log.end_time - log.start_time) / 1e9
    return LogFacts(
        path=shown(log.source.path),
        container=log.container,
        profile=log.profile,
        start_s=None if log.start_time is None else log.start_time / 1e9,
        duration_s=duration,
        messages=sum(read.counts.values()),
        damage=damage_of(log, losses),
        findings=findings,
        robot=selection.robot.name,
        robot_is_guessed=selection.robot_is_guessed,
        contact_is_planned=any(f.code == "PLANNED" and not f.cases for f in findings),
    )


def _order_findings(log: Log, out_of_order: int) -> Iterator[Finding]:
    """Say that messages were sorted.

    Args:
        log: the log.
        out_of_order: messages that stood behind later ones of their channel.
    """
    if log.is_reordered or out_of_order:
        count = f": {out_of_order:,} go back" if out_of_order else ""
        text = f"messages stand out of order in the file{count}; they are read by their log times"
        yield Finding("OUT_OF_ORDER", text)
