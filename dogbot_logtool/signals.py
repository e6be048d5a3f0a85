"""Signals that end the program: each becomes an exception, so that every clean-up runs."""

import signal
import sys
from types import FrameType
from typing import Final

_NAMES: Final = ("SIGINT", "SIGTERM", "SIGHUP")
"""Ctrl-C, `kill`, and a terminal that was closed; not every system has the last."""


class Stopped(SystemExit):
    """A signal asked the program to end; the exit code is the one that shells expect."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.code = 128 + number


def raise_on_signals() -> None:
    """Raise `Stopped` in the main thread when a signal asks this process to end.

    A signal that is ignored already stays ignored: `nohup` and background jobs rely on it.
    """
    for name in _NAMES:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)


def _stop(number: int, _frame: FrameType | None) -> None:
    # A second Ctrl-C must not cut short the clean-up that the first one began.
    if not _is_stopping():
        raise Stopped(number)


def _is_stopping() -> bool:
    """Tell whether `Stopped` is being handled, an error raised on its way included."""
    error = sys.exception()
    while error is not None and not isinstance(error, Stopped):
        error = error.__context__
    return error is not None
