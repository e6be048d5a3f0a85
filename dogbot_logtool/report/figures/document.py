"""The document of `stats --json`: all figures of a log, scope by scope."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool import __version__
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.checks.questions import checks_of
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.report.figures.base import BASE
from dogbot_logtool.report.figures.commands import COMMANDS, with_commands
from dogbot_logtool.report.figures.events import EVENTS, event_sources
from dogbot_logtool.report.figures.feet import FOOT
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Scope,
    Shape,
    TableName,
    inside,
)
from dogbot_logtool.report.figures.foot_source import FootSource, foot_sources
from dogbot_logtool.report.figures.imu import IMU
from dogbot_logtool.report.figures.legs import LEG_STRIDES, LEGS
from dogbot_logtool.report.figures.loads import FORCES, STABILITY
from dogbot_logtool.report.figures.recording import FINDING, LOG
from dogbot_logtool.report.figures.settings import SENSOR, SETTINGS, sensors_by_foot
from dogbot_logtool.report.figures.strides import STRIDES
from dogbot_logtool.report.figures.topics import TOPIC
from dogbot_logtool.report.figures.trust import CHECK, CLOCK, WORLDS, clock_sources
from dogbot_logtool.report.figures.walk import GAIT, SEGMENT, SUPPORT, main_source, segment_sources
from dogbot_logtool.results import LogFacts

SCHEMA_VERSION: Final = 2
"""Grows with every change of meaning."""


@dataclass(frozen=True, slots=True)
class LogSource:
    """The source of a log's figures."""

    stats: Stats
    log: LogFacts
    findings: tuple[Finding, ...]
    """Findings on the log and its figures, the worst first."""


def log_source(stats: Stats, log: LogFacts) -> LogSource:
    """Gather what the figures of a log are taken from."""
    damage = [Finding("LOST", log.damage.text)] if log.damage.losses else []
    found = [*damage, *findings_of(stats), *log.findings]
    return LogSource(stats, log, tuple(sorted(found, key=lambda each: each.severity)))


