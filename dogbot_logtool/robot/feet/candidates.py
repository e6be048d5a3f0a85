"""Fields of messages of any type that may be feet: scored by name, siblings, rate and content.

They are offered, with the reasons, and never taken unasked.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from dogbot_logtool.core.arrays import concatenated
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import FieldType, FixedArray, Struct
from dogbot_logtool.reader.decode.field_path import is_vector, readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contact_messages import read_contacts, source_of
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.chunks import spread_chunks
from dogbot_logtool.robot.feet.content import Content, judge_content
from dogbot_logtool.robot.feet.elements import (
    FEWEST_LEGS,
    MOST_FEET,
    PossibleField,
    array_feet,
    bit_feet,
    feet_there,
    named_elements,
)
from dogbot_logtool.robot.feet.labels import with_labels
from dogbot_logtool.robot.feet.names import FootSet, NamedFoot, leg_position, name_feet
from dogbot_logtool.robot.feet.words import MERITS, Part, words_of

ENOUGH: Final = 5
"""Points from which fields are offered as feet."""
_MOST_SETS: Final = 40
"""Sets of fields whose content is looked at."""
_MOST_NAMES: Final = 2000
"""Names that are compared with each other."""
_USUAL_LEGS: Final = (2, 4, 6, 8)
_OTHER_PART: Final = 4
"""Points that a name costs which speaks of something else beside a foot."""
_NO_FOOT: Final = 20
"""Points that a name costs which speaks of something else only: none can outweigh it."""
_SLOW_HZ, _FAST_HZ = 5.0, 20.0
_CONTACT: Final = frozenset({"contact", "contacts", "grf", "stance", "touch", "touches", "ground"})
_FORCE: Final = frozenset(
    {"cell", "effort", "force", "forces", "fsr", "ft", "fz", "load", "loadcell", "loadcells",
     "loads", "pressure", "torque", "weight", "wrench", "wrenches"}
)  # fmt: skip
_BITS: Final = frozenset({"bits", "bitmask", "mask"})
_OTHER: Final = frozenset(
    {"acc",
        "acceleration", "accel", "angle", "angular", "covariance", "current", "effort", "gain",
     "header", "height", "linear", "orientation", "pos", "pose", "position", "positions", "quat",
     "stamp", "temperature", "time", "torque", "twist", "vel", "velocity", "voltage"}
)  # fmt: skip
"""Words of fields that are no contact."""


@dataclass(frozen=True, slots=True)
class FootCandidates:
    """Fields that may be the feet of a robot."""

    feet: tuple[Foot, ...]
    type_name: str
    points: int
    reasons: tuple[str, ...]
    is_contact: bool = False
    """Whether the fields only tell contact, and no force."""
    is_numbered: bool = False
    """Whether they are the elements of an array or bits, of which messages have fewer."""

    @property
    def text(self) -> str:
        """The fields, their points and the reasons, for people."""
        return f"{self.fields} ({self.points} points: {'; '.join(self.reasons)})"

    @property
    def fields(self) -> str:
        """The feet and their fields, for people."""
        return ", ".join(f"{foot.name} = {word_of(foot)}" for foot in self.feet)


def word_of(foot: Foot) -> str:
    """Return a foot's topic and field as ``--foot`` takes them."""
    return f"{foot.topic}:{foot.field.path}" if foot.field else foot.topic


def find_candidates(log: Log) -> list[FootCandidates]:
    """Find fields that may be feet, the most likely first.

    Only a few chunks of the log are read.
    """
    named = sorted(_named_sets(log), key=lambda one: -one.points)[:_MOST_SETS]
    judged = (_judged(log, one) for one in named)
    likely = [one for one in judged if one is not None and one.points >= ENOUGH]
    return _without_repeats(sorted(likely, key=lambda one: (-one.points, one.is_contact)))


