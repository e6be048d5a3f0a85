"""How far numbers may be apart, and which fields are looked at: by globs on topics and fields.

A field is named by its path without positions: ``entities.arrows.pose.position.z``. A glob is one
of ``TOPIC``, ``FIELD`` and ``TOPIC:FIELD``; ``*`` also stands for dots and slashes. What a log has
beside its messages is named like fields: ``profile``, ``metadata:NAME``, ``metadata:NAME.KEY`` and
``attachment:NAME``.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.toml_table import parse_toml, read_toml, shortened

_DEFAULT: Final = "default"


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Two numbers agree when ``|expected - actual| <= atol + rtol * |expected|``."""

    atol: float = 0.0
    """In the field's own unit."""
    rtol: float = 0.0


@dataclass(frozen=True, slots=True)
class Quantity:
    """Fields that share a tolerance: lengths, angles, forces ..."""

    name: str
    fields: tuple[str, ...]
    """Globs."""
    tolerance: Tolerance


@dataclass(frozen=True, slots=True)
class Rules:
    """Differences that a user allows."""

    default: Tolerance = Tolerance()
    """For every float that no quantity claims. Integers are exact unless a quantity claims them."""
    quantities: tuple[Quantity, ...] = ()
    """The first whose globs fit a field counts."""
    ignore: tuple[str, ...] = ()
    """Globs of topics and fields."""
    topics: tuple[str, ...] = ()
    """Globs of the topics to compare; none: all."""

    def takes(self, topic: str) -> bool:
        """Tell whether a topic is compared at all."""
        return (not self.topics or fits(self.topics, topic)) and not fits(self.ignore, topic)

    def ignoring(self, *globs: str) -> "Rules":
        """Return rules that ignore more."""
        return replace(self, ignore=(*self.ignore, *globs))


def fits(globs: Sequence[str], *names: str) -> bool:
    """Tell whether any of the globs fits any of the names."""
    return any(fnmatchcase(name, glob) for glob in globs for name in names)


class FieldRules:
    """The rules for one topic's fields; remembers what it was asked, for speed."""

    def __init__(self, rules: Rules, topic: str = "") -> None:
        self._rules = rules
        self._topic = topic
        self._claimed: dict[str, Tolerance | None] = {}
        self._ignored: dict[str, bool] = {}

    def ignored(self, name: str) -> bool:
        """Tell whether a field, and with it everything below, is left out."""
        if name not in self._ignored:
            self._ignored[name] = self._fit(self._rules.ignore, name)
        return self._ignored[name]

    def tolerance(self, name: str) -> Tolerance:
        """Return the tolerance of a float field."""
        return self.claimed(name) or self._rules.default

    def claimed(self, name: str) -> Tolerance | None:
        """Return the tolerance of the first quantity that names a field, None if none does."""
        if name not in self._claimed:
            fitting = [q.tolerance for q in self._rules.quantities if self._fit(q.fields, name)]
            self._claimed[name] = fitting[0] if fitting else None
        return self._claimed[name]

    def _fit(self, globs: Sequence[str], name: str) -> bool:
        return fits(globs, name, f"{self._topic}:{name}")


def nothing_left(rules: Rules, what: str) -> CallError:
    """Return the error of patterns that leave nothing: files must not pass for the same so."""
    if not rules.ignore:
        return CallError(f"--topics leaves no {what} to compare: {', '.join(rules.topics)}")
    return CallError(f"--ignore leaves no {what} to compare: {', '.join(rules.ignore)}")


def load_rules(
    atol: float | None,
    rtol: float | None,
    tolerances: Path | None,
    ignore: tuple[str, ...],
    topics: tuple[str, ...],
) -> Rules:
    """Put together what the options and the tolerance file say; an option beats the file.

    The file has a table a quantity, and ``[default]`` for what none of them claims::

        [metres]
        atol = 1e-6
        fields = ["*position*", "*translation*"]

    Raises:
        CallError: a tolerance is not one, or the file is not a tolerance file.
    """
    default = Tolerance()
    quantities: tuple[Quantity, ...] = ()
    if tolerances is not None:
        default, quantities = _load(tolerances)
    return Rules(
        Tolerance(
            default.atol if atol is None else _checked(atol, "--atol"),
            default.rtol if rtol is None else _checked(rtol, "--rtol"),
        ),
        quantities,
        ignore,
        topics,
    )


def _load(path: Path) -> tuple[Tolerance, tuple[Quantity, ...]]:
    document = parse_toml(read_toml(path, "a tolerance file"), str(path))
    default = Tolerance()
    quantities: list[Quantity] = []
    for name, table in document.items():
        if not isinstance(table, dict):
            raise CallError(f"{path}: {name} must be a table: [{name}]")
        quantity = _quantity(f"{path}: {name}", name, table)
        if name == _DEFAULT:
            default = quantity.tolerance
        else:
            quantities.append(quantity)
    return default, tuple(quantities)


def _quantity(where: str, name: str, table: Mapping[str, Any]) -> Quantity:
    known = {"atol", "rtol"} if name == _DEFAULT else {"atol", "rtol", "fields"}
    if strange := sorted(set(table) - known):
        raise CallError(f"{where}.{strange[0]}: not known; there may be {', '.join(sorted(known))}")
    fields = table.get("fields", [])
    if not isinstance(fields, list) or not all(isinstance(glob, str) for glob in fields):
        raise CallError(f"{where}.fields must be a list of globs")
    if not fields and name != _DEFAULT:
        raise CallError(f"{where}.fields is missing: which fields is it for?")
    tolerance = Tolerance(
        _checked(table.get("atol", 0.0), f"{where}.atol"),
        _checked(table.get("rtol", 0.0), f"{where}.rtol"),
    )
    return Quantity(name, tuple(fields), tolerance)


def _checked(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CallError(f"{where} is {shortened(value)}; it must be a number")
    if not 0 <= value <= sys.float_info.max:
        raise CallError(f"{where} is {shortened(value)}; it must be a finite number, 0 or more")
    return float(value)
