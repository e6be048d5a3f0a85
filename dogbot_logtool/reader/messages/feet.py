"""The columns of each foot, read of messages by any row of the table."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, concatenated, median_of
from dogbot_logtool.core.contact.contacts import Contacts, Samples, no_samples
from dogbot_logtool.core.leg_position import leg_names
from dogbot_logtool.core.rotations import conjugate, normalised, rotate
from dogbot_logtool.reader.decode.paths import MOST_ELEMENTS
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.reader.messages.source import Source

_HANDS: Final = ("lhsensor", "rhsensor", "hand", "arm", "wrist")
"""Words in names of sensors that are no feet, beside sensors that are called by their legs."""
_COMPONENT: Final = {"x": 0, "y": 1, "z": 2}
_READ: Final = ("flag", "force", "point", "normal")
Values = Mapping[str, Floats]
"""(n, w) numbers of one foot, by the row's field; NaN where a message lacks it."""


@dataclass(frozen=True, slots=True)
class FootChannels:
    """Which feet speak on which channels."""

    feet: Sequence[Foot]
    """The robot's feet."""
    of_channel: Mapping[int, tuple[int, ...]]
    """Indices in `feet` by channel id; several where one message tells of several feet."""
    contact_on_counts: float | None = None
    """Counts from which a raw sensor without a scale touches; None: it cannot be told."""
    ignores_flags: bool = False
    """Whether forces decide contact although messages have flags, which forces contradict."""

    def of(self, channel: int) -> tuple[Foot, ...]:
        """Return the feet of a channel, by its id."""
        return tuple(self.feet[index] for index in self.of_channel.get(channel, ()))

    def single(self, channel: Ints) -> Ints:
        """(n,) foot index of messages that tell of one foot each."""
        ids = np.array(sorted(self.of_channel), np.int64)
        feet = np.array([self.of_channel[number][0] for number in ids.tolist()], np.int64)
        return feet[np.searchsorted(ids, channel)]

    def rows(self, foot: int, channel: Ints) -> Ints:
        """Return the rows of messages that tell of a foot, (m,)."""
        channels = [number for number, told in self.of_channel.items() if foot in told]
        return np.flatnonzero(np.isin(channel, channels))


@dataclass(frozen=True, slots=True)
class ContactSamples:
    """Contact samples of messages."""

    samples: Samples
    contacts: Contacts | None = None
    """The states that the samples were made of; None: messages have none."""
    untimed_messages: int = 0
    """Messages of several states whose `info` tells no time: read as one physics step."""
    foreign_states: int = 0
    """States of pairs in which not exactly one body is the foot, or both are of one robot."""
    links: Mapping[int, set[str]] = field(default_factory=dict)
    """Links of the feet's own collisions, by foot."""
    implausible: int = 0
    """Samples with numbers that no robot reaches; those are NaN."""


@dataclass(frozen=True, slots=True)
class MessageFoot:
    """A foot that messages tell of."""

    label: str = ""
    """Its name in the messages; empty: its index in their arrays tells."""
    name: str = ""
    """Name of the leg, such as ``front_left``; empty: the label tells it."""


def read_feet(source: Source, messages: DecodedMessages, feet: FootChannels) -> Samples:
    """Return the samples of all feet, foot by foot."""
    stamp = source.stamps(messages)
    parts = [no_samples()]
    for index, values in enumerate(foot_values(source, messages, feet.feet)):
        rows = feet.rows(index, messages.channel)
        if values is None or not len(rows):
            continue
        own = values if len(rows) == len(stamp) else {name: v[rows] for name, v in values.items()}
        touching = _touching(source.row, feet, index, own)
        if touching is None:
            continue
        known, touches, force = touching
        samples = Samples(
            np.full(len(rows), index),
            messages.log_time[rows],
            stamp[rows],
            touches,
            force,
            *_where(source, own, touches),
        )
        parts.append(samples if known.all() else samples.pick(known))
    return concatenated(parts)


