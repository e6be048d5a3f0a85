"""Fields of messages of any type that may be feet, by one score of names, rate and content.

They are offered, with the reasons, and never taken unasked. Names choose some sets of fields; the
columns of these are read of the whole log, like those of any feet, and judged together.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, norms, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.quality import mean_rate_hz
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import FieldType, FixedArray, Primitive
from dogbot_logtool.reader.decode.paths import every_field, is_vector
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.reader.part import Wanted
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.names import FootSet, Mark, name_feet
from dogbot_logtool.robot.topics import has_field, message_count
from dogbot_logtool.robot.words import Part, parts_of, texts_of, word_set

CONTACT_WORDS: Final = word_set("contact contacts grf stance touch touches ground")
FORCE_WORDS: Final = word_set(
    "cell force forces fsr ft fz load loadcell loadcells loads pressure torque weight "
    "wrench wrenches"
)
_OTHER_PART: Final = 4
"""Points that a name costs which speaks of something else beside a foot."""
_NEVER: Final = 20
"""Points of what cannot be feet: nothing can outweigh it."""
_FAST_HZ: Final = 20.0
_FEWEST: Final = 8
"""Samples of a foot from which its values mean something; some are sent on change only."""
_LARGEST_STATE: Final = 3.0
"""Whole numbers up to this are states of a contact: open, closed, slipping."""
_FEWEST_DOWN: Final = 0.8
"""Share of the time in which at least one foot of a walking robot is down."""
_SAME: Final = 0.98
"""Share of the time from which two feet that agree are one signal."""
_BOTH_DIRECTIONS: Final = 0.5
"""Share of the larger that the smaller of push and pull is, from which a number is no load."""
_NOT_UNLOADED: Final = 0.5
"""Share of what each foot reads with load that it reads without, from which numbers are no forces:
those of air pressure, or of a sensor that was never set to zero."""
_TENTH: Final = (10.0, 90.0)
"""Percentiles of what a foot reads without and with load."""
_ENDS: Final = (2.0, 98.0)
"""The same of feet that are hardly ever in the air."""
_ON: Final = 0.2
"""Share of the way between them from which it is on; with all feet down each bears little."""
_ENOUGH: Final = 4
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
    "acc acceleration accel angle angular covariance current effort gain header height linear "
    "orientation pos pose position positions quat stamp temperature time torque twist vel "
    "velocity voltage"
)
"""Words of fields that are no contact."""
_LEGS: Final = frozenset({Part.FOOT, Part.LEG})
_Kinds = Mapping[str, FieldType]
"""The fields of a definition, by path."""


def find_candidates(log: Log) -> list[FootSet]:
    """Find fields that may be feet, the most likely first."""
    named = sorted(_named_sets(log), key=lambda one: -one.points)[:_MOST_SETS]
    columns = _read_fields(log, named)
    judged = (with_content(one, _present(one, columns)) for one in named)
    likely = [one for one in judged if one is not None and one.points >= _ENOUGH]
    return sorted(likely, key=lambda one: -one.points)


# By names


def _named_sets(log: Log) -> Iterator[FootSet]:
    """Yield sets of fields whose names do not speak against feet, scored by names and rate."""
    span_ns = (log.end_time or 0) - (log.start_time or 0)
    by_type: dict[str, dict[str, Channel]] = {}
    for channel in log.channels.values():
        if channel.type_name and source_of(channel, "feet") is None:
            by_type.setdefault(channel.type_name, {}).setdefault(channel.topic, channel)
    for type_name, channels in by_type.items():
        for one in _sets_of_type(channels, type_name):
            slowest = min(message_count(log, topic) for topic in one.topics)
            names, rate_hz = [foot.word for foot in one.feet], mean_rate_hz(slowest, span_ns)
            marks = tuple(name_marks(names, type_name, rate_hz))
            yield one._replace(type_name=type_name, marks=marks)


def _sets_of_type(channels: Mapping[str, Channel], type_name: str) -> Iterator[FootSet]:
    """Yield likely fields of one type of messages that are siblings, or elements of one field."""
    fields: dict[str, dict[str, Foot]] = {"vector": {}, "integer": {}, "number": {}}
    for topic, channel in sorted(channels.items()):
        try:
            kinds = dict(every_field(definition_of(channel)))
        except DefinitionError:
            continue
        for path, is_a in _likely_fields(kinds, f"{topic} {type_name}"):
            name = f"{topic}/{path.replace('.', '/')}"
            if "[]" not in path:
                fields[is_a][name] = _field(name, topic, path, is_a)
            if row := _elements(topic, path, is_a, kinds):
                yield FootSet(row, "elements")
    for own in fields.values():
        yield from _siblings(own)


def _likely_fields(kinds: _Kinds, around: str) -> Iterator[tuple[str, str]]:
    """Yield fields whose names, with their topic and type, may be of feet: path, and what it is.

    Of a vector, its components are no fields of their own.
    """
    near, near_parts = texts_of(around), parts_of([around])
    for path, kind in kinds.items():
        is_part = is_vector(kinds.get(path.rpartition(".")[0]))
        own = texts_of(path)
        texts = own | near
        if own & _OTHER_WORDS or is_part:
            continue
        if is_vector(kind) and texts & (FORCE_WORDS | {"grf"}):
            yield path, "vector"
        is_told = texts & (CONTACT_WORDS | FORCE_WORDS) or (near_parts | parts_of([path])) & _LEGS
        if isinstance(kind, Primitive) and is_told:
            yield path, "integer" if kind.dtype[0] in "iu" else "number"


def _field(name: str, topic: str, path: str, is_a: str) -> Foot:
    """Return a field as a foot; what integers are read as is said until their content tells."""
    field = FootField(path, kind="contact" if is_a == "integer" else "")
    return Foot(name, topic, field=field)


def _elements(topic: str, path: str, is_a: str, kinds: _Kinds) -> tuple[Foot, ...]:
    """Return elements of an array, or bits of an integer; messages tell how many are feet."""
    paths: list[str] = []
    if path.count("[]") == 1:
        array = kinds[path.partition("[]")[0]]
        size = array.length if isinstance(array, FixedArray) else _MOST_FEET + 1
        if _FEWEST_FEET <= size <= _MOST_FEET + 1:
            paths = [path.replace("[]", f"[{number}]") for number in range(size)]
    elif "[]" not in path and is_a == "integer" and texts_of(topic, path) & _BIT_WORDS:
        paths = [f"{path}&{1 << bit}" for bit in range(_MOST_FEET)]
    return tuple(_field(f"foot_{n}", topic, each, is_a) for n, each in enumerate(paths))


def _siblings(fields: Mapping[str, Foot]) -> Iterator[FootSet]:
    """Yield fields of which each may be a foot: by their names' legs, else by any one number."""
    chosen, others = name_feet(fields, contacts_only=True)
    sets = [one for one in (chosen, *others) if one]
    for one in sets:
        told = [(foot, fields[foot.topic]) for foot in one.feet]
        feet = [replace(foot, topic=own.topic, field=own.field) for foot, own in told]
        yield one._replace(feet=tuple(feet))
    groups: dict[str, dict[int, str]] = {}
    for name in sorted(fields)[:_MOST_NAMES]:
        for number in re.finditer("[0-9]{1,9}", name):
            key = f"{name[: number.start()]}#{name[number.end() :]}"
            groups.setdefault(key, {})[int(number[0])] = name
    for group in groups.values():
        known = any(one.topics >= {*group.values()} for one in sets)
        if _FEWEST_FEET < len(group) <= _MOST_FEET and not known:
            feet = [replace(fields[name], name=f"foot_{n}") for n, name in sorted(group.items())]
            yield FootSet(tuple(feet), "one number")


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


