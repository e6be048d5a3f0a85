"""What was recorded of a log, and the span of it that a user asks for."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Final

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.mcap_layout import PROVENANCE, is_marked
from dogbot_logtool.reader.containers.log import EarlierAnnotations, Extra, Log
from dogbot_logtool.reader.opening import open_joined
from dogbot_logtool.reader.part import TimeLimits

_LARGEST_RECORD: Final = 1 << 24


def open_recorded(path: Location, others: Sequence[Location] = ()) -> Log:
    """Open a log without what `convert` may have added to it.

    Args:
        path: the log.
        others: further files of the same recording.

    Raises:
        CallError: there is no such file.
        LogError: it is no log, or nothing else is in it.
        StoreError: the store fails.
    """
    log = open_joined([path, *others])
    try:
        log = without_annotations(log)
        annotations = log.annotations
        if annotations is not None and not log.channels:
            origin = next((r["input"] for r in annotations.records if r.get("input")), "")
            raise LogError(
                f"{name_of(path)}: holds only annotations, without the messages that were recorded "
                f"(--no-copy); use the log that it was made from{f', {origin}' if origin else ''}"
            )
    except BaseException:
        log.close()
        raise
    log.reopen = partial(open_recorded, path, others)
    return log


def without_annotations(log: Log) -> Log:
    """Return a log without what `convert` added; the log itself if that is nothing."""
    made = list(_provenance(log))
    records = tuple(record for _, record in made)
    channels = frozenset(n for n, channel in log.channels.items() if is_marked(channel.metadata))
    if not channels and not records:
        return log
    messages = sum(log.counts.get(number, 0) for number in channels)
    extras = tuple(extra for extra, _ in made)
    return log.without(EarlierAnnotations(channels, extras, records, messages))


def _provenance(log: Log) -> Iterator[tuple[Extra, Mapping[str, str]]]:
    """Yield the records that tell how the file was made, in the order of the file."""
    if not log.extras:
        return
    # Imported late: a log without such records needs no mcap library.
    from mcap import records  # noqa: PLC0415
    from mcap.opcode import Opcode  # noqa: PLC0415

    from dogbot_logtool.reader.containers.mcap.records import read_extra  # noqa: PLC0415

    for extra in log.extras:
        if extra.opcode != Opcode.METADATA or extra.size > _LARGEST_RECORD:
            continue
        match read_extra(extra):
            case (_, records.Metadata(name=name, metadata=metadata)) if name == PROVENANCE:
                yield extra, metadata


# --- a span of it ---------------------------------------------------------------------------------


def time_limits(log: Log, start_s: float | None, end_s: float | None) -> TimeLimits:
    """Return the log times of a span that is given in s since the log's start.

    Raises:
        CallError: the log has no such time.
    """
    begins, ends = log.start_time or 0, log.end_time or 0
    start = None if start_s is None else begins + round(start_s * 1e9)
    end = None if end_s is None else begins + round(end_s * 1e9)
    first = begins if start is None else start
    starts_outside = first < begins or first > max(begins, ends - 1)
    if starts_outside or (end is not None and end <= first):
        raise _no_such_span(log, (start, end))
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
    if not messages and limits != (None, None):
        raise _no_such_span(log, limits)


def _no_such_span(log: Log, limits: TimeLimits) -> CallError:
    begins, length_s = log.start_time or 0, ((log.end_time or 0) - (log.start_time or 0)) / 1e9
    asked = " ".join(
        f"--{option} {(time - begins) / 1e9:.12g}"
        for option, time in zip(("start", "end"), limits, strict=True)
        if time is not None
    )
    return CallError(
        f"{name_of(log.source.path)}: {asked}: the log has no messages there; "
        f"it lasts from 0 to {length_s:.3f} s"
    )
