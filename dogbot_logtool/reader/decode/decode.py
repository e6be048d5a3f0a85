"""The columnar decoder: all messages of a type in a batch are decoded at once.

A walk over the compiled layout moves one cursor a message through the bytes. Loops run over
the steps of the layout and over positions in arrays, never over messages. Every length is
checked against the bytes that are there before it is used; a message that fails is marked and
leaves its neighbours alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Bytes, Flags, Ints
from dogbot_logtool.reader.decode.columns import Nested, Rows, Table, Texts, gather
from dogbot_logtool.reader.decode.message_layout import ArrayStep, Layout, Run, Step, TextStep

MAX_VARIABLE_ELEMENTS: Final = 20_000
"""A message with a longer array of elements of varying size counts as malformed. So do those whose
arrays within arrays take more rounds than this."""
_COUNT: Final = 4
"""Bytes of a length or a count."""
_CDR_HEADER: Final = 4
_CDR_PADDING: Final = 3


def decode(layout: Layout, buffer: Bytes, start: Ints, end: Ints) -> tuple[Table, Flags]:
    """Decode messages of one type.

    Args:
        layout: of their type.
        buffer: (b,) uint8, contiguous.
        start: (n,) where each message's bytes begin in the buffer.
        end: (n,) where they end; start <= end <= b.

    Returns:
        the messages that were decoded, in order; and (n,) which these are. The others are
        malformed.
    """
    big_endian = False
    sound = np.ones(len(start), np.bool_)
    if layout.serialisation == "cdr":
        sound, big_endian = _read_encapsulation(buffer, start, end)
    table, walked = _Walk(layout, buffer, big_endian=big_endian).messages(start[sound], end[sound])
    if not walked.all():
        sound[sound] = walked
        table, _ = _Walk(layout, buffer, big_endian=big_endian).messages(start[sound], end[sound])
    return table, sound


def _read_encapsulation(buffer: Bytes, start: Ints, end: Ints) -> tuple[Flags, bool]:
    """Tell which messages have a plain CDR header, and the byte order of them all."""
    sound = end - start >= _CDR_HEADER
    if not sound.any():
        return sound, False
    head = gather(buffer, start[sound], 2).view(np.uint8).reshape(-1, 2)
    plain = (head[:, 0] == 0) & (head[:, 1] <= 1)
    # One sender writes one byte order; a message in another one is not trusted.
    big_endian = 2 * int((head[plain, 1] == 0).sum()) > int(plain.sum())
    sound[sound] = plain & (head[:, 1] == (0 if big_endian else 1))
    return sound, big_endian


@dataclass(slots=True)
class _Cursors:
    """Offset reached in each row: messages, or one element each of some messages."""

    position: Ints
    limit: Ints
    """End of the row's message."""
    origin: Ints
    """Offset that alignment counts from."""
    message: Ints

    def pick(self, rows: Ints) -> "_Cursors":
        return _Cursors(
            self.position[rows], self.limit[rows], self.origin[rows], self.message[rows]
        )