def foot_values(
    source: Source, messages: DecodedMessages, feet: Sequence[Foot]
) -> Iterator[Values | None]:
    """Yield what n messages tell of each foot; None: they do not tell of it."""
    told = [field for field in _READ if field in source.paths]
    if source.row.label:
        return _by_label(source, messages, feet, told)
    return _by_element(source, messages, feet, told)


def _by_element(
    source: Source, messages: DecodedMessages, feet: Sequence[Foot], told: Sequence[str]
) -> Iterator[Values | None]:
    columns = {field: _elements(source, messages, field) for field in told}
    for foot in feet:
        element = _element(source, foot)
        if element is None or element < 0:
            yield None
            continue
        yield {name: each[element] for name, each in columns.items() if element < len(each)}


def _elements(source: Source, messages: DecodedMessages, field: str) -> list[Floats]:
    """Return a field of n messages, (n, w) an element."""
    found: list[Floats] = []
    for path in source.paths[field]:
        values = path.values(messages.table)
        if field == "point" and source.in_base:
            # No foot is in the middle of the body: some drivers do not fill it in.
            values = np.where((values != 0.0).any(axis=2, keepdims=True), values, np.nan)
        found += [values[:, element] for element in range(values.shape[1])]
    return found


def _element(source: Source, foot: Foot) -> int | None:
    """Return which of the elements is a foot's."""
    if source.row.words:
        named = foot.field is not None and foot.field.path in source.row.words
        return source.row.words.index(foot.field.path) if named and foot.field else None
    return foot.element if source.tells_all_feet else 0


def _by_label(
    source: Source, messages: DecodedMessages, feet: Sequence[Foot], told: Sequence[str]
) -> Iterator[Values | None]:
    label, table = source.paths["label"][0], messages.table
    message, texts = label.texts(table)
    code, names = texts.encode()
    columns = {field: source.paths[field][0].beside(table, label) for field in told}
    for foot in feet:
        if foot.label not in names:
            yield None
            continue
        rows = np.flatnonzero(code == names.index(foot.label))
        values = {
            name: np.full((table.rows, column.shape[1]), np.nan) for name, column in columns.items()
        }
        for name, column in columns.items():
            values[name][message[rows]] = column[rows]
        yield values


def _touching(
    row: MessageType, feet: FootChannels, index: int, values: Values
) -> tuple[Flags, Flags, Floats] | None:
    """Return whether a foot's contact is known, and whether it touches, (n,), and (n, 3) N.

    None: messages do not tell.
    """
    foot = feet.feet[index]
    flag, recorded = values.get("flag"), values.get("force")
    if recorded is not None and row.unit == "counts":
        force = _of_counts(foot, recorded, feet.contact_on_counts)
    elif recorded is not None:
        force = _newtons(foot, recorded)
    elif flag is not None:
        force = np.full((len(flag), 3), np.nan)
    else:
        return None
    by_flag = bool(row.flag) and not (feet.ignores_flags and row.force)
    if force is None or (by_flag and flag is None):
        return None
    if by_flag and flag is not None:
        known, touches = flagged(row, foot, flag[:, 0])
    else:
        # What tells of one foot and nothing else tells of it in each message.
        known = ~np.asarray(np.isnan(values["force"]).all(axis=1))
        touches = np.asarray((force != 0.0).any(axis=1))
    return known, touches, np.where(touches[:, None], force, 0.0)


def flagged(row: MessageType, foot: Foot, flag: Floats) -> tuple[Flags, Flags]:
    """Return whether contact is known, (n,), and whether the foot touches, (n,)."""
    if row.closed:
        touches = np.isin(flag, row.closed)
        return touches | np.isin(flag, row.open), touches
    known = ~np.isnan(flag)
    if foot.field is None or not row.words:
        return known, np.abs(flag) > row.above
    return known, (flag > foot.field.threshold) != (foot.field.sign == "-")


