"""Signals that end the program: each becomes an exception, so that every clean-up runs."""

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_ENDING: Final = [
    signal.Signals[name]
    for name in ("SIGINT", "SIGTERM", "SIGHUP")
    if name in signal.Signals.__members__
]
"""Ctrl-C, `kill`, and a terminal that was closed; not every system has the last."""

_CLEAN_UP_S: Final = 10.0
_AGAIN_AFTER_S: Final = 0.01
_last_raised = -math.inf
_stopped: "Stopped | None" = None


class Stopped(SystemExit):
    """A signal asked the program to end; the exit code is the one that shells expect."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.exit_code = self.code = 128 + number


def raise_on_signals() -> None:
    """Raise `Stopped` in the main thread when a signal asks this process to end.

    A signal that is ignored already stays ignored: `nohup` and background jobs rely on it.
    """
    for number in _ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, raise_stopped)
    raise_again_if_lost()


def raise_again_if_lost() -> None:
    """Raise `Stopped` once more where it was lost.

    A signal may come while a finalizer or the callback of a weak reference runs, out of which no
    exception passes: the interpreter prints it and goes on.
    """
    sys.unraisablehook = _raise_again


def _raise_again(unraisable: "UnraisableHookArgs") -> None:
    global _last_raised  # noqa: PLW0603 - a process has one
    stopped = unraisable.exc_value
    if not isinstance(stopped, Stopped):
        sys.__unraisablehook__(unraisable)
        return
    _last_raised = -math.inf
    number = stopped.exit_code - 128
    # Raised here, it would be lost, too. A timer of the system needs no lock, which whatever was
    # interrupted may hold.
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, lambda _alarm, frame: raise_stopped(number, frame))
        signal.setitimer(signal.ITIMER_REAL, _AGAIN_AFTER_S)


def ignore_signals() -> None:
    """Ignore what asks this process to end: it is about to, and must not be cut short."""
    for number in _ENDING:
        signal.signal(number, signal.SIG_IGN)


def leave_to_parent() -> None:
    """Ignore Ctrl-C and a closed terminal, which reach all processes: the parent ends its workers.

    To be called first in a worker; SIGTERM ends it without a word.
    """
    for number in _ENDING:
        # To ignore SIGTERM even for a moment would forget one that was held back.
        ends = number is signal.SIGTERM
        signal.signal(number, signal.SIG_DFL if ends else signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDING)


def end_with_parent(clean_up_s: float = 0.0) -> None:
    """End this worker when its parent has ended, however that was.

    Args:
        clean_up_s: how long it may remove what it has begun to write, after a SIGTERM; 0: not.
    """
    threading.Thread(target=_wait_for_parent, args=(clean_up_s,), daemon=True).start()


def _wait_for_parent(clean_up_s: float) -> None:
    import multiprocessing  # noqa: PLC0415 - takes long to load
    from multiprocessing.connection import wait  # noqa: PLC0415

    parent = multiprocessing.parent_process()
    if parent is None:
        return
    wait([parent.sentinel])
    if clean_up_s and hasattr(signal, "pthread_kill"):
        # Unlike other ways, this wakes it where it waits for a disk or a store.
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    elif clean_up_s:
        signal.raise_signal(signal.SIGTERM)
    time.sleep(clean_up_s)
    os._exit(1)


@contextmanager
def held_back() -> Iterator[None]:
    """Let signals wait that ask this process to end, until the block has ended.

    They wait in processes that are started in the block, too, until `leave_to_parent`.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def raise_stopped(number: int, _frame: FrameType | None) -> None:
    """Raise `Stopped`, but not again soon: the clean-up that it began must not be cut short."""
    global _last_raised, _stopped  # noqa: PLW0603 - a process has one
    now = time.monotonic()
    if now - _last_raised > _CLEAN_UP_S:
        _last_raised = now
        _stopped = Stopped(number)
        raise _stopped


def stopped() -> Stopped | None:
    """Return what was raised, if anything was: libraries may make another error of it."""
    return _stopped
