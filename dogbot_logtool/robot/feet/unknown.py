"""Fields of messages of any type that may be feet: one score of names, rate and content.

They are offered, with the reasons, and never taken unasked. Names choose some sets of fields; the
columns of these are read of the whole log, like those of any feet, and judged together.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed, shell_joined, shell_quoted
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import FieldType, FixedArray, Primitive, Struct
from dogbot_logtool.reader.decode.field_path import is_vector, readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.feet.content import Content, judge_content
from dogbot_logtool.robot.feet.labels import array_labels
from dogbot_logtool.robot.feet.names import FootSet, NamedFoot, label_names, leg_position, name_feet
from dogbot_logtool.robot.feet.words import ENDS, MERITS, SIDES, Part, words_of

_ENOUGH: Final = 5
"""Points from which fields are offered as feet."""
_MOST_SETS: Final = 40
"""Sets of fields whose content is looked at."""
_MOST_NAMES: Final = 2000
"""Names that are compared with each other."""
_FEWEST_FEET, _MOST_FEET = 2, 8
_USUAL_FEET: Final = (2, 4, 6, 8)
_COMPONENTS: Final = (3, 6)
"""Numbers a foot of an array of forces, or of forces and torques; the third is along z."""
_MOST_CHANGES: Final = 0.2
"""Changes a sample from which a bit is no foot's: those of a number change with each message."""
_OTHER_PART: Final = 4
"""Points that a name costs which speaks of something else beside a foot."""
_NO_FOOT: Final = 20
"""Points that a name costs which speaks of something else only: none can outweigh it."""
_SLOW_HZ, _FAST_HZ = 5.0, 20.0
_ALTERNATIVES: Final = 2
"""Sets that are offered beside the most likely one."""
_CONTACT: Final = frozenset({"contact", "contacts", "grf", "stance", "touch", "touches", "ground"})
_FORCE_WORDS: Final = (
    "cell effort force forces fsr ft fz load loadcell loadcells loads pressure torque weight "
    "wrench wrenches"
)
_FORCE: Final = frozenset(_FORCE_WORDS.split())
_BITS: Final = frozenset({"bits", "bitmask", "mask"})
_OTHER_WORDS: Final = (
    "acc acceleration accel angle angular covariance current gain header height linear orientation "
    "pos pose position positions quat stamp temperature time torque twist vel velocity voltage"
)
"""Words of fields that are no contact. So is an effort, unless the strings beside it name feet."""
_OTHER: Final = frozenset(_OTHER_WORDS.split())
_JOINT_WORDS: Final = "ankle drive hip joint knee motor pitch roll servo yaw"
"""Words of names that are a joint's, whose effort is no foot's force."""
_JOINT: Final = frozenset(_JOINT_WORDS.split())
_SOLE_WORDS: Final = "heel inner inside lateral medial outer outside toe"
_IN_A_SOLE: Final = frozenset({*ENDS, *SIDES, *_SOLE_WORDS.split()})
"""Words, beside numbers, that tell apart the sensors in a sole."""


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


@dataclass(frozen=True, slots=True)
class _Field:
    """A field of the messages of some topics."""

    path: str
    """With ``[]`` for an index."""
    kind: FieldType
    length: int | None
    """Elements of its array, where the definition says."""

    @property
    def is_flag(self) -> bool:
        """Whether it is a boolean."""
        return isinstance(self.kind, Primitive) and self.kind.name == "bool"

    def fits(self, name: str) -> bool:
        """Tell whether names speak of forces or contacts, and of nothing that is no foot."""
        found = words_of(f"{name} {self.path}")
        words = {word.text for word in found}
        if is_vector(self.kind):
            own = {word.text for word in words_of(self.path)}
            return not words.isdisjoint(_FORCE | {"grf"}) and "torque" not in own
        return not words.isdisjoint(_CONTACT | _FORCE) or any(word.is_leg for word in found)


def word_of(foot: Foot) -> str:
    """Return a foot's topic and field as ``--foot`` takes them."""
    return f"{foot.topic}:{foot.field.path}" if foot.field else foot.topic


