"""All findings about the figures of a log."""

from collections.abc import Iterator, Sequence
from typing import Final

from dogbot_logtool.core.findings.base import base_findings, fall_findings
from dogbot_logtool.core.findings.contradictions import contradiction_findings
from dogbot_logtool.core.findings.feet import foot_findings
from dogbot_logtool.core.findings.gait import gait_findings, stability_findings
from dogbot_logtool.core.findings.legs import leg_findings
from dogbot_logtool.core.findings.loads import load_findings
from dogbot_logtool.core.findings.sensors import sensor_findings
from dogbot_logtool.core.findings.topics import clock_findings, topic_findings
from dogbot_logtool.core.findings.wording import counted
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, Severity

GRAVE: Final = (
    "W_FALL",
    "N_PLANNED",
    "W_NO_MESSAGES",
    "W_NOTHING_USABLE",
    "W_CONTACT_UNKNOWN",
    "W_MOVES_WITHOUT_STEPS",
    "W_CLOCK_OFFSET",
    "W_CLOCK_SET",
    "W_LOG_TIME_USED",
    "W_ALL_FEET_SILENT",
    "W_DEAD",
    "W_STUCK",
    "W_STOPPED",
    "W_WORLDS_DIFFER",
    "W_UP_AXIS",
    "W_HEIGHT_DRIFTS",
    "W_SIDES_SWAPPED",
    "W_POSE_JUMP",
    "W_IMPULSE_IS_NOT_WEIGHT",
    "W_WRENCH_FRAME_UNKNOWN",
    "W_DIRECTION_UNKNOWN",
    "W_FORWARD_AXIS",
    "W_TIPPING",
    "W_SATURATED",
    "W_SLIPS",
    "W_JOINT_CLOCK",
    "W_JOINT_VALUES",
    "W_EFFORT_SIGN",
    "W_GAPS",
    "W_SPIKES",
)
"""Findings that make the figures doubtful, the one of most consequence first."""
MOST_FIRST: Final = 3
"""Findings that a report begins with."""


def consequence(finding: Finding) -> tuple[int, int]:
    """Return the key that sorts findings: what makes the headline doubtful comes first."""
    rank = GRAVE.index(finding.code) if finding.code in GRAVE else len(GRAVE)
    return finding.severity, rank


def first_of(findings: Sequence[Finding]) -> list[Finding]:
    """Return what to look at first: of errors and grave findings, those of most consequence."""
    grave = [each for each in findings if each.code in GRAVE or each.severity is Severity.ERROR]
    by_code = {each.code: each for each in sorted(grave, key=consequence, reverse=True)}
    return list(by_code.values())[::-1][:MOST_FIRST]


def findings_of(stats: Stats) -> tuple[Finding, ...]:
    """Return all findings about the figures, those of most consequence first."""
    found = [
        *clock_findings(stats),
        *contradiction_findings(stats),
        *fall_findings(stats),
        *_sensor_findings(stats),
        *(finding for foot in stats.feet for finding in foot_findings(stats, foot)),
        *base_findings(stats),
        *gait_findings(stats),
        *load_findings(stats),
        *leg_findings(stats),
        *stability_findings(stats),
        *_beside(stats),
        *(
            finding
            for topic in stats.topics
            for finding in topic_findings(
                topic, may_pause=topic.topic == stats.settings.command_topic
            )
        ),
    ]
    return tuple(sorted(found, key=consequence))


def _beside(stats: Stats) -> Iterator[Finding]:
    """Yield what topics beside feet and base say, in logs that have them."""
    for each in stats.beside:
        is_command = each.topic == stats.settings.command_topic
        code = "W_COMMANDS_REFUSED" if is_command else "W_IMU_REFUSED"
        if each.refused:
            text = f"{counted(each.refused, 'message')} of {each.messages} with a number"
            text += " that is not finite or that no robot reaches; left out"
            yield Finding(code, f"{each.topic}: {text}", each.topic)
    if stats.command_track is not None:
        from dogbot_logtool.core.findings.commands import command_findings  # noqa: PLC0415

        yield from command_findings(stats)
    if stats.imu is not None:
        from dogbot_logtool.core.findings.imu import imu_findings  # noqa: PLC0415

        yield from imu_findings(stats)


def _sensor_findings(stats: Stats) -> Iterator[Finding]:
    settings = stats.settings
    sensors = [settings.sensor(foot) for foot in range(len(settings.feet))]
    weight = settings.body_weight_n or settings.estimated_weight_n
    yield from sensor_findings([foot.name for foot in settings.feet], sensors, weight)
