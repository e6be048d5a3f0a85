"""Where text goes, and how it is made safe to print."""

import os
import sys
from collections.abc import Iterable

from rich.console import Console
from rich.text import Text

from dogbot_logtool.findings import Finding, Severity
from dogbot_logtool.printable import printable

_COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.NOTE: "cyan"}
_LABELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}


_PIPE_WIDTH = 120
"""Columns of output that is not read on a terminal."""


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
    """Return the console for progress, warnings and summaries (stderr)."""
    return Console(file=sys.stderr, highlight=False, markup=False, emoji=False)


def print_findings(console: Console, findings: Iterable[Finding]) -> None:
    """Print findings, the worst first, a line each."""
    for finding in sorted(findings):
        label = Text(f"{_LABELS[finding.severity]:>7}  ", style=_COLOURS[finding.severity])
        console.print(Text.assemble(label, printable(finding.text)), soft_wrap=True)


def human_size(size: int) -> str:
    """Return bytes as people say them."""
    number, unit = float(size), "B"
    for larger in ("kB", "MB", "GB", "TB"):
        if number < 1000:
            break
        number, unit = number / 1000, larger
    return f"{number:.3g} {unit}" if unit != "B" else f"{size} B"
