"""Progress bars, on a terminal only: one for the whole, and one for each log under way."""

import sys
import threading
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, Self

from dogbot_logtool.io.printable import printable

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_EVERY_S: Final = 0.2
"""To draw the bars takes a millisecond or more."""


class ProgressBars:
    """Shows how work on logs goes on; may be called from any thread."""

    def __init__(self, names: Sequence[str], *, visible: bool) -> None:
        """Set up.

        Args:
            names: of the logs.
            visible: whether to show anything.
        """
        self._names = names
        self._visible = visible
        self._lock = threading.Lock()
        self._tasks: dict[int, TaskID] = {}
        self._finished: set[int] = set()
        self._drawn_s = 0.0
        self._bars = _bars() if visible and sys.stderr.isatty() else None

    def __enter__(self) -> Self:
        if self._bars is not None:
            self._bars.start()
            if len(self._names) > 1:
                self._whole = self._bars.add_task(self._count(), total=len(self._names))
        return self

    def __exit__(self, *_error: object) -> None:
        if self._bars is not None:
            self._bars.stop()

    def update(self, number: int, done: int, total: int) -> None:
        """Show how far a log has come, in bytes."""
        with self._lock:
            is_early = time.monotonic() - self._drawn_s < _EVERY_S
            if self._bars is None or is_early or number in self._finished:
                return
            self._drawn_s = time.monotonic()
            if number not in self._tasks:
                name = printable(self._names[number])
                self._tasks[number] = self._bars.add_task(name, total=total)
            self._bars.update(self._tasks[number], completed=done, total=total)
            self._bars.refresh()

    def finished(self, number: int) -> None:
        """Take a log's bar away."""
        with self._lock:
            self._finished.add(number)
            if self._bars is None:
                return
            task = self._tasks.pop(number, None)
            if task is not None:
                self._bars.remove_task(task)
            if len(self._names) > 1:
                done = len(self._finished)
                self._bars.update(self._whole, completed=done, description=self._count())
            self._bars.refresh()

    def lost(self, number: int) -> None:
        """Say that the process that worked on a log died."""
        from dogbot_logtool.report.text.console import diagnostics, print_note  # noqa: PLC0415

        what = "the process that worked on it died; it is tried once more"
        if self._visible:
            print_note(diagnostics(), f"{self._names[number]}: {what}")

    def _count(self) -> str:
        return f"{len(self._finished)} of {len(self._names)} logs"


def _bars() -> "Progress":
    from rich import progress  # noqa: PLC0415 - rich costs 40 ms

    from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415

    return progress.Progress(
        progress.TextColumn("{task.description}", markup=False),
        progress.BarColumn(),
        progress.TimeRemainingColumn(),
        console=diagnostics(),
        transient=True,
        # Refreshed by a thread, bars erase lines that are printed at the same time.
        auto_refresh=False,
        redirect_stdout=sys.stdout.isatty(),
    )
