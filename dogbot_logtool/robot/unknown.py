"""Fields of messages of any type that may be feet, by their names and content.

They are offered, with the reasons, and never taken unasked. Names choose some sets of fields; the
columns of these are read of the whole log, like those of any feet, and judged together.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, norms, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
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
from dogbot_logtool.robot.names import FootSet, name_feet
from dogbot_logtool.robot.topics import has_field
from dogbot_logtool.robot.words import Part, parts_of, texts_of, word_set

_CONTACT_WORDS: Final = word_set("contact contacts grf stance touch touches ground")
_FORCE_WORDS: Final = word_set(
    "cell force forces fsr ft fz grf load loadcell loadcells loads pressure torque weight "
    "wrench wrenches"
)
_BIT_WORDS: Final = _CONTACT_WORDS | {"bits", "bitmask", "mask"}
_OTHER_WORDS: Final = word_set(
    "acc acceleration accel angle angular covariance current effort gain header height linear "
    "orientation pos pose position positions quat stamp temperature time torque twist vel "
    "velocity voltage"
)
"""Words of fields that are no contact."""
_LEGS: Final = frozenset({Part.FOOT, Part.LEG})
_FEWEST_REASONS: Final = 3
"""Of two by names, and two by when fields are on: from so many they are offered as feet."""
_FEWEST: Final = 8
"""Samples of a foot from which its values mean something; some are sent on change only."""
_LARGEST_STATE: Final = 3.0
"""Whole numbers up to this are states of a contact: open, closed, slipping."""
_FEWEST_DOWN: Final = 0.8
"""Share of the time in which at least one foot of a walking robot is down."""
_SAME: Final = 0.98
"""Share of the time from which two feet that agree are one signal."""
_ENDS: Final = (2.0, 98.0)
"""Percentiles of what a foot reads."""
_ALIKE: Final = 0.5
"""Share of the larger end that the smaller one is, from which numbers are no loads: push and pull
alike, or, of all feet, never near zero, like pressures of air."""
_ON: Final = 0.2
"""Share of the way between them from which it is on; with all feet down each bears little."""
_MOST_SETS: Final = 40
"""Sets of fields whose content is looked at."""
_FEWEST_FEET, _MOST_FEET = 2, 8
_MOST_CHANGES: Final = 0.2
"""Changes a sample from which a bit is no foot's: those of a number change with each message."""


def find_candidates(log: Log) -> list[FootSet]:
    """Find fields that may be feet, the most likely first."""
    named = sorted(_named_sets(log), key=lambda one: -len(one.reasons))[:_MOST_SETS]
    columns = _read_fields(log, named)
    judged = (_with_content(one, _present(one, columns)) for one in named)
    return sorted(filter(None, judged), key=lambda one: -len(one.reasons))


# By names


def _named_sets(log: Log) -> Iterator[FootSet]:
    """Yield sets of fields of one type whose names do not speak against feet."""
    by_type: dict[str, dict[str, Channel]] = {}
    for channel in log.channels.values():
        if channel.type_name and source_of(channel, "feet") is None:
            by_type.setdefault(channel.type_name, {}).setdefault(channel.topic, channel)
    for type_name, channels in by_type.items():
        for one in _sets_of_type(channels, type_name):
            names = [foot.word for foot in one.feet]
            parts, reasons = parts_of(names), list[str]()
            if parts & _LEGS:
                reasons.append("the names speak of feet or legs")
            elif Part.NOT_A_FOOT in parts:
                continue
            if texts_of(*names, type_name) & (_CONTACT_WORDS | _FORCE_WORDS):
                reasons.append("of contact or force")
            yield one._replace(reasons=tuple(reasons))


def _sets_of_type(channels: Mapping[str, Channel], type_name: str) -> Iterator[FootSet]:
    """Yield likely fields of one type of messages that are siblings, or elements of one field."""
    fields: dict[str, dict[str, Foot]] = {"vector": {}, "integer": {}, "number": {}}
    for topic, channel in sorted(channels.items()):
        try:
            kinds = dict(every_field(definition_of(channel)))
        except DefinitionError:
            continue
        for path, is_a in _likely_fields(kinds, f"{topic} {type_name}"):
            if "[]" not in path:
                name = f"{topic}/{path.replace('.', '/')}"
                fields[is_a][name] = _field(name, topic, path, is_a)
            paths = enumerate(_elements(topic, path, is_a, kinds))
            if row := [_field(f"foot_{number}", topic, each, is_a) for number, each in paths]:
                yield FootSet(tuple(row), "elements")
    for own in fields.values():
        chosen, others = name_feet(own, contacts_only=True)
        for one in filter(None, (chosen, *others)):
            told = [(foot, own[foot.topic]) for foot in one.feet]
            feet = [replace(foot, topic=each.topic, field=each.field) for foot, each in told]
            yield one._replace(feet=tuple(feet))


