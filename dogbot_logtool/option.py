"""Options as fields of records, and what to use instead of those that are gone.

A field's annotation says what the option may be, the string below it is its help. The command line
makes such records from words, Python from keywords.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from inspect import get_annotations
from numbers import Integral, Real
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple, TypeVar, get_args, get_origin

from dogbot_logtool.errors import CallError

R = TypeVar("R")
Kind = Literal["flag", "choice", "number", "path", "text", "texts", "pairs"]
Named = Callable[[str, object], str]
"""Writes an option with its value, as the user gave it."""
LONGEST_S: Final = 1e9
"""No log lasts longer."""


@dataclass(frozen=True, slots=True)
class Range:
    """The numbers that an option may be."""

    least: float
    most: float
    or_zero: bool = False
    """Whether 0 means something."""
    is_whole: bool = False

    def number(self, value: object) -> float | None:
        """Return a value as one of Python's own numbers; None where it is none of these."""
        kind: type[float] = int if self.is_whole else float
        if isinstance(value, str):
            try:
                value = kind(value)
            except ValueError:
                return None
        if isinstance(value, bool) or not isinstance(value, Integral if self.is_whole else Real):
            return None
        found = kind(value)
        return found if self.least <= found <= self.most or (self.or_zero and not found) else None

    def __str__(self) -> str:
        if self.most == LONGEST_S:
            return "a number of seconds"
        number = "a whole number" if self.is_whole else "a number"
        return f"{number} from {self.least:g} to {self.most:g}{', or 0' if self.or_zero else ''}"


class As(NamedTuple):
    """How an option is written on the command line; a field without it is no option."""

    metavar: str = ""
    short: str = ""
    range: Range | None = None
    choices: tuple[str, ...] = ()
    """The words that it may be, where its type does not tell."""
    is_argument: bool = False
    is_required: bool = False
    """An argument that must be there."""


class Option(NamedTuple):
    """One option of a record."""

    name: str
    kind: Kind
    how: As
    default: Any
    choices: tuple[str, ...]
    """The words that it may be."""
    owner: type
    """The record that declares it."""

    @property
    def words(self) -> str:
        """The option on the command line: ``--odom-topic``."""
        return "--" + self.name.replace("_", "-")

    def checked(self, value: Any, named: Named) -> Any:  # noqa: ANN401 - what users give
        """Return a value as the record holds it.

        Raises:
            CallError: it is none that the option may be.
        """
        if self.kind in {"texts", "pairs"}:
            words = [value] if isinstance(value, str) else value
            return _pairs(self, words) if self.kind == "pairs" else tuple(words)
        if self.kind == "path":
            return Path(value)
        if self.kind == "text":
            return os.fspath(value)
        number = self.how.range and self.how.range.number(value)
        fits = {
            "flag": isinstance(value, bool),
            "choice": value in self.choices,
            "number": number is not None,
        }
        if not fits[self.kind]:
            raise CallError(f"{named(self.name, value)}: must be {self._wanted}")
        return value if number is None else number

    @property
    def _wanted(self) -> str:
        """What its value must be."""
        if self.kind == "choice":
            return f"one of {', '.join(self.choices)}"
        return "True or False" if self.kind == "flag" else str(self.how.range)


def _pairs(option: Option, given: Mapping[str, Any] | Sequence[str]) -> dict[str, str]:
    """Return texts by name, of a mapping or of ``NAME=TEXT`` words.

    Raises:
        CallError: a word is none such, or a name is there twice.
    """
    if isinstance(given, Mapping):
        return {name: _written(value) for name, value in given.items()}
    pairs: dict[str, str] = {}
    for word in given:
        name, equals, text = word.partition("=")
        if not (name and equals and text):
            raise CallError(f"{option.words} {word}: must be {option.how.metavar}")
        if name in pairs:
            raise CallError(f"{option.words} {name}: is given twice")
        pairs[name] = text
    return pairs


def _written(value: object) -> str:
    """Return a value of Python as it is written on the command line."""
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return ",".join(map(_written, value))
    return "none" if value is None else str(value)


@cache
def options_of(record: Any) -> tuple[Option, ...]:  # noqa: ANN401 - any record
    """List the options of a record, those of its bases first."""
    owners = {name: each for each in reversed(record.__mro__) for name in get_annotations(each)}
    found = []
    for field in fields(record):
        how = next((x for x in getattr(field.type, "__metadata__", ()) if isinstance(x, As)), None)
        if how is not None:
            kind, choices = _kind(get_args(field.type)[0], how)
            found.append(Option(field.name, kind, how, field.default, choices, owners[field.name]))
    return tuple(found)


