"""``--set FIELD=VALUE``: fields of a robot's file, for one call."""

import difflib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.toml_table import TomlTable, declared_fields, parse_toml, to_toml
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.robot import Robot

_NOT_SET: Final = frozenset({"name", "description", "topic"})
"""Fields that have options of their own, or change nothing."""


def with_settings(robot: Robot, settings: Mapping[str, str] | None) -> Robot:
    """Return a robot with fields set for this call; they are named in its `given`.

    Args:
        robot: with the feet that the log has.
        settings: texts by field, by its name (``contact_on_n``) or its key in the file
            (``contact.on_n``, ``feet.NAME.frame``); ``tare.NAME`` is ``feet.NAME.offset_n``.

    Raises:
        CallError: there is no such field or foot, or the text is no value for it.
    """
    given = set()
    for path, text in (settings or {}).items():
        foot, name, value = _parsed(path, text)
        if not foot:
            robot = replace(robot, **{name: value})
            given.add(name)
            continue
        names = [each.name for each in robot.feet]
        if foot not in names:
            raise CallError(f"--set {path}: the log has no such foot; it has {listed(names)}")
        changed = replace(robot.feet[names.index(foot)], **{name: value})
        feet = tuple(changed if each.name == foot else each for each in robot.feet)
        robot = replace(robot, feet=feet)
        given.add(f"tare.{foot}" if name == "offset_n" else path)
    on, off = robot.contact_on_n, robot.contact_off_n
    if on is not None and off is not None and off > on:
        raise CallError(f"contact_off_n {off:g} is above contact_on_n {on:g}; it must not be")
    return replace(robot, given=frozenset(given))


def check_robot_options(options: object) -> None:
    """Check --set and --foot before a log is opened; only that can tell the feet.

    Args:
        options: of a command; those that have neither are right.

    Raises:
        CallError: there is no such field, or no foot can have such a name.
    """
    if not isinstance(options, RobotOptions):
        return
    for path, text in (options.set or {}).items():
        _parsed(path, text)
    for name in options.foot or {}:
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {name}: a foot's name has letters, digits and _ only")


def _parsed(path: str, text: str) -> tuple[str, str, Any]:
    """Return the foot, empty for the robot itself, the field's name and its value.

    Raises:
        CallError: there is no such field, or the text is no value for it.
    """
    first, _, rest = path.partition(".")
    foot, _, field = (rest, "", "offset_n") if first == "tare" and rest else rest.partition(".")
    of_foot = first in {"tare", "feet"} and bool(rest)
    foot, field = (foot, field) if of_foot else ("", path)
    for name, take, section, key in declared_fields(Foot if of_foot else Robot):
        if field in {name, f"{section}.{key}".lstrip(".")} and name not in _NOT_SET:
            return foot, name, _value(take, key, path, text)
    known = [each[0] for each in declared_fields(Robot) if each[0] not in _NOT_SET]
    known += ["tare.FOOT", *(f"feet.{foot or 'FOOT'}.{each[0]}" for each in declared_fields(Foot))]
    near = difflib.get_close_matches(path, known, 3, 0.6)
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
    raise CallError(f"--set {path}: the robot's file has no such field; {hint}")


def _value(take: Callable[[TomlTable, str], Any], key: str, path: str, text: str) -> Any:  # noqa: ANN401 - as in the file
    """Return the value that a text is: TOML, or a vector, a word or words without their marks.

    Raises:
        CallError: it is none that the field may have.
    """
    wrong = ""
    for toml in (text, f"[{text}]", to_toml(text), to_toml(tuple(text.split(",")))):
        try:
            table = TomlTable(parse_toml(f"{key} = {toml}", "--set"), "--set")
        except CallError:
            continue
        try:
            return take(table, key)
        except CallError as error:
            wrong = wrong or str(error).rpartition("; ")[2]
    raise CallError(f"--set {path}={text}: {wrong}")