def _without_repeats(sets: Iterable[FootCandidates]) -> list[FootCandidates]:
    kept: list[FootCandidates] = []
    seen: set[frozenset[str]] = set()
    for one in sets:
        key = frozenset(word_of(foot) for foot in one.feet)
        if not any(key <= other for other in seen):
            kept.append(one)
            seen.add(key)
    return kept


def _named_sets(log: Log) -> Iterator[FootCandidates]:
    """Yield sets of fields whose names do not speak against feet."""
    by_type: dict[str, list[Channel]] = {}
    for channel in log.channels.values():
        if channel.type_name and source_of(channel) is None:
            by_type.setdefault(channel.type_name, []).append(channel)
    for type_name, channels in by_type.items():
        try:
            definition = definition_of(channels[0])
        except DefinitionError:
            continue
        topics = sorted({channel.topic for channel in channels})
        fields = _possible_fields(definition, _OTHER)
        efforts = [
            each for each in _possible_fields(definition, _OTHER - {"effort"}) if each not in fields
        ]
        yield from _of_sibling_topics(log, type_name, topics, fields)
        for topic in topics:
            yield from _of_sibling_fields(log, type_name, topic, fields)
            for field in fields:
                yield from _inside_messages(log, type_name, topic, field)
            for field in efforts:
                if named := named_elements(log, topic, field):
                    yield _scored(log, type_name, *named, [topic])


def _possible_fields(definition: Struct, other: frozenset[str]) -> list[PossibleField]:
    """Return the fields whose names say nothing else; of a vector not its components, too."""
    fields = dict(readable_fields(definition))
    vectors = {path for path, kind in fields.items() if is_vector(kind)}
    return [
        PossibleField(path, kind, _length(definition, path))
        for path, kind in fields.items()
        if not _says(path, other) and path.rpartition(".")[0] not in vectors
    ]


def _of_sibling_topics(
    log: Log, type_name: str, topics: Sequence[str], fields: Sequence[PossibleField]
) -> Iterator[FootCandidates]:
    """Yield the same field of several topics: ``/leg_1/contact:data`` ..."""
    for field in fields:
        if "[]" in field.path or not _fits(f"{' '.join(topics)} {type_name} {field.path}", field):
            continue
        for found in _siblings(topics, contacts_only=field.is_flag):
            feet = _feet(found, [(foot.topic, field.path) for foot in found.feet])
            yield _scored(log, type_name, feet, found, found.topics)


