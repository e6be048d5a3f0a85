"""Fields of messages of any type that may be feet, by one score of names, rate and content.

They are offered, with the reasons, and never taken unasked. Names choose some sets of fields; the
columns of these are read of the whole log, like those of any feet, and judged together.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import FieldType, FixedArray, Primitive, Text
from dogbot_logtool.reader.decode.field_path import every_field, is_vector
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.reader.part import Wanted
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.names import FootSet, leg_position, name_feet
from dogbot_logtool.robot.score import (
    CONTACT_WORDS,
    FORCE_WORDS,
    name_marks,
    with_content,
)
from dogbot_logtool.robot.topics import first_messages, has_field, message_count
from dogbot_logtool.robot.words import Part, parts_of, texts_of, word_set, words_of

_ENOUGH: Final = 5
"""Points from which fields are offered as feet."""
_MOST_SETS: Final = 40
"""Sets of fields whose content is looked at."""
_MOST_NAMES: Final = 2000
"""Names that are compared with each other."""
_FEWEST_FEET, _MOST_FEET = 2, 8
_MOST_CHANGES: Final = 0.2
"""Changes a sample from which a bit is no foot's: those of a number change with each message."""
_BIT_WORDS: Final = CONTACT_WORDS | {"bits", "bitmask", "mask"}
_OTHER_WORDS: Final = word_set(
    "acc acceleration accel angle angular covariance current gain header height linear orientation "
    "pos pose position positions quat stamp temperature time torque twist vel velocity voltage"
)
"""Words of fields that are no contact. So is an effort, unless the strings beside it name feet."""
_JOINT: Final = word_set("ankle drive hip joint knee motor servo")
"""Words of names that are a joint's, whose effort is no foot's force."""
_DIFFER: Final = {"corners": "front and back, left and right", "sides": "left and right"}
_LEGS: Final = frozenset({Part.FOOT, Part.LEG})
_Kinds = Mapping[str, FieldType]
"""The fields of a definition, by path."""
_Named = tuple[FootSet, Collection[str]]
"""Fields as feet, and their names."""


def find_candidates(log: Log) -> list[FootSet]:
    """Find fields that may be feet, the most likely first."""
    named = sorted(_named_sets(log), key=lambda one: -one.points)[:_MOST_SETS]
    columns = _read_fields(log, named)
    judged = (with_content(one, _present(one, columns)) for one in named)
    likely = [one for one in judged if one is not None and one.points >= _ENOUGH]
    kept: list[FootSet] = []
    for one in sorted(likely, key=lambda one: -one.points):
        words = {foot.word for foot in one.feet}
        if not any(words <= {foot.word for foot in other.feet} for other in kept):
            kept.append(one)
    return kept


# By names


def _named_sets(log: Log) -> Iterator[FootSet]:
    """Yield sets of fields whose names do not speak against feet, scored by names and rate."""
    by_type: dict[str, dict[str, Channel]] = {}
    for channel in log.channels.values():
        if channel.type_name and source_of(channel, "feet") is None:
            by_type.setdefault(channel.type_name, {}).setdefault(channel.topic, channel)
    for type_name, channels in by_type.items():
        fields: dict[str, dict[str, Foot]] = {"vector": {}, "integer": {}, "number": {}}
        rows: list[_Named] = []
        for topic, channel in sorted(channels.items()):
            try:
                kinds = dict(every_field(definition_of(channel)))
            except DefinitionError:
                continue
            for path, is_a in _likely_fields(kinds, f"{topic} {type_name}"):
                labels = _labels_beside(log, channel, path, kinds)
                fields[is_a] |= _single_fields(topic, path, is_a, labels)
                rows += () if labels else _rows_of_fields(topic, path, is_a, kinds)
        siblings = (each for own in fields.values() for each in _siblings(own))
        for one, names in (*siblings, *rows):
            marks = list(name_marks(names, type_name, _rate_hz(log, one.topics)))
            if one.kind != "elements":
                marks.append((1, f"they differ in {_DIFFER.get(one.kind, 'one word')} only"))
            yield replace(one, type_name=type_name, marks=tuple(marks))