def _kind(hint: Any, how: As) -> tuple[Kind, tuple[str, ...]]:  # noqa: ANN401 - any annotation
    """Return what an option of a type is, and the words that it may be."""
    types = [each for each in get_args(hint) if each is not type(None)]
    is_union = type(None) in get_args(hint)
    bare = types[0] if is_union else hint
    if get_origin(bare) is Literal:
        return "choice", get_args(bare)
    if how.choices:
        return "choice", how.choices
    if how.range is not None:
        return "number", ()
    if get_origin(bare) in {tuple, Sequence}:
        return "texts", ()
    if get_origin(bare) is Mapping:
        return "pairs", ()
    kinds: dict[Any, Kind] = {bool: "flag", Path: "path", str: "text"}
    return kinds[bare], ()


def make(record: Callable[..., R], given: Mapping[str, Any], named: Named) -> R:
    """Make a record of options; None stands for one that is not given.

    Args:
        record: its type.
        given: values by name, as users give them.
        named: writes an option with its value, for errors.

    Raises:
        TypeError: there is no such option.
        CallError: one is not what it must be.
    """
    known = {option.name: option for option in options_of(record)}
    for name in given.keys() - known.keys():
        raise TypeError(_unknown(name, list(known)))
    return record(
        **{
            name: known[name].checked(value, named)
            for name, value in given.items()
            if value is not None
        }
    )


def part_of(options: object, record: Callable[..., R]) -> R:
    """Return the part of options that another record holds; what they lack has its default."""
    names = [field.name for field in fields(record)]  # type: ignore[arg-type] # a data class
    return record(**{name: getattr(options, name) for name in names if hasattr(options, name)})


def _unknown(name: str, known: Sequence[str]) -> str:
    instead = instead_of("--" + name.replace("_", "-"))
    if instead and "--set" in instead:
        instead += '; in Python set={"FIELD": value}'
    return (
        f"{name!r} is gone: {instead}"
        if instead
        else (f"no option {name!r}; there are {', '.join(sorted(known))}")
    )


def as_keyword(name: str, value: object) -> str:
    """Write an option as a keyword of Python; see `make`."""
    return f"{name}={value!r}"


_EVERYWHERE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "--tare": "use --set tare.FOOT=FX,FY,FZ, or --set tare=none",
        "--wrench-frame": "use --set wrench_frame=world or link",
        "--forward-axis": "use --set forward_axis=+y",
        "--contact-on": "use --set contact_on_n=N",
        "--contact-off": "use --set contact_off_n=N",
        "--debounce": "use --set debounce_s=S",
        "--time-source": "use --set clock=header or log",
        "--command": "use --set command_topic=TOPIC",
        "--imu": "use --set imu_topic=TOPIC",
        "--without": "use --topics '!GLOB'",
        "--labels": "labels are always written",
        "--no-labels": "labels are always written; hide their topics in the viewer",
        "--no-events": "events are always written",
        "--scene": "/support is always written",
        "--no-scene": "/support is always written; hide it in the viewer",
        "--strict": "exit code 3 says that a log is damaged",
        "--update": "copy ACTUAL over EXPECTED",
        "--dot": "use `info --frames --json`, which has the tree",
        "--csv": "use `export --table strides`",
        "--parquet": "use `export --dataset DIR`",
        "--plot": "it is --figure now",
        "--plot-size": "scale the .pdf or .svg, which are 85 mm wide",
        "--window": "use --start and --end",
    }
)
"""What to do instead, whichever command it was of."""
_OF_COMMANDS: Final[Mapping[tuple[str, str], str]] = MappingProxyType(
    {
        ("convert", "--events"): "events are always written",
        ("stats", "--events"): "use `export --table events -o FILE`",
        ("stats", "--label"): "use `export --dataset DIR --label NAME=VALUE`",
        ("stats", "--prune"): "use `export --dataset DIR --prune`",
        ("info", "-o"): "results go to stdout",
        ("info", "--output"): "results go to stdout",
        ("info", "--overwrite"): "results go to stdout",
    }
)


def instead_of(option: str, command: str = "") -> str | None:
    """Return what to use instead of an option that is gone; None: it never was there."""
    return _OF_COMMANDS.get((command, option), _EVERYWHERE.get(option))