def find_candidates(log: Log) -> list[FootCandidates]:
    """Find fields that may be feet, the most likely first."""
    named = sorted(_named_sets(log), key=lambda one: -one.points)[:_MOST_SETS]
    columns = _read_fields(log, named)
    judged = (_judged(log, one, columns) for one in named)
    likely = [one for one in judged if one is not None and one.points >= _ENOUGH]
    kept: list[FootCandidates] = []
    seen: list[set[str]] = []
    for one in sorted(likely, key=lambda one: (-one.points, one.is_contact)):
        words = {word_of(foot) for foot in one.feet}
        if not any(words <= other for other in seen):
            kept.append(one)
            seen.append(words)
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
        fields = list(_fields(definition))
        plain = [field for field in fields if "effort" not in _texts(field.path)]
        for names, contacts_only in _names_of_fields(type_name, topics, plain):
            for found in _siblings(names, contacts_only=contacts_only):
                told = [names[foot.topic] for foot in found.feet]
                yield _scored(log, type_name, _feet(found, told), found)
        for topic in topics:
            for field in fields:
                if field not in plain or field.fits(f"{topic} {type_name}"):
                    yield from _inside_messages(
                        log, type_name, topic, field, is_plain=field in plain
                    )


def _inside_messages(
    log: Log, type_name: str, topic: str, field: _Field, *, is_plain: bool
) -> Iterator[FootCandidates]:
    """Yield feet that are elements of an array, or bits of an integer."""
    if named := _named_elements(log, topic, field):
        yield _scored(log, type_name, *named)
    for feet in _numbered_feet(topic, field) if is_plain else ():
        yield replace(_scored(log, type_name, feet), is_numbered=True)


def _texts(name: str) -> set[str]:
    return {word.text for word in words_of(name)}


def _fields(definition: Struct) -> Iterator[_Field]:
    """Yield the fields whose names say nothing else; of a vector not its components, too."""
    kinds = dict(readable_fields(definition))
    vectors = {path for path, kind in kinds.items() if is_vector(kind)}
    for path, kind in kinds.items():
        if _texts(path).isdisjoint(_OTHER) and path.rpartition(".")[0] not in vectors:
            holder = _type_at(definition, path.partition("[]")[0])
            length = holder.length if isinstance(holder, FixedArray) else None
            yield _Field(path, kind, length)


def _type_at(definition: Struct, path: str) -> FieldType | None:
    current: FieldType | None = definition
    for part in path.split("."):
        current = dict(current.fields).get(part) if isinstance(current, Struct) else None
    return current


def _names_of_fields(
    type_name: str, topics: Sequence[str], fields: Sequence[_Field]
) -> Iterator[tuple[dict[str, tuple[str, str]], bool]]:
    """Yield names that are compared, with their topics and fields, and whether all are contacts.

    They are those of the same field of several topics, ``/leg_1/contact:data`` ..., and of the
    fields of one message, ``stance_lf`` ...
    """
    single = [field for field in fields if "[]" not in field.path]
    for field in single:
        if field.fits(f"{' '.join(topics)} {type_name}"):
            yield {topic: (topic, field.path) for topic in topics}, field.is_flag
    for topic in topics:
        fitting = [field for field in single if field.fits(f"{topic} {type_name}")]
        for of_vectors in (False, True):
            yield (
                {
                    f"{topic}/{field.path.replace('.', '/')}": (topic, field.path)
                    for field in fitting
                    if is_vector(field.kind) == of_vectors
                },
                True,
            )


