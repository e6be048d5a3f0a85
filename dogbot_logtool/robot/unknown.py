"""Fields of messages of any type that may be feet, by one score of names, rate and content.

They are offered, with the reasons, and never taken unasked. Names choose some sets of fields; the
columns of these are read of the whole log, like those of any feet, and judged together.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
)
from dogbot_logtool.reader.decode.field_path import is_vector, readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.labels import array_labels
from dogbot_logtool.robot.names import leg_position, name_feet
from dogbot_logtool.robot.score import (
    CONTACT_WORDS,
    FORCE_WORDS,
    Mark,
    judge_content,
    name_marks,
    rate_mark,
)
from dogbot_logtool.robot.topics import has_field, message_count
from dogbot_logtool.robot.words import words_of

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
_OTHER_WORDS: Final = (
    "acc acceleration accel angle angular covariance current gain header height linear orientation "
    "pos pose position positions quat stamp temperature time torque twist vel velocity voltage"
)
"""Words of fields that are no contact. So is an effort, unless the strings beside it name feet."""
_OTHER: Final = frozenset(_OTHER_WORDS.split())
_JOINT: Final = frozenset({"ankle", "drive", "hip", "joint", "knee", "motor", "servo"})
"""Words of names that are a joint's, whose effort is no foot's force."""


@dataclass(frozen=True, slots=True)
class FootCandidates:
    """Fields that may be the feet of a robot."""

    feet: tuple[Foot, ...]
    type_name: str
    marks: tuple[Mark, ...]
    is_integer: bool
    """Whether they are read as contacts, unless something else is said."""
    is_numbered: bool
    """Whether they are the elements of an array or bits, of which messages have fewer."""
    is_contact: bool = False
    """Whether the fields only tell contact, and no force."""

    @property
    def points(self) -> int:
        """The sum of all marks."""
        return sum(points for points, _ in self.marks)

    @property
    def reasons(self) -> str:
        """What speaks for them, and against."""
        return "; ".join(reason for _, reason in self.marks if reason)

    @property
    def text(self) -> str:
        """The fields, their points and the reasons, for people."""
        return f"{self.fields} ({self.points} points: {self.reasons})"

    @property
    def fields(self) -> str:
        """The feet and their fields, for people."""
        return ", ".join(f"{foot.name} = {word_of(foot)}" for foot in self.feet)

    @property
    def words(self) -> tuple[str, ...]:
        """The fields as ``--foot`` takes them."""
        return tuple(map(word_of, self.feet))


@dataclass(frozen=True, slots=True)
class _Field:
    """A field of a topic's messages, or an element of an array in them."""

    topic: str
    path: str
    is_a: str
    """``vector``, ``integer`` or ``number``."""
    name: str
    """What is compared with the names of others."""

    def foot(self, name: str, position: LegPosition | None = None) -> Foot:
        """Return it as a foot."""
        position = position or leg_position(name)
        return Foot(name, self.topic, leg_position=position, field=FootField(self.path))


def word_of(foot: Foot) -> str:
    """Return a foot's topic and field as ``--foot`` takes them."""
    return f"{foot.topic}:{foot.field.path}" if foot.field else foot.topic


def find_candidates(log: Log) -> list[FootCandidates]:
    """Find fields that may be feet, the most likely first."""
    named = sorted(_named_sets(log), key=lambda one: -one.points)[:_MOST_SETS]
    columns = _read_fields(log, named)
    judged = (_judged(one, [columns[word] for word in one.words]) for one in named)
    likely = [one for one in judged if one is not None and one.points >= _ENOUGH]
    kept: list[FootCandidates] = []
    for one in sorted(likely, key=lambda one: (-one.points, one.is_contact)):
        if not any(set(one.words) <= set(other.words) for other in kept):
            kept.append(one)
    return kept


