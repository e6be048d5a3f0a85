"""Stepping over single elements of varying size, without decoding them."""

import struct
from typing import Final, NamedTuple

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.decode.message_layout import ArrayStep, Run, Step, TextStep

MAX_VARIABLE_ELEMENTS: Final = 20_000
"""A message with a longer array of elements of varying size counts as malformed."""


class ElementSkipper:
    """Finds where the elements of an array end."""

    def __init__(self, steps: tuple[Step, ...], buffer: Bytes, order: str) -> None:
        """Take an element's steps, the bytes of messages, and the byte order as a dtype has it."""
        self._moves = [_move(step) for step in steps]
        self._data = buffer.data
        self._read = struct.Struct(order + "I").unpack_from

    def skip(self, position: int, origin: int, limit: int) -> int:
        """Return the offset behind an element, or one beyond the limit if it does not fit.

        Args:
            position: where it begins.
            origin: offset that alignment counts from.
            limit: end of its message.
        """
        return self._skip(self._moves, position, origin, limit)

    def _skip(self, moves: "list[_Move]", position: int, origin: int, limit: int) -> int:
        for alignment, length, inner_alignment, stride, padding, inside in moves:
            position += (origin - position) & (alignment - 1)
            count = length
            if count is None:
                if position + 4 > limit:
                    return limit + 1
                (count,) = self._read(self._data, position)
                position += 4
            if inside is not None:
                if count > MAX_VARIABLE_ELEMENTS:
                    return limit + 1
                for _ in range(count):
                    position = self._skip(inside, position, origin, limit)
                    if position > limit:
                        break
            elif count:
                position += (origin - position) & (inner_alignment - 1)
                position += count * stride - padding
            if position > limit:
                return limit + 1
        return position


class _Move(NamedTuple):
    """How a step moves on: over as many elements of one size, or of varying sizes."""

    alignment: int
    length: int | None
    """Elements; None: a 32-bit count is recorded."""
    inner_alignment: int
    """Of the first element."""
    stride: int
    """Bytes from an element to the next; the last one lacks `padding` of them."""
    padding: int
    inside: "list[_Move] | None"
    """How to move over an element of varying size; None: all take one size."""


def _move(step: Step) -> _Move:
    match step:
        case Run(alignment, size):
            return _Move(alignment, 1, 1, size, 0, None)
        case TextStep(_, _, alignment):
            return _Move(alignment, None, 1, 1, 0, None)
        case ArrayStep(element=(Run(alignment, size),)):
            padding = -size % alignment
            return _Move(step.alignment, step.length, alignment, size + padding, padding, None)
    inside = [_move(each) for each in step.element] if step.smallest_element else None
    return _Move(step.alignment, step.length, 1, 0, 0, inside)