def _siblings(names: Collection[str], *, contacts_only: bool) -> Iterator[FootSet]:
    """Yield names of which each may be that of one foot: by their legs, else by any one word."""
    by_leg = name_feet(names, contacts_only=contacts_only)
    sets = [found for found in (by_leg.chosen, *by_leg.offered) if found and found.kind != "alone"]
    yield from sets
    groups: dict[tuple[str, ...], dict[str, str]] = {}
    for name in sorted(names)[:_MOST_NAMES]:
        words = [word.text for word in words_of(name)]
        for index, word in enumerate(words):
            key = (str(index), *words[:index], *words[index + 1 :])
            groups.setdefault(key, {})[word] = name
    for group in groups.values():
        known = any(found.topics >= set(group.values()) for found in sets)
        if _FEWEST_FEET < len(group) <= _MOST_FEET and not known:
            words = sorted(group, key=lambda word: (int(word) if word.isdigit() else 0, word))
            feet = tuple(
                NamedFoot(f"foot_{w}" if w.isdigit() else w, group[w], leg_position(w))
                for w in words
            )
            yield FootSet(feet, "words", Part.UNKNOWN, frozenset())


def _feet(found: FootSet, told: Iterable[tuple[str, str]]) -> tuple[Foot, ...]:
    """Return named feet with their topics and fields."""
    return tuple(
        Foot(foot.name, topic, leg_position=foot.position or leg_position(foot.name),
             field=FootField(path))
        for foot, (topic, path) in zip(found.feet, told, strict=True)
    )  # fmt: skip


def _named_elements(log: Log, topic: str, field: _Field) -> tuple[tuple[Foot, ...], FootSet] | None:
    """Return the elements of an array whose strings beside them name feet, among others.

    None where there are none, or all of the elements are feet: those are `_numbered_feet`.
    """
    if field.path.count("[]") != 1:
        return None
    labels = array_labels(log, topic, field.path.partition("[")[0])
    found = name_feet(labels, contacts_only=False)
    for one in (found.chosen, *found.offered):
        if one is None or one.kind == "alone" or one.part < Part.LEG:
            continue
        called = [foot.topic for foot in one.feet]
        if len(called) < len(labels) and _texts(" ".join(called)).isdisjoint(_JOINT):
            paths = (field.path.replace("[]", f"[{labels.index(label)}]") for label in called)
            return _feet(one, ((topic, path) for path in paths)), one
    return None


def _numbered_feet(topic: str, field: _Field) -> Iterator[tuple[Foot, ...]]:
    """Yield elements of an array, or bits of an integer; how many feet there are, messages tell."""
    if field.path.count("[]") == 1:
        most = _MOST_FEET + 1
        steps = _COMPONENTS if isinstance(field.kind, Primitive) and not field.is_flag else ()
        for step in (1, *steps):
            size = most * step if field.length is None else field.length
            if size % step == 0 and _FEWEST_FEET <= size // step <= most:
                first = 2 if step > 1 else 0
                paths = [field.path.replace("[]", f"[{n}]") for n in range(first, size, step)]
                yield _numbered(topic, paths)
    elif isinstance(field.kind, Primitive) and field.kind.dtype[0] in "iu" and not field.is_flag:
        said = _texts(f"{topic} {field.path}")
        if "[]" not in field.path and not said.isdisjoint(_CONTACT | _BITS):
            yield _numbered(topic, [f"{field.path}&{1 << bit}" for bit in range(_MOST_FEET)])


def _numbered(topic: str, paths: Sequence[str]) -> tuple[Foot, ...]:
    return tuple(
        Foot(f"foot_{number}", topic, field=FootField(path)) for number, path in enumerate(paths)
    )


