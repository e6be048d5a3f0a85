"""Sentences and tables that fit a terminal without breaking a word."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

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
