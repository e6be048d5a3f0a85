"""Definitions as nearly all are written: fields, comments and whole numbers as constants.

rosbags' parser takes all that may be written; loading and running it is 6 % of a short log's work.
"""

import re
from collections.abc import Mapping, Sequence
from enum import Enum
from keyword import iskeyword
from typing import Any, Final

Types = Mapping[str, Sequence[tuple[str, Any]]]
"""Names of fields and their `FieldDesc`, as rosbags has them, by the type's long name."""

_SEPARATOR: Final = "=" * 80
_TYPE: Final = (
    "(?:([a-z][a-z0-9]*(?:_[a-z0-9]+)*)/(?:msg/)?)?([A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*)"
)
_END: Final = r"[ \t]*(?:#.*)?"
_INTEGER: Final = "bool|byte|char|u?int(?:8|16|32|64)"
_HEADER: Final = re.compile(rf"MSG: {_TYPE}[ \t]*")
_FIELD: Final = re.compile(rf"[ \t]*{_TYPE}(?:(\[)([0-9]*)\])?[ \t]+([A-Za-z][A-Za-z0-9_]*){_END}")
_NO_FIELD: Final = re.compile(
    rf"(?:[ \t]*(?:{_INTEGER})[ \t]+[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)*[ \t]*=[ \t]*-?[0-9]+)?{_END}"
)
_BASE: Final = re.compile(f"{_INTEGER}|float(?:32|64)|string")
_OF_ROS: Final = {
    "time": "builtin_interfaces/msg/Time",
    "duration": "builtin_interfaces/msg/Duration",
    "Header": "std_msgs/msg/Header",
}


class _Node(Enum):
    """Kind of a type, named as in rosbags."""

    BASE = 1
    NAME = 2
    ARRAY = 3
    SEQUENCE = 4


def plain_types(type_name: str, text: str) -> Types | None:
    """Return the types of a definition; None: it holds more than is read here, or is damaged.

    Args:
        type_name: of the first type.
        text: its definition, dependencies appended as recorders do.
    """
    found: dict[str, list[tuple[str, Any]]] = {}
    fields: list[tuple[str, Any]] = []
    package, begins = "", True
    for line in (f"MSG: {type_name}\n{text}").split("\n"):
        header = _HEADER.fullmatch(line) if begins else None
        if header and header[1]:
            package, fields = header[1], []
            found[f"{package}/msg/{header[2]}"] = fields
        elif begins:
            return None
        elif field := _FIELD.fullmatch(line):
            if iskeyword(field[5]):
                return None
            fields.append((field[5], _description(field, package)))
        elif line != _SEPARATOR and not _NO_FIELD.fullmatch(line):
            return None
        begins = line == _SEPARATOR
    return None if begins else found


def _description(field: re.Match[str], package: str) -> tuple[_Node, Any]:
    named, name = field[1], field[2]
    if named is None and _BASE.fullmatch(name):
        kind: tuple[_Node, Any] = _Node.BASE, (name, 0)
    elif named is None and name in _OF_ROS:
        kind = _Node.NAME, _OF_ROS[name]
    else:
        kind = _Node.NAME, f"{named or package}/msg/{name}"
    if not field[3]:
        return kind
    return (_Node.ARRAY, (kind, int(field[4]))) if field[4] else (_Node.SEQUENCE, (kind, 0))