def _scored(
    log: Log, type_name: str, feet: tuple[Foot, ...], found: FootSet | None = None
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
    rate = _rate_hz(log, {foot.topic for foot in feet})
    if rate is not None:
        points += 1 if rate >= _FAST_HZ else -2 if rate < _SLOW_HZ else 0
        reasons.append(f"{rate:.0f} messages a second")
    return FootCandidates(feet, type_name, points, tuple(reasons))


def _cost_of_parts(parts: Collection[Part | None]) -> int:
    """Return the points that names cost which speak of hands, wheels, tools ..."""
    if Part.NOT_A_FOOT not in parts:
        return 0
    return _OTHER_PART if {Part.FOOT, Part.LEG} & set(parts) else _NO_FOOT


def _rate_hz(log: Log, topics: Iterable[str]) -> float | None:
    """Return the messages a second of the slowest topic."""
    if log.start_time is None or log.end_time is None or log.end_time <= log.start_time:
        return None
    counts = [sum(log.counts.get(c.id, 0) for c in log.channels_by_topic[t]) for t in topics]
    return min(counts) / ((log.end_time - log.start_time) / 1e9)


def _read_fields(log: Log, sets: Sequence[FootCandidates]) -> Mapping[str, Samples]:
    """Read the fields of some sets as forces, by their names as ``--foot`` takes them."""
    fields = {word_of(foot): foot.field for one in sets for foot in one.feet if foot.field}
    topics = {word_of(foot): foot.topic for one in sets for foot in one.feet}
    feet = [
        Foot(word, topics[word], field=replace(each, kind="force")) for word, each in fields.items()
    ]
    of_channel: dict[int, tuple[int, ...]] = {}
    for channel in log.channels.values():
        told = [n for n, foot in enumerate(feet) if _has_force(channel, foot) is not None]
        if told:
            of_channel[channel.id] = tuple(told)
    channels = tuple(log.channels[number] for number in of_channel)
    chunks = (c for c in log.chunks if not (c.counts and of_channel.keys().isdisjoint(c.counts)))
    wanted = Wanted(channels, FootChannels(feet, of_channel))
    read = read_recording(log, wanted, 1, spans=log.grouped(chunks) if channels else ())
    return {foot.name: samples for foot, samples in zip(feet, read.recording.feet, strict=True)}


def _has_force(channel: Channel, foot: Foot) -> bool | None:
    """Tell whether a foot's field would be read as a force; None: the channel has no such field."""
    try:
        source = source_of(channel, [foot]) if channel.topic == foot.topic else None
    except DefinitionError:
        return None
    return source.has_force if source else None


def _judged(
    log: Log, named: FootCandidates, columns: Mapping[str, Samples]
) -> FootCandidates | None:
    """Add what the content says; None where it cannot be feet."""
    samples = [columns[word_of(foot)] for foot in named.feet]
    if named.is_numbered:
        count = _feet_there(named.feet, samples)
        if not count:
            return None
        named = _labelled(log, replace(named, feet=named.feet[:count]))
        samples = samples[:count]
    content = judge_content(samples)
    if content is None or content.points <= 0:
        return None
    limits = content.thresholds or (0.0,) * len(samples)
    return replace(
        named,
        feet=tuple(
            _with_kind(log, *each, content) for each in zip(named.feet, limits, strict=True)
        ),
        points=named.points + content.points + (1 if len(samples) in _USUAL_FEET else -1),
        reasons=(*named.reasons, *content.reasons),
        is_contact=content.is_contact or bool(content.thresholds),
    )


def _with_kind(log: Log, foot: Foot, threshold: float, content: Content) -> Foot:
    """Say whether a field is a force or a contact, where its type would say something else."""
    if foot.field is None:
        return foot
    if threshold:
        return replace(foot, field=replace(foot.field, kind="contact", threshold=threshold))
    channels = log.channels_by_topic[foot.topic]
    if any(_has_force(channel, foot) is (not content.is_contact) for channel in channels):
        return foot
    kind = "contact" if content.is_contact else "force"
    return replace(foot, field=replace(foot.field, kind=kind))


def _feet_there(feet: Sequence[Foot], samples: Sequence[Samples]) -> int:
    """Return how many feet all messages have, the first ones; 0: they are no feet of an array."""
    if feet[0].field is not None and "&" in feet[0].field.path:
        count = _bits_used(samples)
    else:
        told = [len(each.log_time) for each in samples]
        count = sum(number > 0 for number in told)
        if len(set(told[:count])) != 1:
            return 0
    return count if _FEWEST_FEET <= count <= _MOST_FEET else 0


def _bits_used(samples: Sequence[Samples]) -> int:
    """Return how many bits there are up to the last that changes; 0 where they are a number's."""
    count = 0
    for bit, each in enumerate(samples):
        changes = np.count_nonzero(np.diff(each.in_contact))
        if changes > _MOST_CHANGES * len(each.in_contact):
            return 0
        count = bit + 1 if changes else count
    return count


def _labelled(log: Log, named: FootCandidates) -> FootCandidates:
    """Name the elements of an array by the strings beside them, and score these."""
    feet, field = named.feet, named.feet[0].field
    array = field.path.partition("[")[0] if field and "[" in field.path else ""
    labels = array_labels(log, feet[0].topic, array) if array else ()
    if len(labels) != len(feet):
        return named
    called = label_names(labels)
    if len({each.name for each in called}) == len(called):
        feet = tuple(
            replace(foot, name=each.name, leg_position=each.position)
            for foot, each in zip(feet, called, strict=True)
        )
    parts = {word.part for label in labels for word in words_of(label)}
    if cost := _cost_of_parts(parts):
        return replace(named, feet=feet, points=named.points - cost)
    reasons = (*named.reasons, f"they are called {', '.join(labels)}")
    points = named.points + (1 if parts.isdisjoint({Part.FOOT, Part.LEG}) else 2)
    return replace(named, feet=feet, points=points, reasons=reasons)


def split_cells(found: Sequence[FootCandidates]) -> tuple[list[FootCandidates], list[Finding]]:
    """Leave out fields of which each foot has several, alike but for their place in it.

    Returns:
        the other fields, and a finding for each group that was left out: no single sensor in a
        sole tells the foot's load.
    """
    groups: dict[object, list[FootCandidates]] = {}
    for one in found:
        feet = tuple((foot.name, foot.topic, _without_place(foot)) for foot in one.feet)
        groups.setdefault((one.type_name, feet), []).append(one)
    others = [group[0] for group in groups.values() if len(group) == 1]
    return others, [_cells_finding(group) for group in groups.values() if len(group) > 1]


def _without_place(foot: Foot) -> tuple[str, ...]:
    """Return the words of a foot's field that do not tell where in the foot it is."""
    words = [word.text for word in words_of(foot.field.path if foot.field else "")]
    return tuple(word for word in words if word not in _IN_A_SOLE and not word.isdigit())


def _cells_finding(group: Sequence[FootCandidates]) -> Finding:
    feet = []
    for number, foot in enumerate(group[0].feet):
        fields = dict.fromkeys(word_of(each.feet[number]) for each in group)
        feet.append(f"{foot.name} = {' + '.join(fields)}")
    text = (
        f"fields of {group[0].type_name} look like several sensors in each foot: {listed(feet)}; a "
        "single one tells neither the load nor the contact of its foot, and fields cannot be added "
        "up here: record the sum of each foot's sensors on a topic of its own, such as "
        "/foot/left of geometry_msgs/WrenchStamped"
    )
    return Finding("FEET_UNSURE", text, cases=("possible",))


def candidates_finding(log: Log, found: Sequence[FootCandidates], call: str, base: str) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        found: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    first, *others = found
    text = f"fields of {first.type_name} look like feet: {first.text}"
    for other in others[:_ALTERNATIVES]:
        text += f"; or {other.text}"
    if any(foot.leg_position is None for foot in first.feet):
        text += (
            "; which leg each is, they do not say: put front_left, back_right ... for "
            f"{first.feet[0].name} and the others, and gaits have names"
        )
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    if any(foot.field and foot.field.kind for foot in first.feet):
        # What the fields are can only be said in a robot's file.
        text += f"; they are not used unasked. This writes a robot's file with them: {draft}"
        return Finding("FEET_UNSURE", text, command=draft, cases=("possible",))
    words = " ".join(f"--foot {foot.name}={shell_quoted(word_of(foot))}" for foot in first.feet)
    command = f"{call} {words}"
    text += (
        f"; they are not used unasked. `{draft}` writes a robot's file with them; this measures "
        f"with them: {command}"
    )
    return Finding("FEET_UNSURE", text, command=command, cases=("possible",))