def _named_sets(log: Log) -> Iterator[FootCandidates]:
    """Yield sets of fields whose names do not speak against feet, scored by names and rate."""
    by_type: dict[str, list[Channel]] = {}
    for channel in log.channels.values():
        if channel.type_name and source_of(channel, "feet") is None:
            by_type.setdefault(channel.type_name, []).append(channel)
    for type_name, channels in by_type.items():
        try:
            definition = definition_of(channels[0])
        except DefinitionError:
            continue
        named: list[_Field] = []
        rows: list[list[_Field]] = []
        for topic in sorted({channel.topic for channel in channels}):
            for field, length in _fields(topic, type_name, definition):
                labels = array_labels(log, topic, field.path)
                named += _named_fields(field, labels)
                rows += () if labels else _rows_of_fields(field, length)
        sets: list[_Set] = []
        for kind in ("vector", "integer", "number"):
            sets += _siblings({field.name: field for field in named if field.is_a == kind})
        sets += ((row, [each.foot(f"foot_{n}") for n, each in enumerate(row)], ()) for row in rows)
        for fields, feet, own in sets:
            marks = [*name_marks([field.name for field in fields], type_name), *own]
            rate = _rate_hz(log, {field.topic for field in fields})
            marks += [rate_mark(rate)] if rate is not None else []
            integer = fields[0].is_a == "integer"
            yield FootCandidates(tuple(feet), type_name, tuple(marks), integer, fields in rows)


def _texts(name: str) -> set[str]:
    return {word.text for word in words_of(name)}


def _fields(topic: str, type_name: str, definition: Struct) -> Iterator[tuple[_Field, int | None]]:
    """Yield the fields whose names speak of forces or contacts, and of nothing that is no foot.

    Each comes with the length of its array, where the definition says. Of a vector, its components
    are no fields of their own.
    """
    kinds = dict(readable_fields(definition))
    vectors = {path for path, kind in kinds.items() if is_vector(kind)}
    for path, kind in kinds.items():
        words = words_of(f"{topic} {type_name} {path}")
        own, said = _texts(path), {word.text for word in words}
        if path in vectors:
            fits = not said.isdisjoint(FORCE_WORDS | {"grf"}) and "torque" not in own
        else:
            told = not said.isdisjoint(CONTACT_WORDS | FORCE_WORDS)
            fits = told or any(word.is_leg for word in words)
        if fits and own.isdisjoint(_OTHER) and path.rpartition(".")[0] not in vectors:
            integer = isinstance(kind, Primitive) and kind.dtype[0] in "iu"
            is_a = "vector" if path in vectors else "integer" if integer else "number"
            name = f"{topic}/{path.replace('.', '/')}"
            yield _Field(topic, path, is_a, name), _length(definition, path)


def _length(definition: Struct, path: str) -> int | None:
    """Return how many elements the first array in a path has, where the definition says."""
    kind: FieldType | None = definition
    for part in path.partition("[]")[0].split("."):
        kind = dict(kind.fields).get(part) if isinstance(kind, Struct) else None
    return kind.length if isinstance(kind, FixedArray) else None


def _named_fields(field: _Field, labels: Sequence[str]) -> Iterator[_Field]:
    """Yield a single field, or the elements of an array that have strings beside them."""
    is_effort = "effort" in _texts(field.path)
    if "[]" not in field.path and not is_effort:
        yield field
    for number, label in enumerate(labels):
        # Most efforts are those of joints.
        is_foot = any(word.is_leg for word in words_of(label)) and _texts(label).isdisjoint(_JOINT)
        if is_foot or not is_effort:
            name = f"{field.topic}/{label}/{field.path.replace('[]', '')}"
            yield replace(field, path=field.path.replace("[]", f"[{number}]"), name=name)


def _rows_of_fields(field: _Field, length: int | None) -> Iterator[list[_Field]]:
    """Yield elements of an array, or bits of an integer; how many feet there are, messages tell."""
    said = _texts(f"{field.topic} {field.path}")
    if "effort" in said:
        return
    if field.path.count("[]") == 1:
        # Numbers may be those of forces, or of forces and torques; the third is along z.
        for step in (1,) if field.is_a == "vector" else (1, 3, 6):
            size = (_MOST_FEET + 1) * step if length is None else length
            if size % step == 0 and _FEWEST_FEET <= size // step <= _MOST_FEET + 1:
                numbers = range(2 if step > 1 else 0, size, step)
                yield [replace(field, path=field.path.replace("[]", f"[{n}]")) for n in numbers]
    elif "[]" not in field.path and field.is_a == "integer" and not said.isdisjoint(_BIT_WORDS):
        yield [replace(field, path=f"{field.path}&{1 << bit}") for bit in range(_MOST_FEET)]


_Set = tuple[list[_Field], list[Foot], tuple[Mark, ...]]
"""Fields, the feet that they would be, and a mark for their names."""


