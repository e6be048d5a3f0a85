"""Consoles, text that is safe to print, and sentences and tables that break no word."""

import os
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import zip_longest
from typing import Final, NamedTuple, TextIO

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.segment import Segment
from rich.text import Text

from dogbot_logtool.finding import Finding, Severity, by_severity
from dogbot_logtool.io.printable import printable, printable_lines, styled
from dogbot_logtool.reader.containers.loss import Damage

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


def print_error(console: Console, sentence: str) -> None:
    """Print the sentence of an error; what it lists stands in indented lines below.

    Such a line begins with two blanks: names from logs cannot begin lines of ours.
    """
    label = "error: "
    first, *others = map(printable, sentence.split("\n  "))
    print_sentence(console, (label, "red"), first, indent=len(label))
    for line in others:
        if line.startswith("dogbot-logtool "):
            print_command(console, line, 2)
        else:
            print_sentence(console, f"  {line}", indent=4)


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


_WORD: Final = re.compile(r"(\S+)\s*")
_IN_TWO: Final = re.compile(r"(?<=\S) (?=\S+\Z)")
"""Where a heading of one line is broken."""


@dataclass(frozen=True, slots=True)
class HangingIndent:
    """A sentence that wraps between words; its further lines are indented.

    A word longer than a line runs over the edge, so that it can be copied as a whole.
    """

    text: Text
    indent: int
    """Columns; the text is not broken before."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the lines; a single one where text is not to be wrapped."""
        del console
        breaks: list[int] = []
        used = len(self.text.plain) - len(self.text.plain.lstrip())
        for word in () if options.no_wrap else _WORD.finditer(self.text.plain):
            if word.start() > self.indent and used + cell_len(word[1]) > options.max_width:
                breaks.append(word.start())
                used = self.indent
            used += cell_len(word[0])
        first, *others = self.text.divide(breaks)
        yield _as_it_is(first)
        yield from (_as_it_is(Text.assemble(" " * self.indent, line)) for line in others)


def _as_it_is(line: Text) -> Text:
    """Return a line that is neither wrapped nor cut once more."""
    line.rstrip()
    line.no_wrap, line.overflow = True, "ignore"
    return line


class Row(NamedTuple):
    """A row of a table."""

    names: Sequence[str | Text]
    """The first cell, a line each."""
    cells: Sequence[str]
    """The other cells; they stand beside the first of those lines that fits."""
    style: str = ""


@dataclass(frozen=True, slots=True)
class NameTable:
    """A table of numbers with names before them; a name too long for it has a line of its own."""

    headings: Sequence[str]
    """Of the columns, in one line or two."""
    rows: Sequence[Row]
    left: Sequence[int] = ()
    """Columns aligned to the left, as the names are; 1 is the first one behind them."""
    margin: int = 0
    gap: int = 2
    is_ruled: bool = False
    """Whether a line below the headings and blank ones around the table set it off."""
    heading_style: str = "bold"

    @property
    def width(self) -> int:
        """Columns that it takes if every row has a single line."""
        cells = self._cell_widths()
        return self.margin + max(self._name_widths()) + sum(cells) + self.gap * len(cells)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the lines of the table; where it has no room, headings take two of them."""
        if self.width > options.max_width and any(map(_IN_TWO.search, self.headings)):
            in_two = [_IN_TWO.sub(r"\n", heading) for heading in self.headings]
            yield from replace(self, headings=in_two).__rich_console__(console, options)
            return
        names, cells = self._name_widths(), self._cell_widths()
        room = options.max_width - self.margin - sum(cells)
        gap = self.gap if names[0] + self.gap * len(cells) <= room else 1
        room -= gap * len(cells)
        widths = [max(each for each in names if each <= max(room, names[0])), *cells]
        lines = zip_longest(*(each.split("\n") for each in self.headings), fillvalue="")
        table = [
            self._line(Text(name), cells, widths, gap, self.heading_style) for name, *cells in lines
        ]
        if self.is_ruled:
            ruler = ("-" if options.ascii_only else "─") * (sum(widths) + gap * len(cells) + 2)
            table = [Text(), *table, Text(" " * (self.margin - 1) + ruler)]
        for row in self.rows:
            table.extend(self._row(row, widths, gap))
        yield from map(_as_it_is, [*table, Text()] if self.is_ruled else table)

    def _name_widths(self) -> list[int]:
        """Return the widths of the names, that of their heading first."""
        names = [self.headings[0], *(name for row in self.rows for name in row.names)]
        return [cell_len(str(name)) for name in names]

    def _cell_widths(self) -> list[int]:
        """Return the widths of the columns behind the names."""
        columns = zip(self.headings[1:], *(row.cells for row in self.rows), strict=True)
        return [
            max(cell_len(line) for cell in each for line in cell.split("\n")) for each in columns
        ]

    def _row(self, row: Row, widths: Sequence[int], gap: int) -> Iterator[Text]:
        names = [Text.assemble(name) for name in row.names]
        fitting = (at for at, name in enumerate(names) if name.cell_len <= widths[0])
        beside = next(fitting, len(names))
        if beside == len(names) and any(row.cells):
            names.append(Text())
        for number, name in enumerate(names):
            yield self._line(name, row.cells if number == beside else (), widths, gap, row.style)

    def _line(
        self, name: Text, cells: Sequence[str], widths: Sequence[int], gap: int, style: str
    ) -> Text:
        line = Text(" " * self.margin, style=style)
        line.append_text(name)
        line.append(" " * (widths[0] - name.cell_len))
        for column, (cell, width) in enumerate(zip(cells, widths[1:], strict=False), 1):
            filler = " " * (width - cell_len(cell))
            line.append(" " * gap + (cell + filler if column in self.left else filler + cell))
        return line