_TOOL: Final[Sequence[Figure[LogSource]]] = (
    Figure("name", Kind.TEXT, lambda _: "dogbot-logtool", "name of this program"),
    Figure("version", Kind.TEXT, lambda _: __version__, "its version"),
)
_QUALITY: Final = (
    Scope(
        "topics",
        TOPIC,
        lambda source: {topic.topic: topic for topic in source.stats.topics},
        "timing of each topic",
        shape=Shape.BY_NAME,
    ),
    Figure[LogSource](
        "overlap_s",
        Kind.AMOUNT,
        lambda source: source.stats.overlap_s,
        "time known to all feet that have messages, and to the base",
    ),
    Scope(
        "checks",
        CHECK,
        lambda source: checks_of(source.stats, source.findings),
        "what the figures rest on, and whether it was found to hold",
        shape=Shape.LIST,
    ),
    Scope(
        "clocks",
        CLOCK,
        lambda source: clock_sources(source.stats),
        "clocks of the topics, against those of the feet",
        shape=Shape.LIST,
    ),
    Scope(
        "worlds",
        WORLDS,
        lambda source: source.stats.worlds,
        "where the base is among the feet",
        null="too few contact points or poses",
    ),
    Figure[LogSource](
        "lost_messages",
        Kind.COUNT,
        lambda source: source.log.damage.messages,
        "messages that could not be read",
        null="some could not, and it is not known how many",
        columns=(Column(TableName.LOG_ROWS, "lost_messages", rank=20),),
    ),
    Figure[LogSource](
        "lost_bytes",
        Kind.COUNT,
        lambda source: source.log.damage.bytes,
        "bytes that could not be read",
        columns=(Column(TableName.LOG_ROWS, "lost_bytes", rank=20),),
    ),
    Figure[LogSource](
        "losses",
        Kind.TEXTS,
        lambda source: [loss.what for loss in source.log.damage.losses],
        "what could not be read, and where: a sentence each",
    ),
)
DOCUMENT: Final = Scope(
    "",
    (
        Figure[LogSource](
            "schema_version",
            Kind.INTEGER,
            lambda _: SCHEMA_VERSION,
            "grows with every change of meaning",
            choices=(SCHEMA_VERSION,),
        ),
        Scope("tool", _TOOL, lambda source: source, "what made the document"),
        Scope("log", LOG, lambda source: source.log, "the log"),
        Scope(
            "settings",
            (
                *SETTINGS,
                Scope(
                    "sensors",
                    SENSOR,
                    sensors_by_foot,
                    "how each foot's sensor is read",
                    shape=Shape.BY_NAME,
                ),
            ),
            lambda source: source.stats,
            "what decided the figures",
        ),
        Scope(
            "findings",
            FINDING,
            lambda source: source.findings,
            "what makes figures doubtful, why figures are null, and what is good to know; errors "
            "first, then warnings, then notes",
            shape=Shape.LIST,
        ),
        Scope(
            "base",
            BASE,
            lambda source: source.stats.base,
            "motion of the base: from poses, never from the recorded twist",
            null="fewer than two poses",
        ),
        Scope(
            "feet",
            FOOT,
            lambda source: foot_sources(source.stats),
            "each foot; aggregates are over its whole stances or strides",
            shape=Shape.BY_NAME,
        ),
        Scope(
            "gait",
            (
                *inside(GAIT, main_source, "no foot makes a whole stride, and not all feet stand"),
                Scope(
                    "segments",
                    SEGMENT,
                    segment_sources,
                    "the time line, cut where class or stride period changes for at least two "
                    "strides, and where the robot stands",
                    shape=Shape.LIST,
                ),
                Figure[Stats](
                    "transition_strides",
                    Kind.COUNT,
                    lambda stats: stats.transition_strides,
                    "strides of the reference foot between segments, which belong to none",
                ),
                *SUPPORT,
            ),
            lambda source: source.stats,
            "gait of the longest segment; segments, support and flight are of the whole log",
        ),
        Scope("forces", FORCES, lambda source: source.stats, "loads of all feet"),
        Scope(
            "stability",
            STABILITY,
            lambda source: source.stats.stability,
            "static stability, at 25 instants a second",
            null="there is no time in which the base and the state of every foot are known",
        ),
        Scope(
            "commands",
            COMMANDS,
            lambda source: with_commands(source.stats),
            "how the base follows its velocity commands; velocities are means over a stride, which "
            "takes out how a gait swings about its speed",
            null="the log has no velocity commands, or no poses",
        ),
        Scope(
            "imu",
            IMU,
            lambda source: source.stats.imu,
            "the base's accelerometer against the feet's forces and the base's poses: over strides "
            "all three are g and the base's acceleration",
            null="the log has no accelerometer, or it and poses are not known together for 2 s",
        ),
        Scope(
            "legs",
            LEGS,
            lambda source: source.stats.legs,
            "legs, by joint states and by transforms",
            null="the log has neither joint states nor transforms that connect feet and base",
        ),
        Scope(
            "events",
            EVENTS,
            lambda source: event_sources(source.stats),
            "what happened, in the order of time; the rows of `export --table events`, too",
            shape=Shape.LIST,
        ),
        Scope("quality", _QUALITY, lambda source: source, "can the recording be trusted?"),
    ),
    lambda source: source,
    "Figures of one log. SI units, named in the keys. null: it cannot be known.",
)
"""Everything that `stats --json` reports, from a `LogSource`."""

STRIDE_FIGURES: Final[Sequence[Figure[FootSource]]] = (*STRIDES, *LEG_STRIDES)
"""The columns of CSV and Parquet, after log and foot; a row is a stride."""
STRIDE_ROWS: Final = Scope(
    "stride",
    STRIDE_FIGURES,
    lambda source: source,
    "each whole stride: the rows of CSV and Parquet",
)
"""Figures of every stride, from a `FootSource`."""
