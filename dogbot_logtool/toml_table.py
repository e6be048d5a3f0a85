"""TOML tables whose every fault is told by key and line."""

import tomllib
from collections.abc import Sequence
from typing import Any

from dogbot_logtool.errors import CallError


class TomlFile:
    """A parsed TOML file that knows where its keys stand."""

    def __init__(self, text: str, source: str) -> None:
        """Parse.

        Args:
            text: the TOML.
            source: what to call it in errors.

        Raises:
            CallError: it is no TOML; the sentence gives line and column.
        """
        self._lines = text.splitlines()
        self._source = source
        try:
            self.values = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise CallError(f"{source}: not valid TOML: {error}") from error

    def fault(self, keys: Sequence[str], text: str) -> CallError:
        """Return the error of a key.

        Args:
            keys: where it stands: ``("feet", "left", "topic")``.
            text: what is wrong, a sentence that follows the place.
        """
        line = self._line_of(keys)
        place = self._source if line is None else f"{self._source}, line {line}"
        return CallError(f"{place}: {text}")

    def _line_of(self, keys: Sequence[str]) -> int | None:
        """Return the first line of what defines a key; None: nothing does.

        The parser keeps no lines, so it is asked: what defines a key ends with the first line up
        to which the file is valid TOML that has the key, and begins after the last line up to
        which it is valid without. Once there, a key stays, so both are found by halving.
        """
        without, having = 0, len(self._lines)
        if not self._has(having, keys):
            return None
        while having - without > 1:
            middle = (without + having) // 2
            # Halfway may be inside a value of several lines.
            valid = next((n for n in range(middle, having) if self._parsed(n) is not None), having)
            if valid == having:
                earlier = range(middle - 1, without, -1)
                valid = next((n for n in earlier if self._parsed(n) is not None), without)
                if valid == without:
                    break
            if self._has(valid, keys):
                having = valid
            else:
                without = valid
        return without + 1

    def _parsed(self, lines: int) -> dict[str, Any] | None:
        """Return what the first lines hold; None where they break off inside a value."""
        try:
            return tomllib.loads("\n".join(self._lines[:lines]))
        except tomllib.TOMLDecodeError:
            return None

    def _has(self, lines: int, keys: Sequence[str]) -> bool:
        value: Any = self._parsed(lines)
        for key in keys:
            if not isinstance(value, dict) or key not in value:
                return False
            value = value[key]
        return True


class TomlTable:
    """A table whose keys are taken out one by one, so that unknown keys remain and show."""

    def __init__(self, file: TomlFile, keys: tuple[str, ...] = ()) -> None:
        self._file = file
        self._keys = keys
        values: Any = file.values
        for key in keys:
            values = values.get(key, {})
        self._values: dict[str, Any] = dict(values)

    @property
    def names(self) -> tuple[str, ...]:
        """Keys that have not been taken."""
        return tuple(self._values)

    def fault(self, key: str, text: str) -> CallError:
        """Return the error of a key; without one, of the table itself."""
        return self._file.fault((*self._keys, key) if key else self._keys, text)

    def path(self, key: str) -> str:
        """Return a key with the tables that it stands in."""
        return ".".join((*self._keys, key))

    def section(self, key: str) -> "TomlTable":
        """Take a table; an empty one where there is none."""
        value = self._values.pop(key, {})
        if not isinstance(value, dict):
            raise self._wrong(key, value, "a table")
        return TomlTable(self._file, (*self._keys, key))

    def text(self, key: str) -> str | None:
        """Take a text."""
        value = self._values.pop(key, None)
        if value is not None and not isinstance(value, str):
            raise self._wrong(key, value, "a text")
        return value

    def frame(self, key: str) -> str | None:
        """Take a frame id."""
        value = self.text(key)
        if value is not None and (not value or value.startswith("/")):
            raise self._wrong(key, value, "a frame name without a leading slash")
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str | None:
        """Take one of some words."""
        value = self.text(key)
        if value is not None and value not in choices:
            raise self._wrong(key, value, f"one of {', '.join(choices)}")
        return value

    def positive(self, key: str) -> float | None:
        """Take a number above 0."""
        value = self._values.pop(key, None)
        if value is None:
            return None
        if not _is_number(value) or value <= 0:
            raise self._wrong(key, value, "a number above 0")
        return float(value)

    def number(self, key: str) -> float | None:
        """Take a number."""
        value = self._values.pop(key, None)
        if value is None:
            return None
        if not _is_number(value):
            raise self._wrong(key, value, "a number")
        return float(value)

    def count(self, key: str) -> int | None:
        """Take a place in an array."""
        value = self._values.pop(key, None)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 100:
            raise self._wrong(key, value, "a place in an array, counted from 0")
        return value

    def vector(self, key: str) -> tuple[float, float, float] | None:
        """Take x, y and z."""
        value = self._values.pop(key, None)
        if value is None:
            return None
        if not isinstance(value, list) or len(value) != 3 or not all(map(_is_number, value)):
            raise self._wrong(key, value, "three numbers such as [0.0, 0.0, -0.02]")
        x, y, z = map(float, value)
        return x, y, z

    def words(
        self, key: str, choices: tuple[frozenset[str], frozenset[str]], example: str
    ) -> tuple[str, str] | None:
        """Take a pair of words, each one of its own choices."""
        value = self._values.pop(key, None)
        if value is None:
            return None
        match value:
            case [str(first), str(second)] if first in choices[0] and second in choices[1]:
                return first, second
        raise self._wrong(key, value, f"a pair such as {example}")

    def refuse_leftovers(self, hint: str) -> None:
        """Refuse keys that nobody took.

        Raises:
            CallError: there is one; `hint` ends the sentence.
        """
        for key in self._values:
            raise self.fault(key, f"the key {self.path(key)} is not known. {hint}")

    def _wrong(self, key: str, value: object, wanted: str) -> CallError:
        return self.fault(key, f"{self.path(key)} is {value!r}; it must be {wanted}")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9