def _siblings(names: Collection[str], *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield names of which each may be that of one foot: by their legs, else by any one word."""
    by_leg = name_feet(names, contacts_only=contacts_only)
    sets = [found for found in (by_leg.chosen, *by_leg.offered) if found and found.kind != "alone"]
    yield from sets
    known = [found.topics for found in sets]
    for found in _differing_in_a_word(names):
        if not any(found.topics <= topics for topics in known):
            yield found


def _differing_in_a_word(names: Collection[str]) -> Iterator[FootSet]:
    """Yield sets of names that are alike but for one word, such as a number."""
    groups: dict[tuple[str, ...], dict[str, str]] = {}
    for name in sorted(names)[:_MOST_NAMES]:
        words = [word.text for word in words_of(name)]
        for index, word in enumerate(words):
            key = (str(index), *words[:index], *words[index + 1 :])
            groups.setdefault(key, {})[word] = name
    for group in groups.values():
        if FEWEST_LEGS < len(group) <= MOST_FEET:
            feet = tuple(
                NamedFoot(f"foot_{word}" if word.isdigit() else word, name, leg_position(word))
                for word, name in sorted(group.items(), key=_natural)
            )
            yield FootSet(feet, "words", Part.UNKNOWN, frozenset())


def _natural(entry: tuple[str, str]) -> tuple[int, str]:
    return (int(entry[0]) if entry[0].isdigit() else 0, entry[0])


def _of_sibling_fields(
    log: Log, type_name: str, topic: str, fields: Sequence[PossibleField]
) -> Iterator[FootCandidates]:
    """Yield fields of one message whose names differ in the leg: ``stance_lf`` ..."""
    for is_vector_field in (False, True):
        paths = {
            f"{topic}/{field.path.replace('.', '/')}": field.path
            for field in fields
            if "[]" not in field.path
            and is_vector(field.field_type) == is_vector_field
            and _fits(f"{topic} {type_name} {field.path}", field)
        }
        for found in _siblings(paths, contacts_only=True):
            feet = _feet(found, [(topic, paths[foot.topic]) for foot in found.feet])
            yield _scored(log, type_name, feet, found, [topic])


def _inside_messages(
    log: Log, type_name: str, topic: str, field: PossibleField
) -> Iterator[FootCandidates]:
    """Yield feet that are elements of an array, or bits of an integer."""
    if not _fits(f"{topic} {type_name} {field.path}", field):
        return
    if named := named_elements(log, topic, field):
        yield _scored(log, type_name, *named, [topic])
    sets = [*array_feet(topic, field)]
    if _says(f"{topic} {field.path}", _CONTACT | _BITS):
        sets += [bit_feet(topic, field)]
    for feet in filter(None, sets):
        one = _scored(log, type_name, feet, None, [topic])
        yield replace(one, is_numbered=True)


def _fits(name: str, field: PossibleField) -> bool:
    """Tell whether names speak of forces or contacts, and of nothing that is no foot."""
    words = {word.text for word in words_of(name)}
    of_field = {word.text for word in words_of(field.path)}
    if is_vector(field.field_type):
        return not words.isdisjoint(_FORCE | {"grf"}) and of_field.isdisjoint({"torque"})
    legs = {word.text for word in words_of(name) if word.part in {Part.FOOT, Part.LEG}}
    return not words.isdisjoint(_CONTACT | _FORCE) or bool(legs)


def _feet(found: FootSet, fields: Sequence[tuple[str, str]]) -> tuple[Foot, ...]:
    return tuple(
        Foot(foot.name, topic, leg_position=foot.position or leg_position(foot.name),
             field=FootField(path))
        for foot, (topic, path) in zip(found.feet, fields, strict=True)
    )  # fmt: skip


def _scored(
    log: Log,
    type_name: str,
    feet: tuple[Foot, ...],
    found: FootSet | None,
    topics: Iterable[str],
) -> FootCandidates:
    """Score names and rate."""
    reasons: list[str] = []
    points = 0
    words = {word.text for foot in feet for word in words_of(f"{word_of(foot)} {type_name}")}
    parts = {word.part for foot in feet for word in words_of(word_of(foot))}
    if Part.FOOT in parts or Part.LEG in parts:
        points += 2
        reasons.append("the names speak of feet or legs")
    points -= _cost_of_parts(parts)
    if not words.isdisjoint(_CONTACT | _FORCE):
        points += 1
        reasons.append("of contact or force")
    if found is not None:
        points += 1
        what = {"corners": "front and back, left and right", "sides": "left and right"}
        reasons.append(f"they differ in {what.get(found.kind, 'one word')} only")
    merit = min((MERITS.get(word, 0) for word in words), default=0)
    if merit < -1:
        points += merit
        reasons.append("they are named as planned or set, not measured")
    rate = _rate_hz(log, topics)
    if rate is not None:
        points += 1 if rate >= _FAST_HZ else -2 if rate < _SLOW_HZ else 0
        reasons.append(f"{rate:.0f} messages a second")
    return FootCandidates(feet, type_name, points, tuple(reasons))


def _rate_hz(log: Log, topics: Iterable[str]) -> float | None:
    """Return the messages a second of the slowest topic."""
    if log.start_time is None or log.end_time is None or log.end_time <= log.start_time:
        return None
    counts = [
        sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))
        for topic in topics
    ]
    return min(counts, default=0) / ((log.end_time - log.start_time) / 1e9)


def _judged(log: Log, named: FootCandidates) -> FootCandidates | None:
    """Add what the content says; None where it cannot be feet."""
    samples = read_feet(log, named.feet)
    field = named.feet[0].field
    if named.is_numbered and field is not None:
        count = feet_there(named.feet, samples)
        if not count:
            return None
        named = _labelled(log, replace(named, feet=named.feet[:count]))
    content = judge_content(samples, len(named.feet))
    if content is None or content.points <= 0:
        return None
    usual = len(named.feet) in _USUAL_LEGS
    feet = tuple(_with_kind(log, foot, content) for foot in named.feet)
    if content.thresholds:
        feet = tuple(map(_with_threshold, feet, content.thresholds))
    return replace(
        named,
        feet=feet,
        points=named.points + content.points + (1 if usual else -1),
        reasons=(*named.reasons, *content.reasons),
        is_contact=content.is_contact or bool(content.thresholds),
    )


def _labelled(log: Log, named: FootCandidates) -> FootCandidates:
    """Name the elements of an array by the strings beside them, and score these."""
    feet, labels = with_labels(log, named.feet)
    parts = {word.part for label in labels for word in words_of(label)}
    if cost := _cost_of_parts(parts):
        return replace(named, feet=feet, points=named.points - cost)
    if not labels:
        return named
    reason = f"they are called {', '.join(labels)}"
    points = named.points + (1 if parts.isdisjoint({Part.FOOT, Part.LEG}) else 2)
    return replace(named, feet=feet, points=points, reasons=(*named.reasons, reason))


def _cost_of_parts(parts: Collection[Part | None]) -> int:
    """Return the points that names cost which speak of hands, wheels, tools ..."""
    if Part.NOT_A_FOOT not in parts:
        return 0
    return _OTHER_PART if {Part.FOOT, Part.LEG} & set(parts) else _NO_FOOT


def _with_kind(log: Log, foot: Foot, content: Content) -> Foot:
    """Say whether a field is a force or a contact, where its type would say something else."""
    if foot.field is None:
        return foot
    for channel in log.channels_by_topic[foot.topic]:
        try:
            source = source_of(channel, [foot])
        except DefinitionError:
            continue
        if source is not None and source.has_force != content.is_contact:
            return foot
    kind = "contact" if content.is_contact else "force"
    return replace(foot, field=replace(foot.field, kind=kind))


def _with_threshold(foot: Foot, threshold: float) -> Foot:
    """Return a foot whose field is a contact above a threshold."""
    if foot.field is None:
        return foot
    return replace(foot, field=replace(foot.field, kind="contact", threshold=threshold))


def read_feet(log: Log, feet: Sequence[Foot]) -> Samples:
    """Read feet as forces from a few chunks, spread over a log."""
    forced = [replace(foot, field=replace(foot.field, kind="force")) for foot in feet if foot.field]
    of_channel: dict[int, tuple[int, ...]] = {}
    channels: list[Channel] = []
    for topic in {foot.topic for foot in forced}:
        own = tuple(index for index, foot in enumerate(forced) if foot.topic == topic)
        for channel in log.channels_by_topic.get(topic, ()):
            try:
                source_of(channel, [forced[index] for index in own])
            except DefinitionError:
                continue
            of_channel[channel.id] = own
            channels.append(channel)
    found = [no_samples()]
    for span in log.grouped(spread_chunks(log, of_channel.keys())):
        decoded = read_contacts(log.read(span), channels, FootChannels(forced, of_channel))
        found.extend(read.reduced.samples for read in decoded)
    return concatenated(found)


def _says(path: str, words: frozenset[str]) -> bool:
    return not words.isdisjoint(word.text for word in words_of(path))


def _length(definition: Struct, path: str) -> int | None:
    """Return how many elements an array has whose definition says so."""
    current: FieldType = definition
    for part in path.partition("[]")[0].split("."):
        if not isinstance(current, Struct):
            return None
        current = dict(current.fields)[part]
    return current.length if isinstance(current, FixedArray) else None