def _likely_fields(kinds: _Kinds, around: str) -> Iterator[tuple[str, str]]:
    """Yield fields whose names, with their topic and type, may be of feet: path, and what it is.

    Of a vector, its components are no fields of their own.
    """
    for path, kind in kinds.items():
        is_part = is_vector(kinds.get(path.rpartition(".")[0]))
        own, texts = texts_of(path), texts_of(path, around)
        if own & _OTHER_WORDS or is_part:
            continue
        if is_vector(kind) and texts & (FORCE_WORDS | {"grf"}) and "torque" not in own:
            yield path, "vector"
        is_told = texts & (CONTACT_WORDS | FORCE_WORDS) or parts_of([path, around]) & _LEGS
        if isinstance(kind, Primitive) and is_told:
            yield path, "integer" if kind.dtype[0] in "iu" else "number"


def _labels_beside(log: Log, channel: Channel, path: str, kinds: _Kinds) -> tuple[str, ...]:
    """Return the strings beside the elements of an array, in them or in an array beside it.

    They are the same in all of the first messages, and each element has another one; else none.
    """
    array = path.partition("[]")[0]
    inside, beside = f"{array}[].", array.rpartition(".")[0]
    texts = [
        each
        for each, kind in kinds.items()
        if isinstance(kind, Text) and each.count("[]") == path.count("[]") == 1
        if each.startswith(inside) or (each.endswith("[]") and each.rpartition(".")[0] == beside)
    ]
    for text in sorted(texts, key=lambda each: not each.startswith(inside)):
        beside_it, rows = path_of(text, "text", definition_of(channel)), set[tuple[str, ...]]()
        for messages in first_messages(log, channel, beside_it.columns):
            message, strings = beside_it.texts(messages.table)
            code, names = strings.encode()
            ends = np.cumsum(np.bincount(message, minlength=1))[:-1]
            for row in np.split(code[np.argsort(message, kind="stable")], ends):
                rows.add(tuple(names[each] for each in row.tolist()))
        labels = rows.pop() if len(rows) == 1 else ()
        if all(labels) and len(labels) == len(set(labels)) > 0:
            return labels
    return ()


def _field(name: str, topic: str, path: str, is_a: str) -> Foot:
    """Return a field as a foot; what integers are read as is said until their content tells."""
    field = FootField(path, kind="contact" if is_a == "integer" else "")
    return Foot(name, topic, leg_position=leg_position(name), field=field)


def _single_fields(topic: str, path: str, is_a: str, labels: Sequence[str]) -> dict[str, Foot]:
    """Return a field, or the elements of an array that have strings beside them, by their names."""
    is_effort = "effort" in texts_of(path)
    paths: dict[str, str] = {}
    if "[]" not in path and not is_effort:
        paths[f"{topic}/{path.replace('.', '/')}"] = path
    for number, label in enumerate(labels):
        # Most efforts are those of joints.
        is_foot = bool(parts_of([label]) & _LEGS) and not texts_of(label) & _JOINT
        if is_foot or not is_effort:
            name = f"{topic}/{label}/{path.replace('[]', '')}"
            paths[name] = path.replace("[]", f"[{number}]")
    return {name: _field(name, topic, each, is_a) for name, each in paths.items()}


def _rows_of_fields(topic: str, path: str, is_a: str, kinds: _Kinds) -> Iterator[_Named]:
    """Yield elements of an array, or bits of an integer; how many feet there are, messages tell."""
    texts, name = texts_of(topic, path), f"{topic}/{path.replace('.', '/')}"
    array = kinds[path.partition("[]")[0]]
    rows: list[list[str]] = []
    if path.count("[]") == 1:
        # Numbers may be those of forces, or of forces and torques; the third is along z.
        for step in (1,) if is_a == "vector" else (1, 3, 6):
            size = array.length if isinstance(array, FixedArray) else (_MOST_FEET + 1) * step
            if size % step == 0 and _FEWEST_FEET <= size // step <= _MOST_FEET + 1:
                numbers = range(2 if step > 1 else 0, size, step)
                rows.append([path.replace("[]", f"[{number}]") for number in numbers])
    elif "[]" not in path and is_a == "integer" and texts & _BIT_WORDS:
        rows.append([f"{path}&{1 << bit}" for bit in range(_MOST_FEET)])
    for row in rows if "effort" not in texts else ():
        feet = (_field(f"foot_{n}", topic, each, is_a) for n, each in enumerate(row))
        yield FootSet(tuple(feet), "elements"), [name]


