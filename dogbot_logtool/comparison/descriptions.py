"""How two logs describe a topic (type, encoding, definition), and their records beside messages."""

import hashlib
from collections.abc import Mapping, Sequence
from typing import Final

from mcap import records

from dogbot_logtool.comparison.decoders import (
    Undecodable,
    decode_json,
    descriptor_files,
    protobuf_tree,
    ros_store,
)
from dogbot_logtool.comparison.fields import Tree, compare_fields
from dogbot_logtool.comparison.outcome import (
    RECORDS,
    Difference,
    Findings,
    Kind,
    Tally,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.reader.containers.log import Channel, Extra, Log, Schema
from dogbot_logtool.reader.containers.mcap.records import read_extra

OWN_VERSION: Final = "metadata:dogbot_logtool.version"
"""The version of this program that wrote a file says nothing of what is in it."""
_LIMIT: Final = 3
"""Differences named a definition; what follows is mostly the same shift."""
_NEXT_TYPE: Final = f"{'=' * 80}\nMSG: "


def kind_of(channel: Channel) -> str:
    """Return what a message must have in common with another to be compared with it."""
    return f"{channel.type_name} ({channel.message_encoding})"


def compare_descriptions(
    expected: Sequence[Channel], actual: Sequence[Channel], found: Findings
) -> None:
    """Compare the types, encodings and definitions of a topic's channels."""
    sides = expected, actual
    for what, name in (("type", "type_name"), ("encoding", "message_encoding")):
        one, other = ({getattr(channel, name) or "none" for channel in side} for side in sides)
        if one != other:
            found.add(what, ", ".join(sorted(one)), ", ".join(sorted(other)))
    for kind in sorted({kind_of(c) for c in expected} & {kind_of(c) for c in actual}):
        schemas, others = (_schemas(side, kind) for side in sides)
        if len(schemas) == len(others):
            for one_schema, other_schema in zip(schemas, others, strict=True):
                compare_schemas(one_schema, other_schema, found)
        else:
            found.add("schema", f"{len(schemas)} definitions", f"{len(others)} definitions")


def _schemas(channels: Sequence[Channel], kind: str) -> list[Schema | None]:
    """Return the different definitions of a type in the order of their channels."""
    schemas = [channel.schema for channel in channels if kind_of(channel) == kind]
    return list({(s.encoding, s.data) if s else None: s for s in schemas}.values())


def compare_schemas(expected: Schema | None, actual: Schema | None, found: Findings) -> None:
    """Compare what two definitions of a type say."""
    if expected is None or actual is None:
        if expected is not actual:
            texts = "a definition", "none"
            found.add("schema", *(texts if expected else texts[::-1]))
    elif expected.encoding != actual.encoding:
        found.add("schema encoding", expected.encoding, actual.encoding)
    elif expected.data != actual.data:
        exactly, differences = FieldRules(Rules()), Findings(_LIMIT, found.of)
        try:
            one, other = schema_tree(expected), schema_tree(actual)
            compare_fields(one, other, exactly, differences, "schema")
        except (Undecodable, RecursionError):
            compare_fields(expected.data, actual.data, exactly, differences, "schema")
        for each in differences.differences:
            found.add(each.path, each.expected, each.actual)


def schema_tree(schema: Schema) -> Tree:
    """Return what a definition says.

    Raises:
        Undecodable: the definition is broken.
    """
    match schema.encoding:
        case "ros1msg" | "ros2msg" | "ros2idl":
            store, name = ros_store(schema)
            text, _ = store.generate_msgdef(name, 1 if schema.encoding == "ros1msg" else 2)
            own, *others = text.split(_NEXT_TYPE)
            parts = [each.partition("\n") for each in others]
            return {name: own.splitlines()} | {each: text.splitlines() for each, _, text in parts}
        case "protobuf":
            return {file.name: protobuf_tree(file) for file in descriptor_files(schema)}
        case "jsonschema":
            return decode_json(schema.data)
        case _:
            return schema.data


def compare_records(expected: Log, actual: Log, rules: Rules, findings: Findings) -> Tally:
    """Compare what is no message; an entry of a metadata record counts as one."""
    found = findings.within(Difference(kind=Kind.DESCRIPTION, topic=RECORDS), RECORDS)
    ignoring = FieldRules(rules.ignoring(OWN_VERSION))
    findings.take(compare_fields(records_tree(expected), records_tree(actual), ignoring, found))
    return found.tally


def records_tree(log: Log) -> Mapping[str, Tree]:
    """Return a log's records beside its messages, by the names that patterns know them by.

    Times of attachments are not compared: they say when a file was attached, not what it holds.
    """
    found: dict[str, list[Tree]] = {}
    for extra in log.extras:
        name, value = _record(extra)
        found.setdefault(name, []).append(value)
    named = {name: each if len(each) > 1 else each[0] for name, each in sorted(found.items())}
    return {"profile": log.profile, **named}


def _record(extra: Extra) -> tuple[str, Tree]:
    """Return the name and the content of a record."""
    match read_extra(extra):
        case (_, records.Metadata() as metadata):
            return f"metadata:{metadata.name}", dict(metadata.metadata)
        case (_, records.Attachment() as attachment):
            digest = hashlib.sha256(attachment.data).hexdigest()
            content = {"size": len(attachment.data), "sha256": digest}
            return f"attachment:{attachment.name}", {"type": attachment.media_type, **content}
    return "(damaged record)", extra.size
