"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

from dogbot_logtool.core import metrics
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.walk_metrics.rest import Chosen
from dogbot_logtool.core.walk_metrics.walk import metrics_of
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.recording import Alongside, ReadLog, read_recording
from dogbot_logtool.reader.salvage.losses import damage_of, malformed_messages, wrong_statistics
from dogbot_logtool.reader.workers import Start
from dogbot_logtool.results import LogFacts, Measurement
from dogbot_logtool.robot.measuring.plan import LearntSettings, MeasuringPlan, make_plan
from dogbot_logtool.robot.measuring.walk import Measured, measure_recording
from dogbot_logtool.robot.probe_findings import order_findings
from dogbot_logtool.robot.time_span import TimeLimits, refuse_empty_span
from dogbot_logtool.robot.topics.annotated import open_recorded
from dogbot_logtool.run.runner import OnProgress


def measure(
    path: Location,
    options: MeasureOptions,
    progress: OnProgress | None = None,
) -> Measurement:
    """Work out all figures of a log.

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
        return measure_log(log, options, progress).measurement
    finally:
        log.close()


@dataclass(frozen=True, slots=True)
class MeasuredLog:
    """All figures of a log, and the columns that they are made of."""

    measurement: Measurement
    recording: Recording
    learnt: LearntSettings
    """What the columns told of how to measure them."""
    read: ReadLog
    """How they were read; its own columns are the corrected ones, too."""


def measure_log(
    log: Log, options: MeasureOptions, progress: OnProgress | None = None
) -> MeasuredLog:
    """Work out all figures of an open log; see `measure` and `measure_recording`."""
    return measure_planned(log, make_plan(log, options), options, progress)


def measure_planned(
    log: Log,
    plan: MeasuringPlan,
    options: MeasureOptions,
    progress: OnProgress | None = None,
    *,
    with_soles: bool = False,
    alongside: Alongside | None = None,
    start: Start | None = None,
) -> MeasuredLog:
    """Work out all figures of an open log by a plan; see `read_recording`, `measure_recording`."""
    read = read_recording(
        log, plan.wanted, options.jobs, progress, start=start, alongside=alongside
    )
    losses = _losses(log, read, plan.wanted.limits)
    measured = measure_recording(log, read.recording, plan, options, with_soles=with_soles)
    measurement = measurement_of(measured.stats, _facts(log, read, measured, losses))
    read = replace(read, recording=measured.recording)
    return MeasuredLog(measurement, measured.recording, measured.learnt, read)


def measurement_of(stats: Stats, facts: LogFacts) -> Measurement:
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


def _facts(log: Log, read: ReadLog, measured: Measured, losses: Sequence[Loss]) -> LogFacts:
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
        findings=[*measured.findings, *order_findings(log, read.recording.out_of_order)],
        robot=measured.learnt.selection.robot.name,
        robot_is_guessed=measured.learnt.selection.robot_is_guessed,
        contact_is_planned=any(f.code == "PLANNED" and not f.cases for f in measured.findings),
    )