def _siblings(fields: Mapping[str, Foot]) -> Iterator[_Named]:
    """Yield fields of which each may be a foot: by their names' legs, else by any one word."""
    chosen, others = name_feet(fields, contacts_only=True)
    sets = [one for one in (chosen, *others) if one and one.kind != "alone"]
    for one in sets:
        feet = []
        for foot in one.feet:
            position = foot.leg_position or leg_position(foot.name)
            own = fields[foot.topic]
            feet.append(replace(foot, topic=own.topic, field=own.field, leg_position=position))
        yield replace(one, feet=tuple(feet)), one.topics
    groups: dict[tuple[str, ...], dict[str, str]] = {}
    for name in sorted(fields)[:_MOST_NAMES]:
        words = [word.text for word in words_of(name)]
        for index, word in enumerate(words):
            key = (str(index), *words[:index], *words[index + 1 :])
            groups.setdefault(key, {})[word] = name
    for group in groups.values():
        known = any(one.topics >= {*group.values()} for one in sets)
        if _FEWEST_FEET < len(group) <= _MOST_FEET and not known:
            feet = []
            for word in sorted(group, key=lambda each: (int(each) if each.isdigit() else 0, each)):
                name = f"foot_{word}" if word.isdigit() else word
                position = leg_position(name)
                feet.append(replace(fields[group[word]], name=name, leg_position=position))
            yield FootSet(tuple(feet), "one word"), group.values()


def _rate_hz(log: Log, topics: frozenset[str]) -> float | None:
    """Return the messages a second of the slowest topic."""
    if log.start_time is None or log.end_time is None or log.end_time <= log.start_time:
        return None
    slowest = min(message_count(log, topic) for topic in topics)
    return slowest / ((log.end_time - log.start_time) / 1e9)


# By content


def _read_fields(log: Log, sets: Sequence[FootSet]) -> Mapping[str, Samples]:
    """Read the fields of some sets as forces, by their names as ``--foot`` takes them."""
    feet = [
        Foot(word, foot.topic, field=FootField(foot.field.path, "force"))
        for word, foot in {foot.word: foot for one in sets for foot in one.feet}.items()
        if foot.field
    ]
    of_channel: dict[int, tuple[int, ...]] = {}
    for channel in log.channels.values():
        if told := tuple(n for n, foot in enumerate(feet) if has_field(channel, foot)):
            of_channel[channel.id] = told
    channels = tuple(log.channels[number] for number in of_channel)
    wanted = Wanted(channels, FootChannels(feet, of_channel))
    spans = log.grouped(log.chunks_of(of_channel.keys()))
    columns = read_recording(log, wanted, 1, spans=spans).recording.feet
    return {foot.name: samples for foot, samples in zip(feet, columns, strict=True)}


def _present(named: FootSet, columns: Mapping[str, Samples]) -> list[Samples]:
    """Return the samples of the first fields, those that all messages have; none: they differ."""
    samples = [columns[foot.word] for foot in named.feet]
    if named.kind != "elements":
        return samples
    if "&" in named.feet[0].word:
        changes = [np.count_nonzero(np.diff(each.in_contact)) for each in samples]
        count = max((bit + 1 for bit, number in enumerate(changes) if number), default=0)
        if max(changes) > _MOST_CHANGES * len(samples[0].in_contact):
            return []
    else:
        told = [len(each.log_time) for each in samples]
        count = sum(number > 0 for number in told)
        count = count if len(set(told[:count])) == 1 else 0
    return samples[:count] if _FEWEST_FEET <= count <= _MOST_FEET else []