class _Walk:
    """One pass over the bytes of some messages."""

    def __init__(self, layout: Layout, buffer: Bytes, *, big_endian: bool) -> None:
        self._layout = layout
        self._buffer = buffer
        self._cdr = layout.serialisation == "cdr"
        self._order = ">" if big_endian else "<"
        self._rounds = 0
        """In which a next element of some messages was found."""
        self._sound: Flags = np.ones(0, np.bool_)

    def messages(self, start: Ints, end: Ints) -> tuple[Table, Flags]:
        """Decode whole messages: the table has a row each, void where the flag is false."""
        self._sound = np.ones(len(start), np.bool_)
        origin = start + _CDR_HEADER if self._cdr else start
        cursors = _Cursors(origin, end, origin, np.arange(len(start)))
        table = self._rows(self._layout.steps, cursors, wanted=True)
        left_over = end - cursors.position
        self._fail(cursors, (left_over < 0) | (left_over > (_CDR_PADDING if self._cdr else 0)))
        return table, self._sound

    def _rows(self, steps: tuple[Step, ...], cursors: _Cursors, *, wanted: bool) -> Table:
        """Return what is wanted of each row, and step over it all."""
        runs: list[Rows] = []
        columns: dict[str, Texts | Nested] = {}
        for step in steps:
            match step:
                case Run():
                    runs.extend(self._run(step, cursors, wanted=wanted))
                case TextStep():
                    texts = self._text(step, cursors)
                    if wanted and step.wanted:
                        columns[step.path] = texts
                case ArrayStep():
                    nested = self._array(step, cursors, wanted=wanted and step.wanted)
                    if nested is not None:
                        columns[step.path] = nested
        return Table(len(cursors.position), tuple(runs), columns)

    def _run(self, run: Run, cursors: _Cursors, *, wanted: bool) -> Sequence[Rows]:
        self._align(cursors, run.alignment)
        self._require(cursors, run.size)
        start = cursors.position
        cursors.position = start + run.size
        if run.size > len(self._buffer):
            # Every row has failed, so the table will be thrown away: it need not have its rows.
            start = start[:0]
        return self._numbers(run, start) if wanted else ()

    def _numbers(self, run: Run, start: Ints) -> Sequence[Rows]:
        """Return the numbers of a run that are wanted, if any are."""
        if run.wanted is None:
            return ()
        dtype = run.wanted if self._order == "<" else run.wanted.newbyteorder(">")
        return (self._gather(start + run.first, dtype.itemsize).view(dtype),)

    def _text(self, step: TextStep, cursors: _Cursors) -> Texts:
        length = self._counts(cursors, step.alignment)
        self._limit(cursors, length, 1)
        start = cursors.position
        cursors.position = start + length
        if self._cdr:
            # The recorded length includes the terminator, which must be there.
            present = np.flatnonzero(length > 0)
            last = self._gather(cursors.position[present] - 1, 1).view(np.uint8)
            if last.any():
                self._fail(cursors.pick(present), last != 0)
            length = np.maximum(length - 1, 0)
        return Texts(self._buffer, start, length)

    def _array(self, step: ArrayStep, cursors: _Cursors, *, wanted: bool) -> Nested | None:
        """Step over arrays; return their elements, row by row, if they are wanted."""
        if step.length is None:
            count = self._counts(cursors, step.alignment)
        else:
            count = np.full(len(cursors.position), step.length, np.int64)
        match step.element:
            case (Run() as run,):
                return self._even_elements(run, count, cursors, wanted=wanted)
        self._limit(cursors, count, step.smallest_element)
        parent, start = self._element_starts(step.element, count, cursors)
        last = np.flatnonzero(np.diff(parent, append=-1))
        chosen = slice(None) if wanted else last
        elements = cursors.pick(parent[chosen])
        elements.position = start[chosen]
        table = self._rows(step.element, elements, wanted=wanted)
        cursors.position[parent[last]] = elements.position[last] if wanted else elements.position
        return Nested(parent, table) if wanted else None

    def _even_elements(
        self, run: Run, count: Ints, cursors: _Cursors, *, wanted: bool
    ) -> Nested | None:
        """Elements of one size: all at once."""
        if run.alignment > 1:
            filled = np.flatnonzero(count)
            aligned = cursors.pick(filled)
            self._align(aligned, run.alignment)
            cursors.position = cursors.position.copy()
            cursors.position[filled] = aligned.position
        padding = -run.size % run.alignment
        stride = run.size + padding
        self._limit(cursors, count, stride, last=run.size)
        start, size = cursors.position, count * stride
        cursors.position = start + size
        if padding:
            # None behind the last one.
            cursors.position -= (count > 0) * padding
        if not wanted:
            return None
        parent = np.repeat(np.arange(len(count)), count)
        # Elements are numbered through all rows; a row's first stands at the row's start.
        origin = start - (np.cumsum(size) - size)
        elements = self._numbers(run, origin[parent] + np.arange(len(parent)) * stride)
        return Nested(parent, Table(len(parent), tuple(elements), {}))

    def _element_starts(
        self, steps: tuple[Step, ...], count: Ints, cursors: _Cursors
    ) -> tuple[Ints, Ints]:
        """Find elements of varying size: all messages' first ones, all second ones, and so on.

        The last one is left to be stepped over.

        Returns:
            (m,) row and (m,) offset of each element, row by row.
        """
        self._fail(cursors, count > MAX_VARIABLE_ELEMENTS)
        self._void_failed(count, cursors)
        parent, first = np.repeat(np.arange(len(count)), count), np.cumsum(count) - count
        start = np.zeros(len(parent), np.int64)
        # What was read before keeps its offsets.
        cursors.position = cursors.position.copy()
        index, rows = 0, np.flatnonzero(count)
        start[first[rows]] = cursors.position[rows]
        rows = rows[count[rows] > 1]
        while len(rows):
            self._rounds += 1
            if self._rounds > MAX_VARIABLE_ELEMENTS:
                self._sound[cursors.message[rows]] = False
                break
            elements = cursors.pick(rows)
            self._rows(steps, elements, wanted=False)
            cursors.position[rows] = elements.position
            index += 1
            start[first[rows] + index] = elements.position
            rows = rows[(count[rows] > index + 1) & self._sound[cursors.message[rows]]]
        if self._sound.all():
            return parent, start
        sound = self._sound[cursors.message[parent]]
        return parent[sound], start[sound]

    def _counts(self, cursors: _Cursors, alignment: int) -> Ints:
        """Read a 32-bit count and step over it; 0 for messages that have failed."""
        self._align(cursors, alignment)
        self._require(cursors, _COUNT)
        count = self._gather(cursors.position, _COUNT).view(self._order + "u4").astype(np.int64)
        cursors.position = cursors.position + _COUNT
        self._void_failed(count, cursors)
        return count

    def _align(self, cursors: _Cursors, alignment: int) -> None:
        if alignment > 1:
            position = cursors.position
            cursors.position = position + ((cursors.origin - position) & (alignment - 1))

    def _require(self, cursors: _Cursors, size: int) -> None:
        """Fail messages that have fewer bytes left, and send their cursors to a safe offset."""
        short = cursors.position + size > cursors.limit
        if short.any():
            self._fail(cursors, short)
            cursors.position = np.where(short, 0, cursors.position)

    def _limit(self, cursors: _Cursors, count: Ints, size: int, last: int | None = None) -> None:
        """Fail messages that claim more elements than their bytes can hold; void the count."""
        left = cursors.limit - cursors.position
        if last is not None:
            left += size - last
        excess = (count * size > left) & (count > 0)
        if excess.any():
            self._fail(cursors, excess)
            self._void_failed(count, cursors)

    def _fail(self, cursors: _Cursors, rows: Flags) -> None:
        if rows.any():
            self._sound[cursors.message[rows]] = False

    def _void_failed(self, count: Ints, cursors: _Cursors) -> None:
        if not self._sound.all():
            count[~self._sound[cursors.message]] = 0

    def _gather(self, start: Ints, size: int) -> NDArray[np.void]:
        if size > len(self._buffer):
            # Nothing is this long: every message has failed, and what it holds is void.
            return np.zeros(len(start), f"V{size}")
        return gather(self._buffer, start, size)
