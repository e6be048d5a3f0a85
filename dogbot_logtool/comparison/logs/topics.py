"""The topics of two logs, and how they are described: type, encoding, definition."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from dogbot_logtool.comparison.fields import FieldDifference, Findings, Tree, compare_fields
from dogbot_logtool.comparison.logs.decoders import (
    Undecodable,
    decode_json,
    descriptor_files,
    protobuf_tree,
    ros_types,
)
from dogbot_logtool.comparison.outcome import Difference, Differences, Kind, Tally, field_difference
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.reader.containers.log import Channel, Log, Schema

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc

_LIMIT: Final = 3
"""Differences named a definition; what follows is mostly the same shift."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic that at least one of the logs has."""

    name: str
    expected: tuple[Channel, ...]
    """Its channels in the expected log; none if the topic is extra."""
    actual: tuple[Channel, ...]
    rules: FieldRules
    tally: Tally

    @property
    def one_sided(self) -> bool:
        """Whether only one log has it."""
        return bool(self.tally.only_in)


def find_topics(
    expected: Log, actual: Log, rules: Rules, differences: Differences
) -> Sequence[Topic]:
    """Return the topics to compare, sorted, and note what differs in their descriptions."""
    logs = (expected, actual)
    names = {name for log in logs for name in log.channels_by_topic}
    topics: list[Topic] = []
    for name in sorted(name for name in names if rules.takes(name)):
        one, other = (log.channels_by_topic.get(name, ()) for log in logs)
        types = dict.fromkeys(channel.type_name for channel in (*one, *other))
        tally = Tally(name, ", ".join(types))
        tally.only_in = "" if one and other else "expected" if one else "actual"
        topic = Topic(name, one, other, FieldRules(rules, name), tally)
        for difference in _differences(topic, expected, actual):
            differences.add(difference)
            topic.tally.faults += 1
        topics.append(topic)
    return topics


def kind_of(channel: Channel) -> str:
    """Return what a message must have in common with another to be compared with it."""
    return f"{channel.type_name} ({channel.message_encoding})"


def _differences(topic: Topic, expected: Log, actual: Log) -> Iterator[Difference]:
    if topic.one_sided:
        log, what = (expected, "missing") if topic.expected else (actual, "extra")
        count = sum(log.counts.get(one.id, 0) for one in (*topic.expected, *topic.actual))
        yield Difference(Kind.TOPIC, topic.name, f"the topic is {what} ({count} messages)")
        return
    for found in _description_differences(topic.expected, topic.actual):
        yield field_difference(found, topic.name, Kind.DESCRIPTION)


def _description_differences(
    expected: Sequence[Channel], actual: Sequence[Channel]
) -> Iterator[FieldDifference]:
    for what, one, other in (
        ("type", {c.type_name for c in expected}, {c.type_name for c in actual}),
        ("encoding", {c.message_encoding for c in expected}, {c.message_encoding for c in actual}),
    ):
        if one != other:
            yield FieldDifference(what, _listed(one), _listed(other))
    for kind in sorted({kind_of(c) for c in expected} & {kind_of(c) for c in actual}):
        one_sides, other_sides = _schemas(expected, kind), _schemas(actual, kind)
        if len(one_sides) != len(other_sides):
            texts = [f"{len(side)} definitions" for side in (one_sides, other_sides)]
            yield FieldDifference("schema", texts[0], texts[1])
        else:
            for one_schema, other_schema in zip(one_sides, other_sides, strict=True):
                yield from compare_schemas(one_schema, other_schema)


def _listed(names: set[str]) -> str:
    return ", ".join(name or "none" for name in sorted(names))


def _schemas(channels: Sequence[Channel], kind: str) -> list[Schema | None]:
    """Return the different definitions of a type in the order of their channels."""
    schemas = [channel.schema for channel in channels if kind_of(channel) == kind]
    return list({(s.encoding, s.data) if s else None: s for s in schemas}.values())


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
