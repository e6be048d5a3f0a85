"""The figures of a log among several: a row of a few."""

from pathlib import Path

from dogbot_logtool.core.remarks import remarks
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.numbers import NOTHING, decimal
from dogbot_logtool.report.verdict import gait_name
from dogbot_logtool.results import LogFacts


def summary_row(stats: Stats, log: LogFacts) -> tuple[str, ...]:
    """Return the row of a log among several."""
    main = stats.main
    base = stats.base
    warnings = sum(not one.code.startswith("N_") for one in (*remarks(stats), *log.findings))
    return (
        printable(Path(log.path).name),
        NOTHING if main is None or main.gait.name is None else gait_name(main).lower(),
        decimal(main.duty_factor if main else None, 3),
        decimal(main.stride_frequency_hz if main else None, 3),
        decimal(base.forward_speed_mps if base else None, 3),
        decimal(stats.loads.vertical_impulse_over_weight, 4),
        str(warnings),
        _damage(log),
    )


def _damage(log: LogFacts) -> str:
    """Say in a word or two what could not be read."""
    if not (log.losses or log.lost_bytes or log.lost_messages != 0):
        return NOTHING
    return f"{log.lost_messages} lost" if log.lost_messages else "damaged"
