"""Message definitions compared by what they say: comments, blanks and order of files do not count.

A definition becomes a tree as `fields` compares it.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from dogbot_logtool.comparison.fields import FieldDifference, Findings, Tree, compare_fields
from dogbot_logtool.comparison.logs.decoders import (
    Undecodable,
    decode_json,
    descriptor_files,
    protobuf_tree,
    ros_types,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.reader.containers.log import Schema

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc

_LIMIT: Final = 3
"""Differences named a definition; what follows is mostly the same shift."""


def compare_schemas(expected: Schema | None, actual: Schema | None) -> Sequence[FieldDifference]:
    """Return how two definitions of a type differ; nothing if they mean the same."""
    if expected is None or actual is None:
        if expected is actual:
            return ()
        texts = ["none" if schema is None else "a definition" for schema in (expected, actual)]
        return (FieldDifference("schema", texts[0], texts[1]),)
    if expected.encoding != actual.encoding:
        return (FieldDifference("schema encoding", expected.encoding, actual.encoding),)
    if expected.data == actual.data:
        return ()
    try:
        return _compare_trees(schema_tree(expected), schema_tree(actual))
    except (Undecodable, RecursionError):
        return _compare_trees(expected.data, actual.data)


def _compare_trees(expected: Tree, actual: Tree) -> Sequence[FieldDifference]:
    findings = Findings(_LIMIT)
    compare_fields(expected, actual, FieldRules(Rules()), findings, "schema")
    return findings.differences


def schema_tree(schema: Schema) -> Tree:
    """Return what a definition says.

    Raises:
        Undecodable: the definition is broken.
    """
    match schema.encoding:
        case "ros1msg" | "ros2msg" | "ros2idl":
            return {
                name: [f"{kind} {constant}={value}" for constant, kind, value in constants]
                + [f"{_type_text(kind)} {field}" for field, kind in fields]
                for name, (constants, fields) in ros_types(schema).items()
            }
        case "protobuf":
            return {file.name: protobuf_tree(file) for file in descriptor_files(schema)}
        case "jsonschema":
            return decode_json(schema.data)
        case _:
            return schema.data


def _type_text(kind: "FieldDesc") -> str:
    """Spell a field's type as a definition does."""
    from rosbags.interfaces import Nodetype  # noqa: PLC0415 - slow to import

    if kind[0] == Nodetype.NAME:
        return kind[1]
    if kind[0] == Nodetype.BASE:
        base, limit = kind[1]
        return f"{base}<={limit}" if limit else base
    element, size = kind[1]
    bound = "" if not size else f"{size}" if kind[0] == Nodetype.ARRAY else f"<={size}"
    return f"{_type_text(element)}[{bound}]"