# --- the score ---


def name_marks(names: Collection[str], type_name: str, rate_hz: float | None) -> Iterator[Mark]:
    """Judge names of fields, with their topics, of the type of their messages, and their rate."""
    parts, texts = parts_of(names), texts_of(*names, type_name)
    if parts & {Part.FOOT, Part.LEG}:
        yield 2, "the names speak of feet or legs"
    if Part.NOT_A_FOOT in parts:
        # Hands, wheels, tools ...
        yield (-_OTHER_PART if parts & {Part.FOOT, Part.LEG} else -_NEVER), ""
    if texts & (CONTACT_WORDS | FORCE_WORDS):
        yield 1, "of contact or force"
    if rate_hz is not None:
        yield int(rate_hz >= _FAST_HZ), f"{rate_hz:.0f} messages a second"


def with_content(named: FootSet, feet: Sequence[Samples]) -> FootSet | None:
    """Judge also by the values, which were read as forces; None: too few were seen.

    Args:
        named: fields, judged by their names.
        feet: samples of the first fields by log time; messages do not have the others.
    """
    if min((len(each.log_time) for each in feet), default=0) < _FEWEST:
        return None
    signed = _side_by_side(feet)
    values = np.abs(signed)
    are_states = bool((values <= _LARGEST_STATE).all() and (values == np.round(values)).all())
    low, high = percentiles_of(values, _TENTH, axis=0)
    down = values > 0.0 if are_states else values > low + _ON * (high - low)
    marks = [*_in_time(down)]
    if sum(points for points, _ in marks) <= 0:
        marks.append((-_NEVER, "no foot reads so"))
    pull, push = percentiles_of(signed, _TENTH, axis=0) * np.array([[-1.0], [1.0]])
    alike = np.minimum(pull, push) > _BOTH_DIRECTIONS * np.maximum(pull, push)
    if not are_states and bool((alike & (pull > 0.0)).any()):
        marks.append((-_NEVER, "the ground does not pull"))
    is_number = not are_states and not any(each.force[:, :2].any() for each in feet)
    low, high = percentiles_of(values, _ENDS, axis=0)
    if is_number and bool((signed > 0.0).all()) and bool((low > _NOT_UNLOADED * high).all()):
        marks.append((-_NEVER, "none reads near zero without load"))
    kind = "contact" if are_states else "force"
    told = []
    for foot, field in [(each, each.field) for each in named.feet[: len(feet)] if each.field]:
        # It is said only where the type of the field would say something else.
        said = "" if kind == (field.kind or "force") else kind
        told.append(replace(foot, field=replace(field, kind=said)))
    return named._replace(feet=tuple(told), marks=(*named.marks, *marks))


def _side_by_side(feet: Sequence[Samples]) -> Floats:
    """Return (n, feet) at the samples of all feet: numbers with their sign, or magnitudes."""
    time = np.unique(np.concatenate([each.log_time for each in feet]))
    columns = []
    for each in feet:
        before = np.searchsorted(each.log_time, time, side="right") - 1
        column = norms(each.force) if each.force[:, :2].any() else each.force[:, 2]
        columns.append(column[np.maximum(before, 0)])
    return np.stack(columns, axis=1)


def _in_time(down: Flags) -> Iterator[Mark]:
    """Judge when feet are on, (n, feet): each on and off, and in turns."""
    feet = down.shape[1]
    changes = np.count_nonzero(np.diff(down, axis=0), axis=0)
    stepping = np.count_nonzero(changes > 1)
    if stepping == feet:
        yield 2, f"all {feet} go on and off, {changes.min()} times and more"
    alike = min((down[:, i] == down[:, k]).mean() for i in range(feet) for k in range(i))
    some, every = float(down.any(axis=1).mean()), float(down.all(axis=1).mean())
    if alike <= _SAME and some >= _FEWEST_DOWN and every < some:
        yield 2, f"in turns: at least one is on {some:.0%} of the time, all at once {every:.0%}"
