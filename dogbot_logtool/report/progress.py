"""A progress bar, on a terminal only."""

import contextlib
import sys
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def progress_bar(name: str, *, shown: bool) -> Iterator[Callable[[int, int], None] | None]:
    """Show a bar while the block runs; yields what is to be told bytes done and in all."""
    if not (shown and sys.stderr.isatty()):
        yield None
        return
    from rich import progress  # noqa: PLC0415 - rich costs 40 ms

    from dogbot_logtool.report.console import diagnostics  # noqa: PLC0415

    columns = (
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.TransferSpeedColumn(),
        progress.TimeRemainingColumn(),
    )
    with progress.Progress(*columns, console=diagnostics(), transient=True) as bar:
        task = bar.add_task(name, total=None)

        def tell(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        yield tell
