"""How far numbers may be apart, and which fields are looked at: by globs on topics and fields.

A field is named by its path without positions: ``entities.arrows.pose.position.z``. A glob is one
of ``TOPIC``, ``FIELD`` and ``TOPIC:FIELD``; ``*`` also stands for dots and slashes. What a log has
beside its messages is named like fields: ``profile``, ``metadata:NAME``, ``metadata:NAME.KEY`` and
``attachment:NAME``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.toml_table import parse_toml, read_toml, toml_number

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
    ignore: Sequence[str] = ()
    """Globs of topics and fields."""
    topics: Sequence[str] = ()
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
    ignore: Sequence[str],
    topics: Sequence[str],
) -> Rules:
    """Put together what the options and the tolerance file say; an option beats the file.

    The file has a table a quantity, and ``[default]`` for what none of them claims::

        [metres]
        atol = 1e-6
        fields = ["*position*", "*translation*"]

    Raises:
        CallError: the file is not a tolerance file.
    """
    quantities = {} if tolerances is None else _load(tolerances)
    default = quantities.pop(_DEFAULT, Quantity((), Tolerance())).tolerance
    default = Tolerance(
        default.atol if atol is None else atol, default.rtol if rtol is None else rtol
    )
    return Rules(default, tuple(quantities.values()), ignore, topics)


def _load(path: Path) -> dict[str, Quantity]:
    document = parse_toml(read_toml(path, "a tolerance file"), str(path))
    return {name: _quantity(f"{path}: {name}", name, each) for name, each in document.items()}


def _quantity(where: str, name: str, table: Any) -> Quantity:  # noqa: ANN401 - any TOML value
    if not isinstance(table, dict):
        raise CallError(f"{where} must be a table: [{name}]")
    known = {"atol", "rtol"} if name == _DEFAULT else {"atol", "rtol", "fields"}
    if strange := sorted(table.keys() - known):
        raise CallError(f"{where}.{strange[0]}: not known; there may be {', '.join(sorted(known))}")
    fields = table.get("fields", [])
    if not isinstance(fields, list) or not all(isinstance(glob, str) for glob in fields):
        raise CallError(f"{where}.fields must be a list of globs")
    if not fields and name != _DEFAULT:
        raise CallError(f"{where}.fields is missing: which fields is it for?")
    atol, rtol = (toml_number(table.get(key, 0), f"{where}.{key}", 0.0) for key in ("atol", "rtol"))
    return Quantity(tuple(fields), Tolerance(atol, rtol))
