"""JSON as every reader takes it: the one place where the package writes any."""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from typing import Any, Final

Json = Any
"""None, bool, int, float or str; or lists, tuples and mappings of them."""
_PLAIN: Final = frozenset({bool, int, float, str, type(None)})


def to_json(value: Json, *, indent: int | None = None, compact: bool = False) -> str:
    """Write a value; numbers that are not finite, which JSON does not have, become null.

    Args:
        value: what is written.
        indent: spaces of each level; None: all in one line.
        compact: without spaces.
    """
    separators = (",", ":") if compact else None
    write: Callable[[Json], str] = partial(json.dumps, separators=separators, allow_nan=False)
    if indent is not None:
        write = partial(_in_lines, step=" " * indent)
    try:
        return write(value)
    except (TypeError, ValueError):
        return write(only_finite(value))


def _in_lines(value: Json, step: str, begin: str = "\n") -> str:
    """Write a value as `json.dumps` does with an indent: Python 3.11 indents in Python, this in C.

    Args:
        value: what is written.
        step: begins one level more.
        begin: ends a line, and begins the next one of this level.
    """
    if not isinstance(value, dict | list | tuple) or not value:
        return _writer("")(value)
    inner, among = begin + step, value.values() if isinstance(value, dict) else value
    if _PLAIN.issuperset(map(type, among)):
        text = _writer(inner)(value)
        return f"{text[0]}{inner}{text[1:-1]}{begin}{text[-1]}"
    plain = [type(each) in _PLAIN for each in among]
    holes = [each if known else 0 for each, known in zip(among, plain, strict=True)]
    text = _writer(inner)(
        dict(zip(value, holes, strict=True)) if isinstance(value, dict) else holes
    )
    # No text holds the end of a line, so that only items are parted here.
    items = [
        item if known else item[:-1] + _in_lines(each, step, inner)
        for item, each, known in zip(text[1:-1].split("," + inner), among, plain, strict=True)
    ]
    return text[0] + inner + ("," + inner).join(items) + begin + text[-1]


@cache
def _writer(begin: str) -> Callable[[Json], str]:
    """Return what writes plain values, each of them in a line that begins so."""
    return json.JSONEncoder(separators=("," + begin, ": "), allow_nan=False).encode


def only_finite(value: Json) -> Json:
    """Return a copy with None for every number that is not finite."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, Mapping):
        return {key: only_finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [only_finite(each) for each in value]
    return value


def not_finite(value: Json, path: str = "") -> Iterator[str]:
    """Yield the dotted paths of the numbers that are not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        yield path
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from not_finite(each, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple):
        for row, each in enumerate(value):
            yield from not_finite(each, f"{path}[{row}]")
