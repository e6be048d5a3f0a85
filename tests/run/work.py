"""Work for runners: what ends well, fails, dies or never ends."""

import os
import signal
import time
from pathlib import Path
from typing import Any

from dogbot_logtool.errors import CallError
from dogbot_logtool.run.runner import OnProgress


class Progress:
    def __init__(self) -> None:
        self.done: list[int] = []
        self.lost_items: list[int] = []

    def update(self, number: int, done: int, total: int) -> None:
        assert (number >= 0, done, total) == (True, 1, 2)

    def finished(self, number: int) -> None:
        self.done.append(number)

    def lost(self, number: int) -> None:
        self.lost_items.append(number)


def work(item: tuple[str, Path], progress: OnProgress | None) -> Any:
    what, folder = item
    if progress is not None:
        progress(1, 2)
    match what:
        case "slow":
            time.sleep(0.3)
        case "wrong":
            raise CallError("no such file")
        case "fault":
            raise KeyError(what)
        case "greedy":
            raise MemoryError
        case "deadly":
            os.kill(os.getpid(), signal.SIGKILL)
        case "deadly once" if not (folder / "died").exists():
            (folder / "died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        case "unsendable":
            return UNSENDABLE
        case "endless":
            endless(folder)
    return what.upper()


UNSENDABLE: Any = type("Unsendable", (), {"__reduce__": lambda _self: 1 / 0})()


def endless(folder: Path) -> None:
    """Work for ever, with a file that is removed on any error."""
    begun = folder / f"begun.{os.getpid()}"
    begun.touch()
    try:
        while True:
            time.sleep(60.0)
    finally:
        begun.unlink()
