"""Sentences and tables that fit a terminal without breaking a word."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

_WORD: Final = re.compile(r"(\S+)\s*")


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
        room = None if options.no_wrap else options.max_width
        yield from map(_as_it_is, wrapped(self.text, room, self.indent))


def wrapped(text: Text, room: int | None, indent: int) -> list[Text]:
    """Return the lines of a text, broken between words.

    Args:
        text: what to break.
        room: columns of a line; None: as many as it takes.
        indent: columns by which all lines but the first are indented.
    """
    breaks: list[int] = []
    used = len(text.plain) - len(text.plain.lstrip())
    for word in _WORD.finditer(text.plain):
        if room is not None and word.start() > indent and used + cell_len(word[1]) > room:
            breaks.append(word.start())
            used = indent
        used += cell_len(word[0])
    first, *others = text.divide(breaks)
    lines = [first, *(Text.assemble(" " * indent, line) for line in others)]
    for line in lines:
        line.rstrip()
    return lines


def _as_it_is(line: Text) -> Text:
    """Return a line that is neither wrapped nor cut once more."""
    line.no_wrap, line.overflow = True, "ignore"
    return line


@dataclass(frozen=True, slots=True)
class Row:
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
    rows: Sequence[Row]
    left: Sequence[int] = ()
    """Columns aligned to the left, as the names are; 1 is the first one behind them."""
    wraps_last: int = 0
    """Columns that the last cells have at least before they wrap; 0: they do not."""
    margin: int = 0
    gap: int = 2
    is_ruled: bool = False
    """Whether a line below the headings and blank ones around the table set it off."""
    heading_style: str = "bold"

    @property
    def width(self) -> int:
        """Columns that it takes if every row has a single line."""
        names = [cell_len(str(name)) for row in self.rows for name in row.names]
        cells = self._cell_widths(self.headings)
        return self.margin + max(names, default=0) + sum(cells) + self.gap * len(cells)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the lines of the table."""
        del console
        room = options.max_width
        _, widths = self._columns(room)
        is_tight = self.margin + sum(widths) + self.gap * (len(widths) - 1) > room
        table = replace(self, gap=1) if is_tight else self
        yield from map(_as_it_is, table._lines(room, ascii_only=options.ascii_only))  # noqa: SLF001 - our own

    def _lines(self, room: int, *, ascii_only: bool) -> Iterator[Text]:
        headings, widths = self._columns(room)
        length = min(sum(widths) + self.gap * (len(widths) - 1) + 2, room - self.margin + 1)
        ruler = ("-" if ascii_only else "─") * length
        if self.is_ruled:
            yield Text()
        for line in zip_longest(*(each.split("\n") for each in headings), fillvalue=""):
            yield self._line(Text(line[0]), line[1:], widths, self.heading_style)
        if self.is_ruled:
            yield Text(" " * (self.margin - 1) + ruler)
        for row in self.rows:
            yield from self._row(row, widths)
        if self.is_ruled:
            yield Text()

    def _columns(self, room: int) -> tuple[list[str], list[int]]:
        """Return the headings, in two lines where one does not fit, and the columns' widths."""
        names = [cell_len(str(name)) for row in self.rows for name in row.names]
        longest = max([*names, len(self.headings[0])])
        room -= self.margin + self.gap * (len(self.headings) - 1)
        headings = list(self.headings)
        cells = self._cell_widths(headings)
        if longest + sum(cells) > room:
            bare = self._cell_widths([""] * len(headings))
            for column, least in enumerate(bare, 1):
                if len(headings[column]) > least:
                    headings[column] = "\n".join(headings[column].rsplit(" ", 1))
            cells = self._cell_widths(headings)
        if self.wraps_last:
            cells[-1] = min(cells[-1], max(self.wraps_last, room - longest - sum(cells[:-1])))
        left = room - sum(cells)
        fitting = [name for name in names if name <= left]
        return headings, [max([*fitting, len(self.headings[0])]), *cells]

    def _cell_widths(self, headings: Sequence[str]) -> list[int]:
        columns = zip(*(row.cells for row in self.rows), strict=True) if self.rows else ()
        return [
            max(cell_len(line) for cell in (heading, *column) for line in cell.split("\n"))
            for heading, column in zip_longest(headings[1:], columns, fillvalue=())
        ]

    def _row(self, row: Row, widths: Sequence[int]) -> Iterator[Text]:
        names = [Text.assemble(name) for name in row.names]
        fitting = (number for number, name in enumerate(names) if name.cell_len <= widths[0])
        beside = next(fitting, len(names))
        *cells, last = row.cells
        further = [last] if any(row.cells) else []
        if self.wraps_last:
            further = [
                line.plain for each in further for line in wrapped(Text(each), widths[-1], 0)
            ]
        blank = [""] * len(cells)
        lines: list[Text] = []
        for name, more in zip_longest(names[beside:], further):
            shown = [*(blank if lines else cells), more or ""]
            lines.append(self._line(name or Text(), shown, widths, row.style))
        yield from (self._line(name, [*blank, ""], widths, row.style) for name in names[:beside])
        yield from lines

    def _line(self, name: Text, cells: Sequence[str], widths: Sequence[int], style: str) -> Text:
        line = Text(" " * self.margin, style=style)
        line.append_text(name)
        line.append(" " * (widths[0] - name.cell_len))
        for column, (cell, width) in enumerate(zip(cells, widths[1:], strict=True), 1):
            filler = " " * (width - cell_len(cell))
            line.append(" " * self.gap)
            line.append(cell + filler if column in self.left else filler + cell)
        line.rstrip()
        return line