def _likely_fields(kinds: Mapping[str, FieldType], around: str) -> Iterator[tuple[str, str]]:
    """Yield fields whose names, with their topic and type, may be of feet: path, and what it is.

    Of a vector, its components are no fields of their own.
    """
    for path, kind in kinds.items():
        is_part = is_vector(kinds.get(path.rpartition(".")[0]))
        if is_part or texts_of(path) & _OTHER_WORDS:
            continue
        texts = texts_of(path, around)
        if is_vector(kind) and texts & _FORCE_WORDS:
            yield path, "vector"
        is_told = texts & (_CONTACT_WORDS | _FORCE_WORDS) or parts_of([path, around]) & _LEGS
        if isinstance(kind, Primitive) and is_told:
            yield path, "integer" if kind.dtype[0] in "iu" else "number"


def _field(name: str, topic: str, path: str, is_a: str) -> Foot:
    """Return a field as a foot; what integers are read as is said until their content tells."""
    field = FootField(path, kind="contact" if is_a == "integer" else "")
    return Foot(name, topic, field=field)


def _elements(topic: str, path: str, is_a: str, kinds: Mapping[str, FieldType]) -> list[str]:
    """Return elements of an array, or bits of an integer; messages tell how many are feet."""
    if path.count("[]") == 1:
        array = kinds[path.partition("[]")[0]]
        size = array.length if isinstance(array, FixedArray) else _MOST_FEET + 1
        if _FEWEST_FEET <= size <= _MOST_FEET + 1:
            return [path.replace("[]", f"[{number}]") for number in range(size)]
    elif "[]" not in path and is_a == "integer" and texts_of(topic, path) & _BIT_WORDS:
        return [f"{path}&{1 << bit}" for bit in range(_MOST_FEET)]
    return []


# By content


def _read_fields(log: Log, sets: Sequence[FootSet]) -> Mapping[str, Samples]:
    """Read the fields of some sets as forces, by their names as ``--foot`` takes them."""
    feet = [
        Foot(word, foot.topic, field=FootField(foot.field.path, "force"))
        for word, foot in {foot.word: foot for one in sets for foot in one.feet}.items()
        if foot.field
    ]
    of_channel: dict[Channel, tuple[int, ...]] = {}
    for channel in log.channels.values():
        if told := tuple(n for n, foot in enumerate(feet) if has_field(channel, foot)):
            of_channel[channel] = told
    wanted = Wanted(FootChannels(feet, of_channel))
    spans = log.grouped(log.chunks_of({channel.id for channel in of_channel}))
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


def _with_content(named: FootSet, feet: Sequence[Samples]) -> FootSet | None:
    """Judge also by the values, which were read as forces; None: they are not those of feet.

    Args:
        named: fields, judged by their names.
        feet: samples of the first fields by log time; messages do not have the others.
    """
    if min((len(each.log_time) for each in feet), default=0) < _FEWEST:
        return None
    signed = _side_by_side(feet)
    values = np.abs(signed)
    are_states = bool((values <= _LARGEST_STATE).all() and (values == np.round(values)).all())
    down = values > 0.0
    if not are_states:
        low, high = percentiles_of(values, _ENDS, axis=0)
        down = values > low + _ON * (high - low)
        low, high = percentiles_of(signed, _ENDS, axis=0)
        small, large = np.where(np.abs(low) < np.abs(high), (low, high), (high, low))
        share = small / np.where(large == 0.0, 1.0, large)
        if (share < -_ALIKE).any() or (share > _ALIKE).all():
            return None
    reasons = *named.reasons, *_in_time(down)
    if len(reasons) < _FEWEST_REASONS:
        return None
    kind = "contact" if are_states else "force"
    told = []
    for foot, field in [(each, each.field) for each in named.feet[: len(feet)] if each.field]:
        # It is said only where the type of the field would say something else.
        said = "" if kind == (field.kind or "force") else kind
        told.append(replace(foot, field=replace(field, kind=said)))
    return named._replace(feet=tuple(told), reasons=reasons)


def _side_by_side(feet: Sequence[Samples]) -> Floats:
    """Return (n, feet) at the samples of all feet: numbers with their sign, or magnitudes."""
    time = np.unique(np.concatenate([each.log_time for each in feet]))
    columns = []
    for each in feet:
        before = np.searchsorted(each.log_time, time, side="right") - 1
        column = norms(each.force) if each.force[:, :2].any() else each.force[:, 2]
        columns.append(column[np.maximum(before, 0)])
    return np.stack(columns, axis=1)


def _in_time(down: Flags) -> Iterator[str]:
    """Yield what speaks for feet in when they are on, (n, feet): each on and off, and in turns."""
    feet = down.shape[1]
    changes = np.count_nonzero(np.diff(down, axis=0), axis=0)
    if (changes > 1).all():
        yield f"all {feet} go on and off, {changes.min()} times and more"
    alike = min((down[:, i] == down[:, k]).mean() for i in range(feet) for k in range(i))
    some, every = float(down.any(axis=1).mean()), float(down.all(axis=1).mean())
    if alike <= _SAME and some >= _FEWEST_DOWN and every < some:
        yield f"in turns: at least one is on {some:.0%} of the time, all at once {every:.0%}"
