"""``python -m dogbot_logtool`` is the command ``dogbot-logtool``."""

import signal

# Loading takes a while: Ctrl-C would print a traceback of Python's own.
if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import ctypes
import gc
import os
import sys
from typing import Final, NoReturn

from dogbot_logtool.signals import ignore_signals, raise_on_signals, stopped

_NEW_OBJECTS: Final = 100_000
"""More than are made before a log is read: nearly all that is loaded stays until the end, and to
look through it for garbage, again and again and once more at the end, is 7 % of a short log."""
_KEPT_MEMORY: Final = {-3: 32 << 20, -1: 256 << 20}
"""What glibc's allocator is asked for: M_MMAP_THRESHOLD and M_TRIM_THRESHOLD, bytes. By default it
returns the memory of every array to the system at once, and a tenth of `stats` goes into clearing
it anew."""


def main() -> NoReturn:
    """Run the command line."""
    # Imports take a while, and so does the interpreter's end: Ctrl-C would print a traceback.
    raise_on_signals()
    gc.set_threshold(_NEW_OBJECTS)
    # A product of matrices over several threads is no sooner done, takes as much time of the other
    # cores again, and adds up in another order; and a process with threads must not be forked.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "mallopt"):
        for parameter, size in _KEPT_MEMORY.items():
            libc.mallopt(parameter, size)
    try:
        from dogbot_logtool.cli import main as run  # noqa: PLC0415

        run()
    except Exception:
        # Where a signal comes while a class is made, Python 3.11 makes another error of it.
        if (interruption := stopped()) is None:
            raise
        raise interruption from None
    finally:
        ignore_signals()
        gc.freeze()


if __name__ == "__main__":
    main()
