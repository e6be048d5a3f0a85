"""How two logs describe a topic (type, encoding, definition), and their records beside messages."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import Final

from mcap import records

from dogbot_logtool.comparison.decoders import ROS_DEFINITIONS, descriptor_files, ros_store
from dogbot_logtool.comparison.fields import Tree, compare_fields, text_of
from dogbot_logtool.comparison.outcome import Leaf
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.reader.containers.log import Channel, Extra, Log, Schema
from dogbot_logtool.reader.containers.mcap.records import read_extra

OWN_VERSION: Final = "metadata:dogbot_logtool.version"
"""The version of this program that wrote a file says nothing of what is in it."""


def kind_of(channel: Channel) -> str:
    """Return what a message must have in common with another to be compared with it."""
    return f"{channel.type_name} ({channel.message_encoding})"


def compare_descriptions(expected: Sequence[Channel], actual: Sequence[Channel]) -> Iterator[Leaf]:
    """Compare the types, encodings and definitions of a topic's channels."""
    sides = expected, actual
    for what, name in (("type", "type_name"), ("encoding", "message_encoding")):
        one, other = ({getattr(channel, name) or "none" for channel in side} for side in sides)
        if one != other:
            yield Leaf("different", what, ", ".join(sorted(one)), ", ".join(sorted(other)))
    for kind in sorted({kind_of(c) for c in expected} & {kind_of(c) for c in actual}):
        recorded = [_schemas(side, kind) for side in sides]
        if recorded[0] != recorded[1]:
            lines = ([line for each in side for line in _lines(each)] for side in recorded)
            unlike = [pair for pair in zip_longest(*lines, fillvalue="") if pair[0] != pair[1]]
            if unlike:  # what follows the first is mostly the same shift
                one_line, other_line = map(text_of, unlike[0])
                yield Leaf("different", "schema", one_line, other_line)


def _schemas(channels: Sequence[Channel], kind: str) -> list[Schema]:
    """Return the different definitions of a type in the order of their channels."""
    schemas = [each.schema for each in channels if each.schema and kind_of(each) == kind]
    return list(dict.fromkeys(each._replace(id=0) for each in schemas))


def _lines(schema: Schema) -> list[str]:
    """Return what a definition says, line by line; comments and the order of files do not count."""
    encoding, data = schema.encoding, schema.data
    try:
        if encoding in ROS_DEFINITIONS:
            store, type_name = ros_store(schema)
            text, _ = store.generate_msgdef(type_name, 1 if encoding == "ros1msg" else 2)
        elif encoding == "protobuf":
            text = "".join(sorted(map(str, descriptor_files(schema))))
        else:
            text = json.dumps(json.loads(data), indent=1, sort_keys=True)
    except Exception:  # noqa: BLE001 - a library's, on a definition that may be anything
        text = data.decode("utf-8", "replace")
    return [encoding, *(line.strip() for line in text.splitlines())]


def compare_records(expected: Log, actual: Log, rules: Rules) -> Iterator[Leaf]:
    """Compare what is no message; an entry of a metadata record counts as one."""
    ignoring = FieldRules(rules.ignoring(OWN_VERSION))
    return compare_fields(records_tree(expected), records_tree(actual), ignoring)


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