def _siblings(fields: Mapping[str, _Field]) -> Iterator[_Set]:
    """Yield fields of which each may be a foot: by their names' legs, else by any one word."""
    by_leg = name_feet(fields, contacts_only=True)
    sets = [found for found in (by_leg.chosen, *by_leg.offered) if found and found.kind != "alone"]
    differ = {"corners": "front and back, left and right", "sides": "left and right"}
    for one in sets:
        own = [fields[foot.topic] for foot in one.feet]
        feet = [fields[foot.topic].foot(foot.name, foot.position) for foot in one.feet]
        yield own, feet, ((1, f"they differ in {differ.get(one.kind, 'one word')} only"),)
    groups: dict[tuple[str, ...], dict[str, _Field]] = {}
    for name in sorted(fields)[:_MOST_NAMES]:
        words = [word.text for word in words_of(name)]
        for index, word in enumerate(words):
            key = (str(index), *words[:index], *words[index + 1 :])
            groups.setdefault(key, {})[word] = fields[name]
    for group in groups.values():
        known = any(found.topics >= {field.name for field in group.values()} for found in sets)
        if _FEWEST_FEET < len(group) <= _MOST_FEET and not known:
            words = sorted(group, key=lambda word: (int(word) if word.isdigit() else 0, word))
            feet = [group[w].foot(f"foot_{w}" if w.isdigit() else w) for w in words]
            yield [group[w] for w in words], feet, ((1, "they differ in one word only"),)


def _rate_hz(log: Log, topics: Collection[str]) -> float | None:
    """Return the messages a second of the slowest topic."""
    if log.start_time is None or log.end_time is None or log.end_time <= log.start_time:
        return None
    slowest = min(message_count(log, topic) for topic in topics)
    return slowest / ((log.end_time - log.start_time) / 1e9)


def _read_fields(log: Log, sets: Sequence[FootCandidates]) -> Mapping[str, Samples]:
    """Read the fields of some sets as forces, by their names as ``--foot`` takes them."""
    different = {word_of(foot): foot for one in sets for foot in one.feet}
    feet = [
        Foot(word, foot.topic, field=FootField(foot.field.path, "force"))
        for word, foot in different.items()
        if foot.field
    ]
    of_channel: dict[int, tuple[int, ...]] = {}
    for channel in log.channels.values():
        if told := tuple(n for n, foot in enumerate(feet) if has_field(channel, foot)):
            of_channel[channel.id] = told
    channels = tuple(log.channels[number] for number in of_channel)
    chunks = (c for c in log.chunks if not (c.counts and of_channel.keys().isdisjoint(c.counts)))
    wanted = Wanted(channels, FootChannels(feet, of_channel))
    read = read_recording(log, wanted, 1, spans=log.grouped(chunks) if channels else ())
    return {foot.name: samples for foot, samples in zip(feet, read.recording.feet, strict=True)}


def _judged(named: FootCandidates, samples: Sequence[Samples]) -> FootCandidates | None:
    """Add what the content says; None where it cannot be feet."""
    count = _feet_there(named, samples) if named.is_numbered else len(samples)
    content = judge_content(samples[:count])
    if content is None:
        return None
    is_contact = content.is_contact or bool(content.thresholds)
    # It is said only where the type of the field would say something else.
    kind = "" if is_contact == named.is_integer else "contact" if is_contact else "force"
    feet = tuple(
        replace(foot, field=replace(foot.field, kind=kind, threshold=limit))
        for foot, limit in zip(
            named.feet[:count], content.thresholds or (0.0,) * count, strict=True
        )
        if foot.field
    )
    return replace(named, feet=feet, marks=(*named.marks, *content.marks), is_contact=is_contact)


def _feet_there(named: FootCandidates, samples: Sequence[Samples]) -> int:
    """Return how many feet all messages have, the first ones; 0: they are no feet of an array."""
    if "&" in named.words[0]:
        changes = [np.count_nonzero(np.diff(each.in_contact)) for each in samples]
        if max(changes) > _MOST_CHANGES * len(samples[0].in_contact):
            return 0
        count = max((bit + 1 for bit, number in enumerate(changes) if number), default=0)
    else:
        told = [len(each.log_time) for each in samples]
        count = sum(number > 0 for number in told)
        count = count if len(set(told[:count])) == 1 else 0
    return count if _FEWEST_FEET <= count <= _MOST_FEET else 0
