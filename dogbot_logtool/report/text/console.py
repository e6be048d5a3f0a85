"""Consoles, and text that is safe to print."""

import os
import sys
from collections.abc import Iterable
from functools import lru_cache
from typing import TextIO

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from dogbot_logtool.finding import Finding, Severity, by_severity
from dogbot_logtool.io.printable import printable, printable_lines
from dogbot_logtool.io.streams import styled
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.text.text_layout import HangingIndent

_COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.NOTE: "cyan"}
_LABEL = 9
"""Columns of ``warning`` and the like, and of the blanks behind them."""
_PIPE_WIDTH = 120
"""Columns of output that is not read on a terminal."""
_LISTED = 10
"""Losses that are listed one by one."""


class _PrintableConsole(Console):
    """A console whose output holds no control characters but its own."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """See `Console.render`."""
        for segment in super().render(renderable, options):
            if segment.control or segment.text.isprintable():
                yield segment
            else:
                yield segment._replace(text=printable_lines(segment.text))


def results() -> Console:
    """Return the console for results (stdout)."""
    if hasattr(sys.stdout, "rich_proxied_file"):
        # Progress bars are shown on the same terminal; text has to appear above them.
        return diagnostics()
    width = None if sys.stdout.isatty() or "COLUMNS" in os.environ else _PIPE_WIDTH
    return _console(styled(sys.stdout), width)


def diagnostics() -> Console:
    """Return the console for progress, warnings and summaries (stderr).

    It is one and the same, so that what is printed while bars are shown stands above them.
    """
    # While bars are shown, stderr itself is a proxy for their console.
    return _diagnostics(styled(getattr(sys.stderr, "rich_proxied_file", sys.stderr)))


@lru_cache(maxsize=1)
def _diagnostics(file: TextIO) -> Console:
    return _console(file, None)


def _console(file: TextIO, width: int | None) -> Console:
    # Sentences that no terminal shows stay whole, for those who search them.
    unlimited = not (file.isatty() or "COLUMNS" in os.environ)
    return _PrintableConsole(
        file=file, highlight=False, markup=False, emoji=False, width=width, soft_wrap=unlimited
    )


def print_sentence(console: Console, *parts: str | tuple[str, str] | Text, indent: int = 2) -> None:
    """Print a sentence in parts, as they are or with a style; its further lines are indented."""
    console.print(HangingIndent(Text.assemble(*parts), indent), crop=False)


def print_command(console: Console, command: str, indent: int) -> None:
    """Print a command on a line of its own, in one piece, so that it can be pasted."""
    console.print(Text(" " * indent + printable(command)), soft_wrap=True)


def print_note(console: Console, sentence: str) -> None:
    """Print what is good to know."""
    print_sentence(console, f"   note  {printable(sentence)}", indent=_LABEL)


def print_findings(console: Console, findings: Iterable[Finding]) -> None:
    """Print findings, the worst first, a line each."""
    for finding in sorted(findings, key=by_severity):
        label = f"{finding.severity.word:>7}  ", _COLOURS[finding.severity]
        print_sentence(console, label, printable(finding.sentence), indent=_LABEL)
        if finding.command:
            print_command(console, finding.command, _LABEL)


def print_damage(console: Console, damage: Damage) -> None:
    """Print what was lost of a log, and below it each loss where there are several."""
    if damage.losses:
        print_sentence(console, (" damage  ", "red"), printable(damage.text), indent=_LABEL)
        print_losses(console, damage)


def print_losses(console: Console, damage: Damage) -> None:
    """Print each loss where there are several; a single one stands in the damage's own line."""
    losses = damage.losses if len(damage.losses) > 1 else ()
    for loss in losses[:_LISTED]:
        print_sentence(console, f"{'':{_LABEL}}{printable(loss.what)}", indent=_LABEL)
    if len(losses) > _LISTED:
        console.print(f"{'':{_LABEL}}and {len(losses) - _LISTED} more")


def human_size(size: int) -> str:
    """Return bytes as people say them."""
    number, unit = float(size), "B"
    for larger in ("kB", "MB", "GB", "TB"):
        if number < 1000:
            break
        number, unit = number / 1000, larger
    return f"{number:.3g} {unit}" if unit != "B" else f"{size} B"
