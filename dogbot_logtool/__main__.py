"""``python -m dogbot_logtool`` is the command ``dogbot-logtool``."""

import signal

# Loading takes a while: Ctrl-C would print a traceback of Python's own.
if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import gc
from typing import Final, NoReturn

from dogbot_logtool.signals import ignore_signals, raise_on_signals, stopped

_NEW_OBJECTS: Final = 100_000
"""More than are made before a log is read: nearly all that is loaded stays until the end, and to
look through it for garbage, again and again and once more at the end, is 7 % of a short log."""


def main() -> NoReturn:
    """Run the command line."""
    # Imports take a while, and so does the interpreter's end: Ctrl-C would print a traceback.
    raise_on_signals()
    gc.set_threshold(_NEW_OBJECTS)
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
