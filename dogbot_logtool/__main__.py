"""``python -m dogbot_logtool`` is the command ``dogbot-logtool``."""

from typing import NoReturn

from dogbot_logtool.run.signals import ignore_signals, raise_on_signals


def main() -> NoReturn:
    """Run the command line."""
    # Imports take a while, and so does the interpreter's end: Ctrl-C would print a traceback.
    raise_on_signals()
    try:
        from dogbot_logtool.cli import main as run  # noqa: PLC0415

        run()
    finally:
        ignore_signals()


if __name__ == "__main__":
    main()
