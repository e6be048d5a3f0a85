"""``--set FIELD=VALUE``: fields of a robot's file, for one call."""

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, Final, Literal, get_args, get_origin, get_type_hints

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.robot import Robot

_LARGEST: Final = 1e6
"""Of any number: no robot is heavier, and no force larger."""
_OPEN: Final = frozenset({"offset", "offset_n", "contact_point_m", "com_offset_m"})
"""Fields whose numbers may be zero or negative."""
_OR_ZERO: Final = frozenset({"debounce_s", "element"})
_NOT_SET: Final = frozenset({"name", "description", "feet", "given", "field", "topic"})
"""Fields that have options of their own, or are no values."""


def with_settings(robot: Robot, settings: Mapping[str, str] | None) -> Robot:
    """Return a robot with fields set for this call; they are named in its `given`.

    Args:
        robot: with the feet that the log has.
        settings: texts by field: ``contact_on_n``, ``feet.NAME.frame``; ``tare.NAME`` stands for
            ``feet.NAME.offset_n``.

    Raises:
        CallError: there is no such field or foot, or the text is no value for it.
    """
    for path, text in (settings or {}).items():
        name, foot, field = _parts(path)
        if foot:
            robot = replace(robot, feet=_with_foot(robot.feet, foot, field, path, text))
        else:
            robot = replace(robot, **{name: _value(name, text, _fields()[name], path)})
    parts = [_parts(path) for path in settings or {}]
    given = {f"tare.{foot}" if field == "offset_n" else name for name, foot, field in parts}
    robot = replace(robot, given=frozenset(given))
    on, off = robot.contact_on_n, robot.contact_off_n
    if on is not None and off is not None and off > on:
        raise CallError(f"contact_off_n {off:g} is above contact_on_n {on:g}; it must not be")
    return robot


def check_settings(settings: Mapping[str, str] | None) -> None:
    """Check fields and values before a log is opened; only that can tell the feet.

    Raises:
        CallError: see `with_settings`.
    """
    for path, text in (settings or {}).items():
        name, foot, field = _parts(path)
        hint = _foot_fields()[field] if foot else _fields()[name]
        _value(field or name, text, hint, path)


def _parts(path: str) -> tuple[str, str, str]:
    """Return the field of a path; also the foot and its field, where it is one of a foot.

    Raises:
        CallError: there is no such field.
    """
    first, _, rest = path.partition(".")
    if first == "tare" and rest:
        return path, rest, "offset_n"
    if first == "feet":
        foot, _, field = rest.partition(".")
        if not foot or field not in _foot_fields():
            raise _unknown(path, [f"feet.{foot or 'NAME'}.{each}" for each in _foot_fields()])
        return path, foot, field
    if path not in _fields():
        raise _unknown(path, [*_fields(), "tare.FOOT", "feet.FOOT.FIELD"])
    return path, "", ""


def _unknown(path: str, known: Sequence[str]) -> CallError:
    near = difflib.get_close_matches(path, known, 3, 0.5)
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
    return CallError(f"--set {path}: the robot's file has no such field; {hint}")


def _with_foot(
    feet: tuple[Foot, ...], name: str, field: str, path: str, text: str
) -> tuple[Foot, ...]:
    names = [foot.name for foot in feet]
    if name not in names:
        raise CallError(f"--set {path}: the log has no such foot; it has {listed(names)}")
    value = _value(field, text, _foot_fields()[field], path)
    return tuple(replace(foot, **{field: value}) if foot.name == name else foot for foot in feet)


@cache
def _fields() -> dict[str, Any]:
    return {name: hint for name, hint in get_type_hints(Robot).items() if name not in _NOT_SET}


@cache
def _foot_fields() -> dict[str, Any]:
    return {name: hint for name, hint in get_type_hints(Foot).items() if name not in _NOT_SET}


def _value(name: str, text: str, hint: Any, path: str) -> Any:  # noqa: ANN401 - any type
    """Return the value that a text is for a field of a type.

    Raises:
        CallError: it is none.
    """
    types = [each for each in get_args(hint) if each is not type(None)]
    may_be_none = type(None) in get_args(hint)
    kind = types[0] if may_be_none else hint
    if may_be_none and text == "none":
        return None
    wanted = ""
    value: Any = text
    if get_origin(kind) is Literal:
        wanted = "" if text in get_args(kind) else f"one of {', '.join(get_args(kind))}"
    elif get_origin(kind) is tuple and str in get_args(kind):
        value = tuple(text.split(","))
        wanted = "" if len(value) == len(get_args(kind)) else "two words, such as front,left"
    elif get_origin(kind) is tuple:
        value = tuple(_number(part, name) for part in text.split(","))
        wanted = "" if len(value) == len(get_args(kind)) else "three numbers, such as 3,-2,-60"
        wanted = "three numbers, such as 3,-2,-60" if None in value else wanted
    elif kind is not str:
        value = _number(text, name)
        above = "" if name in _OPEN else " from 0" if name in _OR_ZERO else " above 0"
        wanted = "" if value is not None else f"a number{above}"
        value = int(value) if kind is int and value is not None else value
    if wanted:
        raise CallError(f"--set {path}={text}: must be {wanted}{', or none' * may_be_none}")
    return value


def _number(text: str, name: str) -> float | None:
    """Return a number that a field may be; None: it is none."""
    try:
        number = float(text)
    except ValueError:
        return None
    least = -_LARGEST if name in _OPEN else 0.0
    fits = math.isfinite(number) and least <= number <= _LARGEST
    return number if fits and (number or name in _OPEN | _OR_ZERO) else None
