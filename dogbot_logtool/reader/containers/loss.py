"""Damage in a log, and the words for it."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from dogbot_logtool.errors import DAMAGED

LONGEST_NAME: Final = 200
"""Characters of a name from the log that a sentence repeats."""
_MOST: Final = 200
"""Losses kept one by one; more are summed up."""


class Loss(NamedTuple):
    """Damage that was found: what could not be read, and where."""

    offset: int
    """Byte in the file; 0 where none is known."""
    what: str
    """A sentence; of one file among several it begins with the file's name."""
    bytes: int = 0
    """Bytes of the file that gave nothing."""
    messages: int | None = 0
    """Messages known to be lost; None when their number is not known."""
    start_time: int | None = None
    """ns, log time from which messages may be missing; None: not known."""
    end_time: int | None = None
    """ns, log time up to which messages may be missing; None: not known, or up to the end."""
    file: str = ""
    """Name of the file among several; empty where there is only one."""


def lost_messages(losses: Sequence[Loss]) -> int | None:
    """Return how many messages are known to be lost; None when it cannot be known."""
    known = [loss.messages for loss in losses if loss.messages is not None]
    return sum(known) if len(known) == len(losses) else None


def summed_up(losses: Sequence[Loss]) -> tuple[Loss, ...]:
    """Return losses in the order in which they were found, those beyond a number as one."""
    first, rest = losses[:_MOST], losses[_MOST:]
    if not rest:
        return (*first,)
    what = f"{len(rest)} more places are damaged, the first at byte {rest[0].offset}"
    size = sum(loss.bytes for loss in rest)
    return (*first, Loss(rest[0].offset, what, size, lost_messages(rest)))


class Damage(NamedTuple):
    """Everything that could not be read of a log. All commands say it in the words of `text`."""

    log: str
    """The log's name, as it may be shown."""
    losses: tuple[Loss, ...] = ()
    """Empty: the log is sound."""
    origin: int | None = None
    """ns, log time of the first message, from which seconds count."""

    @property
    def exit_code(self) -> int:
        """0: sound; 3: damaged."""
        return DAMAGED if self.losses else 0

    @property
    def messages(self) -> int | None:
        """Messages known to be lost; None when their number cannot be known."""
        return lost_messages(self.losses)

    @property
    def bytes(self) -> int:
        """Bytes of the log that gave nothing."""
        return sum(loss.bytes for loss in self.losses)

    @property
    def line(self) -> str:
        """The log's name, and what was lost of it."""
        return f"{self.log}: {self.text}"

    @property
    def text(self) -> str:
        """What was lost, from where to where in bytes and in seconds, and why; empty if sound."""
        if not self.losses:
            return ""
        lost = [loss for loss in self.losses if loss.bytes or loss.messages != 0]
        what = (lost or self.losses)[0].what
        more = f" (and {len(self.losses) - 1} more)" if len(self.losses) > 1 else ""
        if not lost:
            return f"nothing is known to be lost: {what}{more}"
        amount = _messages(self.messages) + (f" and {self.bytes:,} bytes" if self.bytes else "")
        return f"lost {', '.join([amount, *_bytes(lost), *self._seconds(lost)])}: {what}{more}"

    def seconds(self, time: int | None) -> float | None:
        """Return a log time, ns, as s since the log's first message."""
        return None if time is None or self.origin is None else (time - self.origin) / 1e9

    def _seconds(self, lost: Sequence[Loss]) -> Iterator[str]:
        """Yield from when to when messages are missing, as far as that is known."""
        spans = [(self.seconds(each.start_time), self.seconds(each.end_time)) for each in lost]
        spans = [span for span in spans if span != (None, None)]
        if not spans:
            return
        starts = [start for start, _ in spans if start is not None]
        ends = [end for _, end in spans if end is not None]
        start = f"{min(starts):.2f} s" if len(starts) == len(spans) else ""
        end = f"{max(ends):.2f} s" if len(ends) == len(spans) else ""
        yield _some(len(spans), lost) + _extent(start, end)


SOUND: Final = Damage("")
"""Of no log, or of one in which nothing is damaged."""


def _messages(count: int | None) -> str:
    if count is None:
        return "an unknown number of messages"
    return f"{count:,} message" if count == 1 else f"{count:,} messages"


def _bytes(lost: Sequence[Loss]) -> Iterator[str]:
    """Yield from which byte to which the losses reach; nothing for those of several files."""
    known = [loss for loss in lost if loss.offset]
    if not known or len({loss.file for loss in known}) > 1:
        return
    start, end = min(loss.offset for loss in known), max(loss.offset + loss.bytes for loss in known)
    end_words = f"byte {end:,}" if any(loss.bytes for loss in known) else ""
    yield _some(len(known), lost) + _extent(f"byte {start:,}", end_words)


def _some(known: int, lost: Sequence[Loss]) -> str:
    """Return what stands before an extent that is known of only a part of the losses."""
    return "" if known == len(lost) else "some "


def _extent(start: str, end: str) -> str:
    """Return "from START to END", or as much of it as is known."""
    if not start:
        return f"up to {end}" if end else "from its start to its end"
    return f"from {start} to {end}" if end else f"from {start} on"
