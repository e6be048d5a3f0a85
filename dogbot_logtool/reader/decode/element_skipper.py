"""Stepping over single elements of varying size, without decoding them."""

from collections.abc import Callable
from typing import Final

from dogbot_logtool.reader.decode.message_layout import ArrayStep, Run, Step, TextStep

MAX_VARIABLE_ELEMENTS: Final = 20_000
"""A message with a longer array of elements of varying size counts as malformed."""
ReadCount = Callable[[int], tuple[int]]
"""Reads the 32-bit count at an offset."""


def skip_element(
    steps: tuple[Step, ...], read: ReadCount, position: int, origin: int, limit: int
) -> int:
    """Return the offset behind an element, or one beyond the limit if it does not fit.

    Args:
        steps: of the element.
        read: reads a count in the messages' bytes.
        position: where the element begins.
        origin: offset that alignment counts from.
        limit: end of its message.
    """
    for step in steps:
        position += (origin - position) & (step.alignment - 1)
        if isinstance(step, Run):
            position += step.size
            continue
        count = step.length if isinstance(step, ArrayStep) else None
        if count is None:
            if position + 4 > limit:
                return limit + 1
            (count,) = read(position)
            position += 4
        if isinstance(step, TextStep):
            position += count
        elif count and step.smallest_element:
            position = _skip_array(step.element, count, read, position, origin, limit)
        if position > limit:
            return limit + 1
    return position


def _skip_array(
    steps: tuple[Step, ...], count: int, read: ReadCount, position: int, origin: int, limit: int
) -> int:
    """Step over the elements of an array; see `skip_element`."""
    if len(steps) == 1 and isinstance(steps[0], Run):
        alignment, size = steps[0].alignment, steps[0].size
        first = position + ((origin - position) & (alignment - 1))
        return first + (count - 1) * (size + -size % alignment) + size
    if count > MAX_VARIABLE_ELEMENTS:
        return limit + 1
    for _ in range(count):
        position = skip_element(steps, read, position, origin, limit)
        if position > limit:
            break
    return position
