"""The columns of each foot, read of messages by any row of the table."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, concatenated, median_of
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.rotations import conjugate, normalised, rotate
from dogbot_logtool.core.settings import leg_names
from dogbot_logtool.reader.containers.log import Channel
from dogbot_logtool.reader.decode.paths import MOST_ELEMENTS
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.reader.messages.source import Source

_READ: Final = ("flag", "force", "point", "normal")
Values = Mapping[str, Floats]
"""(n, w) numbers of one foot, by the row's field; NaN where a message lacks it."""


class FootChannels(NamedTuple):
    """Which feet speak on which channels."""

    feet: Sequence[Foot]
    """The robot's feet."""
    of_channel: Mapping[Channel, tuple[int, ...]]
    """Indices in `feet`; several where one message tells of several feet."""

    def of(self, channel: Channel) -> tuple[Foot, ...]:
        """Return the feet of a channel."""
        return tuple(self.feet[index] for index in self.of_channel[channel])

    def single(self, channel: Ints) -> Ints:
        """(n,) foot index of messages that tell of one foot each."""
        foot_of = {each.id: feet[0] for each, feet in self.of_channel.items()}
        ids = np.array(sorted(foot_of), np.int64)
        feet = np.array([foot_of[number] for number in ids.tolist()], np.int64)
        return feet[np.searchsorted(ids, channel)]


def read_feet(source: Source, messages: DecodedMessages, feet: FootChannels) -> Samples:
    """Return the samples of all feet, foot by foot."""
    stamp, parts = source.stamps(messages), [no_samples()]
    values_of = _values_by_label if source.row.label else _values_by_element
    for index, values in enumerate(values_of(source, messages, feet.feet)):
        channels = [each.id for each, told in feet.of_channel.items() if index in told]
        rows = np.flatnonzero(np.isin(messages.channel, channels))
        if not len(rows):
            continue
        own = values if len(rows) == len(stamp) else {name: v[rows] for name, v in values.items()}
        force = _force(source.row, feet.feet[index], own)
        told = _contact(source.row, feet.feet[index], own, force)
        if told is None:
            continue
        known, touches = told
        if force is None:
            force = np.where(touches[:, None], np.nan, np.zeros(3))
        # Whether flags or the forces beside them decide contact is not known yet.
        placed = touches if not (source.has_flags and source.has_force) else known
        samples = Samples(
            np.full(len(rows), index),
            messages.log_time[rows],
            stamp[rows],
            touches,
            force,
            np.full(len(rows), source.row.axes is WrenchFrame.WORLD),
            *_points(source, own, placed),
        )
        parts.append(samples if known.all() else samples.pick(known))
    return concatenated(parts)


def _values_by_element(
    source: Source, messages: DecodedMessages, feet: Sequence[Foot]
) -> Iterator[Values]:
    """Yield what n messages tell of each foot, by its element in them."""
    columns = {name: _elements(source, messages, name) for name in _READ if name in source.paths}
    for foot in feet:
        at = _element(source, foot)
        yield {name: each[at] for name, each in columns.items() if 0 <= at < len(each)}


def _element(source: Source, foot: Foot) -> int:
    """Return which of the elements is a foot's; -1: messages do not tell of it."""
    if words := source.row.words:
        return words.index(foot.field.path) if foot.field and foot.field.path in words else -1
    element = foot.element if source.tells_all_feet else 0
    return -1 if element is None else element


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


def _values_by_label(
    source: Source, messages: DecodedMessages, feet: Sequence[Foot]
) -> Iterator[Values]:
    """Yield what n messages tell of each foot, by its label beside the values."""
    label, table = source.paths["label"][0], messages.table
    message, texts = label.texts(table)
    code, names = texts.encode()
    told = {name: source.paths[name][0].beside(table, label) for name in _READ
            if name in source.paths}  # fmt: skip
    for foot in feet:
        values = {}
        rows = np.flatnonzero(code == names.index(foot.label)) if foot.label in names else None
        for name, column in told.items() if rows is not None else ():
            values[name] = np.full((table.rows, column.shape[1]), np.nan)
            values[name][message[rows]] = column[rows]
        yield values