def _of_counts(foot: Foot, counts: Floats, on_counts: float | None) -> Floats | None:
    """(n, 3) N, NaN for a contact whose force is not known; None: nothing is known."""
    load = counts[:, 0] - foot.offset
    if foot.newtons_per_count is not None:
        load = foot.newtons_per_count * load
    elif on_counts is not None:
        load = np.where(load >= on_counts, np.nan, 0.0)
    else:
        return None
    return _upwards(load)


def _newtons(foot: Foot, values: Floats) -> Floats:
    """(n, 3) N; a single number is a force along z."""
    field = foot.field
    if field is None:
        return values
    if values.shape[1] > 1 and not field.axis:
        return field.newtons * values
    load = values[:, _COMPONENT[field.axis[-1]] if field.axis else 0]
    return _upwards(field.newtons * ((-load if field.axis.startswith("-") else load) - foot.offset))


def _upwards(load: Floats) -> Floats:
    force = np.zeros((len(load), 3))
    force[:, 2] = load
    return force


def _where(source: Source, values: Values, touches: Flags) -> tuple[Flags, Ints, Floats, Floats]:
    """Return whether forces are along the world's axes, points, positions and normals."""
    count = len(touches)
    in_world = np.full(count, source.row.axes == "world")
    nothing = np.full((count, 3), np.nan)
    point, normal = values.get("point", nothing), values.get("normal", nothing)
    normal = np.where(touches[:, None], normal, np.nan)
    if source.row.point_in_swing:
        return in_world, np.zeros(count, np.int64), point, normal
    placed = touches & all_finite(point)
    # A position in the base's frame is no contact point in the world yet.
    points = (placed & (not source.in_base)).astype(np.int64)
    return in_world, points, np.where(placed[:, None], point, np.nan), normal


def feet_in(source: Source, messages: DecodedMessages) -> Sequence[MessageFoot]:
    """Find the feet that messages tell of; none where they are not about feet."""
    row = source.row
    if row.by_place:
        return [MessageFoot(name=name) for name in _legs_by_place(source, messages)]
    if row.label:
        return _labelled_feet(source, messages)
    forces = [path.values(messages.table) for path in source.paths.get("force", ())]
    if row.maybe_without_legs and not all(
        np.isfinite(each).all(axis=(1, 2)).any() for each in forces
    ):
        return ()
    return [MessageFoot(name=name) for name in row.legs]


def _labelled_feet(source: Source, messages: DecodedMessages) -> Sequence[MessageFoot]:
    row, table = source.row, messages.table
    _, texts = source.paths["label"][0].texts(table)
    if row.only is not None:
        kind = source.paths["only"][0].all_values(table)[:, 0]
        texts = texts.pick(np.flatnonzero(kind == row.only[1]))
    labels = [name for name in sorted(texts.encode()[1])[:MOST_ELEMENTS] if name]
    if row.label_names is None:
        return [MessageFoot(label=label) for label in labels]
    return [
        MessageFoot(label, row.label_names.get(label.lower(), ""))
        for label in labels
        if not any(hand in label.lower() for hand in _HANDS)
    ]


def _legs_by_place(source: Source, messages: DecodedMessages) -> Sequence[str]:
    """Name the feet by where they are, seen from the base."""
    at, turned = (
        source.paths[name][0].first_values(messages.table) for name in ("position", "orientation")
    )
    points = source.paths["point"][0].values(messages.table)
    usable = np.isfinite(points).all(axis=(1, 2)) & all_finite(at) & all_finite(turned)
    usable &= (turned != 0.0).any(axis=1)
    if not usable.any():
        return ()
    back = conjugate(normalised(turned[usable]))
    seen = [rotate(back, points[usable, foot] - at[usable]) for foot in range(points.shape[1])]
    return leg_names(median_of(np.stack(seen, 1), axis=0))
