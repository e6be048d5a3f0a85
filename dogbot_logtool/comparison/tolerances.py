"""How far numbers may be apart, and which fields are looked at: by globs on topics and fields.

A field is named by its path without positions: ``entities.arrows.pose.position.z``. A glob is one
of ``TOPIC``, ``FIELD`` and ``TOPIC:FIELD``; ``*`` also stands for dots and slashes. What a log has
beside its messages is named like fields: ``profile``, ``metadata:NAME``, ``metadata:NAME.KEY`` and
``attachment:NAME``.
"""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from functools import cache, partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.toml_table import NOT_NEGATIVE, checked, parse_toml, read_text

_DEFAULT: Final = "default"


class Tolerance(NamedTuple):
    """Two numbers agree when ``|expected - actual| <= atol + rtol * |expected|``."""

    atol: float = 0.0
    """In the field's own unit."""
    rtol: float = 0.0
    fields: tuple[str, ...] = ()
    """Globs of the fields that share it: lengths, angles, forces ..."""


class Rules(NamedTuple):
    """Differences that a user allows."""

    default: Tolerance = Tolerance()
    """For every float that no other claims. Integers are exact unless one claims them."""
    tolerances: tuple[Tolerance, ...] = ()
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
        return self._replace(ignore=(*self.ignore, *globs))

    def refuse_nothing(self, what: str) -> None:
        """Refuse patterns that leave nothing: files must not pass for the same so.

        Raises:
            CallError: there are such patterns.
        """
        for option, globs in (("--ignore", self.ignore), ("--topics", self.topics)):
            if globs:
                raise CallError(f"{option} leaves no {what} to compare: {', '.join(globs)}")


def fits(globs: Sequence[str], *names: str) -> bool:
    """Tell whether any of the globs fits any of the names."""
    return any(fnmatchcase(name, glob) for glob in globs for name in names)


class FieldRules:
    """The rules for one topic's fields; remembers what it was asked, for speed."""

    def __init__(self, rules: Rules, topic: str = "") -> None:
        def fit(globs: Sequence[str], name: str) -> bool:
            return fits(globs, name, f"{topic}:{name}")

        def claimed(name: str) -> Tolerance | None:
            return next((each for each in rules.tolerances if fit(each.fields, name)), None)

        self.default = rules.default
        """The tolerance of a float field that no other names."""
        self.ignored = cache(partial(fit, rules.ignore))
        """Tells whether a field, and with it everything below, is left out."""
        self.claimed = cache(claimed)
        """Returns the first tolerance that names a field, None if none does."""


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
    document = {}
    if tolerances is not None:
        document = parse_toml(read_text(tolerances, "a tolerance file"), str(tolerances))
    found = {name: _tolerance(f"{tolerances}: {name}", name, document[name]) for name in document}
    default = found.pop(_DEFAULT, Tolerance())
    default = default._replace(atol=default.atol if atol is None else atol)
    default = default._replace(rtol=default.rtol if rtol is None else rtol)
    return Rules(default, tuple(found.values()), ignore, topics)


def _tolerance(where: str, name: str, table: Any) -> Tolerance:  # noqa: ANN401 - any TOML value
    if not isinstance(table, dict):
        raise CallError(f"{where} must be a table: [{name}]")
    known = {"atol", "rtol"} if name == _DEFAULT else {"atol", "rtol", "fields"}
    if strange := sorted(table.keys() - known):
        raise CallError(f"{where}.{strange[0]}: not known; there may be {', '.join(sorted(known))}")
    fields = table.get("fields", ["*"] if name == _DEFAULT else [])
    if not isinstance(fields, list) or not fields or not all(isinstance(f, str) for f in fields):
        raise CallError(f"{where}.fields must be a list of globs: which fields is it for?")
    numbers = {
        key: checked(table.get(key, 0), NOT_NEGATIVE, f"{where}.{key}") for key in ("atol", "rtol")
    }
    return Tolerance(**numbers, fields=tuple(fields))