def _contact(
    row: MessageType, foot: Foot, values: Values, force: Floats | None
) -> tuple[Flags, Flags] | None:
    """Return whether a foot's contact is known, and whether it touches, (n,); None: never known."""
    flag = values.get("flag")
    if row.flag:
        return None if flag is None else flagged(row, foot, flag[:, 0])
    if force is None:
        return None
    # What tells of one foot and nothing else tells of it in each message.
    known = ~np.asarray(np.isnan(values["force"]).all(axis=1))
    return known, np.asarray((force != 0.0).any(axis=1))


def flagged(row: MessageType, foot: Foot, flag: Floats) -> tuple[Flags, Flags]:
    """Return whether contact is known, (n,), and whether the foot touches, (n,)."""
    if row.closed:
        touches = np.isin(flag, row.closed)
        return touches | np.isin(flag, row.open), touches
    known = ~np.isnan(flag)
    if foot.field is None or not row.words:
        return known, np.abs(flag) > row.above
    return known, (flag > foot.field.threshold) != (foot.field.sign == "-")


def _force(row: MessageType, foot: Foot, values: Values) -> Floats | None:
    """(n, 3) N, or counts without a scale; a single number is along z; None: there is none."""
    recorded, field = values.get("force"), foot.field
    if recorded is None or (field is None and row.unit == "N"):
        return recorded
    scale = field.newtons if field is not None else foot.newtons_per_count or 1.0
    axis = field.axis if field is not None else ""
    if field is not None and recorded.shape[1] > 1 and not axis:
        return scale * recorded
    load = recorded[:, "xyz".index(axis[-1]) if axis else 0]
    load = scale * ((-load if axis.startswith("-") else load) - foot.offset)
    return np.pad(load[:, None], ((0, 0), (2, 0)))


def _points(source: Source, values: Values, touches: Flags) -> tuple[Ints, Floats, Floats]:
    """Return the number of points, (n,), their position and the normal, (n, 3)."""
    nothing = np.full((len(touches), 3), np.nan)
    point, normal = values.get("point", nothing), values.get("normal", nothing)
    normal = np.where(touches[:, None], normal, np.nan)
    if source.row.point_in_swing:
        return np.zeros(len(touches), np.int64), point, normal
    placed = touches & all_finite(point)
    # A position in the base's frame is no contact point in the world yet.
    points = (placed & (not source.in_base)).astype(np.int64)
    return points, np.where(placed[:, None], point, np.nan), normal


def feet_in(source: Source, messages: DecodedMessages) -> Sequence[str]:
    """Return the labels of the feet that messages tell of, or else names in the messages' order.

    None where they are not about feet.
    """
    row, table = source.row, messages.table
    if row.by_place:
        return _legs_by_place(source, messages)
    if not row.label:
        forces = [path.values(table) for path in source.paths.get("force", ())]
        told = all(np.isfinite(each).all(axis=(1, 2)).any() for each in forces)
        return row.legs if told or not row.maybe_without_legs else ()
    _, texts = source.paths["label"][0].texts(table)
    if row.only:
        kind = source.paths["only"][0].all_values(table)[:, 0]
        texts = texts.pick(np.flatnonzero(kind == 0))
    return [label for label in sorted(texts.encode()[1])[:MOST_ELEMENTS] if label]


def _legs_by_place(source: Source, messages: DecodedMessages) -> Sequence[str]:
    """Name the feet by where they are, seen from the base."""
    at, turned = (
        source.paths[name][0].first_values(messages.table) for name in ("position", "orientation")
    )
    points = source.paths["point"][0].values(messages.table)
    usable = np.isfinite(points).all(axis=(1, 2)) & all_finite(at) & all_finite(turned)
    usable &= (turned != 0.0).any(axis=1)
    if not usable.any() or not points.shape[1]:
        return ()
    back = conjugate(normalised(turned[usable]))
    seen = [rotate(back, points[usable, foot] - at[usable]) for foot in range(points.shape[1])]
    return leg_names(median_of(np.stack(seen, 1), axis=0))
