"""Where text goes, and how it is made safe to print."""

import os
import sys
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import IO

from rich.console import Console
from rich.text import Text

from dogbot_logtool.findings import Finding, Severity
from dogbot_logtool.printable import printable
from dogbot_logtool.reader.log import Loss, lost_messages

_COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.NOTE: "cyan"}
_LABELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}


_PIPE_WIDTH = 120
"""Columns of output that is not read on a terminal."""
_TOLD = 10
"""Places of damage that are listed one by one."""


class _QuietlyClosed(Console):
    """Whoever closes the pipe has seen enough: that is no error."""

    def on_broken_pipe(self) -> None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(0)


def results() -> Console:
    """Return the console for results (stdout)."""
    width = None if sys.stdout.isatty() or "COLUMNS" in os.environ else _PIPE_WIDTH
    return _QuietlyClosed(highlight=False, markup=False, emoji=False, width=width)


def diagnostics() -> Console:
    """Return the console for progress, warnings and summaries (stderr).

    It is one and the same, so that what is printed while bars are shown stands above them.
    """
    # While bars are shown, stderr itself is a proxy for their console.
    return _diagnostics(getattr(sys.stderr, "rich_proxied_file", sys.stderr))


@lru_cache(maxsize=1)
def _diagnostics(file: IO[str]) -> Console:
    return Console(file=file, highlight=False, markup=False, emoji=False)


def print_findings(console: Console, findings: Iterable[Finding]) -> None:
    """Print findings, the worst first, a line each."""
    for finding in sorted(findings):
        label = Text(f"{_LABELS[finding.severity]:>7}  ", style=_COLOURS[finding.severity])
        console.print(Text.assemble(label, printable(finding.sentence)), soft_wrap=True)
        if finding.command:
            console.print(Text(f"         {printable(finding.command)}"), soft_wrap=True)


def print_damage(console: Console, losses: Sequence[Loss]) -> None:
    """Print what was lost, and where."""
    for loss in losses[:_TOLD]:
        line = Text.assemble(Text(" damage  ", style="red"), printable(loss.what))
        console.print(line, soft_wrap=True)
    if len(losses) > _TOLD:
        console.print(f" damage  and {len(losses) - _TOLD} more places")
    if losses:
        messages = lost_messages(losses)
        count = "an unknown number of" if messages is None else f"{messages:,}"
        size = sum(loss.bytes for loss in losses)
        console.print(f"   lost  {count} messages, {size:,} bytes", soft_wrap=True)


def human_size(size: int) -> str:
    """Return bytes as people say them."""
    number, unit = float(size), "B"
    for larger in ("kB", "MB", "GB", "TB"):
        if number < 1000:
            break
        number, unit = number / 1000, larger
    return f"{number:.3g} {unit}" if unit != "B" else f"{size} B"
