"""TOML whose errors name the key, and records whose fields stand in it."""

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, fields
from pathlib import Path
from typing import Any, Final, NamedTuple

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import content

_LARGEST: Final = 256 << 10
"""Bytes; a file that a person wrote has some thousands."""
_MOST: Final = 1e12
"""Of numbers: no bytes, newtons or seconds are more."""
_LONGEST_VALUE: Final = 60
"""Characters of a value that a sentence shows."""
_LONG_KEY: Final = re.compile(
    r"""(?<![\w"'-])(?:(?:"[^"\n]*"|'[^'\n]*'|[\w-]+)[ \t]*\.[ \t]*){16}"""
)
"""A key of so many parts takes the parser's time and memory by their square."""


def read_text(path: Path, what: str, largest: int = _LARGEST) -> str:
    """Read the text of a file that a person wrote.

    Args:
        path: the file.
        what: what it should be: ``"a robot's file"``.
        largest: bytes that it may have.

    Raises:
        CallError: it cannot be read, or is not such a file.
    """
    try:
        return content(path, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CallError(f"{path}: cannot be read as {what}: it is not UTF-8 text") from error


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Parse TOML.

    Args:
        text: the TOML.
        source: what to call it in errors.

    Raises:
        CallError: it is not TOML; the sentence gives line and column.
    """
    if (key := _LONG_KEY.search(text)) is not None:
        line = text.count("\n", 0, key.start()) + 1
        raise CallError(f"{source}, line {line}: a key has more than 16 parts")
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise CallError(f"{source}: not valid TOML: its values are nested too deeply") from error
    except ValueError as error:  # also of more digits than Python converts
        raise CallError(f"{source}: not valid TOML: {error}") from error


def shortened(value: object) -> str:
    """Return a value as a sentence shows it."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return "too long to show"
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."


def by_key(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return the values of a table and of those in it by their dotted keys: ``contact.on_n``."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, dict):
            found |= by_key(value, f"{prefix}{key}.")
        else:
            found[prefix + key] = value
    return found


class Kind(NamedTuple):
    """What the value of a key must be."""

    wanted: str
    """To end a sentence with."""
    is_right: Callable[[Any], bool]
    converted: Callable[[Any], Any] = lambda value: value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < _MOST


def _is_vector(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))


def _is_frame(value: object) -> bool:
    return isinstance(value, str) and value != "" and not value.startswith("/")


TEXT: Final = Kind("a text", lambda value: isinstance(value, str))
FRAME: Final = Kind("a frame name without a leading slash", _is_frame)
NUMBER: Final = Kind("a finite number", _is_number, float)
POSITIVE: Final = Kind("a number above 0", lambda value: _is_number(value) and value > 0, float)
NOT_NEGATIVE: Final = Kind("a number from 0", lambda value: _is_number(value) and value >= 0, float)
NOT_ZERO: Final = Kind("a number other than 0", lambda value: _is_number(value) and value, float)
COUNT: Final = Kind(
    "an index into an array, counted from 0",
    lambda value: type(value) is int and 0 <= value < 100,
)
VECTOR: Final = Kind(
    "three numbers such as [0.0, 0.0, -0.02]",
    _is_vector,
    lambda value: tuple(map(float, value)),
)


def one_of(*choices: str) -> Kind:
    """Return the kind of some words."""
    return Kind(f"one of {', '.join(choices)}", lambda value: value in choices)


def toml_field(
    kind: Kind,
    default: Any = None,  # noqa: ANN401 - that of any field
    *,
    key: str = "",
) -> Any:  # noqa: ANN401 - as `dataclasses.field`
    """Declare a field of a data class that stands in a TOML table.

    Args:
        kind: of its value.
        default: the field's value without one in the file.
        key: with the tables that it stands in, as in ``contact.on_n``; empty: the field's name.
    """
    return field(default=default, metadata={"kind": kind, "key": key})


def take_fields(record: type[Any], values: dict[str, Any], where: str) -> dict[str, Any]:
    """Take the values of a data class's fields, by the fields' names.

    Args:
        record: the data class.
        values: see `by_key`; those that are none of the record's remain.
        where: what stands before a key in errors.

    Raises:
        CallError: a value is not what it must be.
    """
    return {
        name: checked(values.pop(key), kind, where + key)
        for name, kind, key in declared_fields(record)
        if key in values
    }


def checked(value: object, kind: "Kind", where: str) -> Any:  # noqa: ANN401 - that of a field
    """Return a value as its field holds it.

    Raises:
        CallError: it is not what it must be; the sentence begins with `where`.
    """
    if not kind.is_right(value):
        raise CallError(f"{where} is {shortened(value)}; it must be {kind.wanted}")
    return kind.converted(value)


def toml_values(record: Any) -> dict[str, str]:  # noqa: ANN401 - any data class
    """Return the values of a data class's fields as TOML, by key; none that are the default."""
    plain = {each.name: each.default for each in fields(record)}
    return {
        key: to_toml(value)
        for name, _, key in declared_fields(type(record))
        if (value := getattr(record, name)) != plain[name]
    }


def to_toml(value: object) -> str:
    """Return a text, a number or a sequence of these as TOML."""
    if isinstance(value, str):
        # TOML's basic strings are JSON's, but for one more character that must be escaped.
        return json.dumps(value).replace("\x7f", "\\u007f")
    if isinstance(value, tuple):
        return f"[{', '.join(map(to_toml, value))}]"
    return repr(value)


def declared_fields(record: type[Any]) -> Iterator[tuple[str, Kind, str]]:
    """Yield the fields that stand in a file: name, kind, and key with the tables that it is in."""
    for each in fields(record):
        if kind := each.metadata.get("kind"):
            yield each.name, kind, each.metadata["key"] or each.name
