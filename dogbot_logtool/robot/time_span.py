"""The part of a log that a user asks for: --start and --end."""

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.part import TimeLimits


def time_limits(log: Log, start_s: float | None, end_s: float | None) -> TimeLimits:
    """Return the log times of a span that is given in s since the log's start.

    Raises:
        CallError: the log has no such time.
    """
    if log.start_time is None or log.end_time is None:
        return None, None
    start = None if start_s is None else log.start_time + round(start_s * 1e9)
    end = None if end_s is None else log.start_time + round(end_s * 1e9)
    first = log.start_time if start is None else start
    fault = ""
    if first < log.start_time:
        fault = f"--start {start_s:.12g} lies before the log"
    elif end is not None and end <= first:
        begin = "the log's start" if start_s is None else f"--start {start_s:.12g}"
        fault = f"--end {end_s:.12g} is not after {begin}"
    elif first > log.start_time and first >= log.end_time:
        fault = f"--start {start_s:.12g} is not before the log's end"
    if fault:
        raise CallError(f"{name_of(log.source.path)}: {fault}; {_length(log)}")
    return start, end


def refuse_empty_span(log: Log, limits: TimeLimits, messages: int) -> None:
    """Refuse a span in which nothing was recorded.

    Args:
        log: the log.
        limits: of the span.
        messages: found in it.

    Raises:
        CallError: there is a span, and nothing is in it.
    """
    if messages or limits == (None, None) or log.start_time is None or log.end_time is None:
        return
    start, end = (None if each is None else (each - log.start_time) / 1e9 for each in limits)
    first = 0.0 if start is None else start
    last = (log.end_time - log.start_time) / 1e9 if end is None else end
    raise CallError(
        f"{name_of(log.source.path)}: no message was recorded from {first:.12g} to {last:.12g} s; "
        f"{_length(log)}"
    )


def _length(log: Log) -> str:
    return f"it lasts from 0 to {((log.end_time or 0) - (log.start_time or 0)) / 1e9:.3f} s"
