"""The clock that a whole log is measured on."""

from collections.abc import Sequence

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.quality.clocks import ClockDifference, why_clocks_cannot_be_joined
from dogbot_logtool.core.quality.stamps import StampCheck, set_spans, why_unusable
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class LogClock:
    """The clock of all feet and the base, since phases and support compare them with each other."""

    source: TimeSource
    reason: str
    """Why it is log time although no option asks for it; empty where it is not."""
    breaks: Ints
    """(b, 2) ns, spans in which the clock of the stamps was set: nothing is measured across them.
    Empty on header stamps, whose own steps show."""


def choose_clock(
    checks: Sequence[StampCheck],
    differences: Sequence[ClockDifference],
    given: TimeSource | None,
) -> LogClock:
    """Choose header stamps, unless they cannot be used.

    Args:
        checks: stamps of the feet and of the base.
        differences: how far the clocks of their topics are from each other.
        given: the clock that is decided on already; None: none is.
    """
    reason = ""
    if given is None:
        reason = why_unusable(checks) or why_clocks_cannot_be_joined(differences)
    source = TimeSource.LOG if reason else given or TimeSource.HEADER
    on_stamps = source is TimeSource.HEADER
    breaks = timespans.no_spans() if on_stamps else timespans.merge(set_spans(checks))
    return LogClock(source, reason, breaks)
