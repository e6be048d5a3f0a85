"""JSON as every reader takes it: the one place where the package writes any."""

import json
import math
from collections.abc import Mapping
from functools import partial
from typing import Any

Json = Any
"""None, bool, int, float or str; or lists, tuples and mappings of them."""


def to_json(value: Json, *, indent: int | None = None, compact: bool = False) -> str:
    """Write a value; numbers that are not finite, which JSON does not have, become null.

    Args:
        value: what is written.
        indent: spaces of each level; None: all in one line.
        compact: without spaces.
    """
    separators = (",", ":") if compact else None
    write = partial(json.dumps, indent=indent, separators=separators, allow_nan=False)
    try:
        return write(value)
    except (TypeError, ValueError):
        return write(only_finite(value))


def only_finite(value: Json) -> Json:
    """Return a copy with None for every number that is not finite."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: only_finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [only_finite(each) for each in value]
    return value
