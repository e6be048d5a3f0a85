"""Feet in messages of any type: one field of the message is a foot's force or contact."""

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.field_path import FieldPath, has_header, parse_field_path
from dogbot_logtool.reader.decode.fields import HEADER, Fields
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    foot_samples,
    of_all_feet,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, definition_of
from dogbot_logtool.robot import Foot, FootField

_COMPONENT: Final = {"x": 0, "y": 1, "z": 2}


def field_source(channel: Channel, fields: tuple[FootField, ...]) -> ContactSource:
    """Return what reads some fields of a channel's messages as feet.

    Raises:
        DefinitionError: a field does not exist, or some are forces and others contacts.
    """
    source = _field_source(definition_of(channel), channel.type_name, fields)
    check_channel(channel, source.fields)
    return source


@lru_cache(maxsize=256)
def _field_source(
    definition: Struct, type_name: str, fields: tuple[FootField, ...]
) -> ContactSource:
    paths = {field: parse_field_path(definition, field.path) for field in fields}
    kinds = {_kind(field, path) for field, path in paths.items()}
    if len(kinds) > 1:
        raise DefinitionError("some of its feet are forces and others contacts; `kind` says which")
    is_stamped = has_header(definition)
    read: Fields = HEADER if is_stamped else ()
    read = (*read, *(each for path in paths.values() for each in path.fields))
    return ContactSource(
        type_name=type_name,
        fields=tuple(dict.fromkeys(read)),
        read=partial(_to_contact_samples, paths=paths, is_stamped=is_stamped),
        frame=WrenchFrame.UNKNOWN,
        has_header=is_stamped,
        has_force=kinds == {"force"},
        has_points=False,
        one_axis=all(path.width == 1 or field.axis for field, path in paths.items()),
    )


def _kind(field: FootField, path: FieldPath) -> str:
    """Return ``force`` or ``contact``; a fitting one where the user did not say."""
    if path.width == 1:
        if field.axis:
            raise DefinitionError(f"{field.path} is a number and has no axis {field.axis!r}")
        return field.kind or ("contact" if path.is_integer else "force")
    if field.kind == "contact":
        raise DefinitionError(f"{field.path} is a vector: a force, not a contact")
    return "force"


def _to_contact_samples(
    messages: DecodedMessages,
    feet: FootChannels,
    *,
    paths: Mapping[FootField, FieldPath],
    is_stamped: bool,
) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    stamp = np.zeros(len(messages.channel), np.int64)
    if is_stamped:
        stamp = messages.table.nanoseconds("header.stamp")
    parts = []
    for index, foot in enumerate(feet.feet):
        if foot.field is None or foot.field not in paths:
            continue
        path = paths[foot.field]
        values = path.values(messages.table)
        rows = feet.sent(index, messages.channel, ~np.asarray(np.isnan(values).any(axis=1)))
        is_contact = _kind(foot.field, path) == "contact"
        force = (_contact if is_contact else _newtons)(foot, foot.field, values[rows])
        parts.append(foot_samples(messages, rows, index, stamp, force))
    return of_all_feet(parts)


def _newtons(foot: Foot, field: FootField, values: Floats) -> Floats:
    """Return (n, 3) N; a single number is a force along z."""
    factor = field.sign * field.scale * field.newtons_per_unit
    if values.shape[1] > 1 and not field.axis:
        return factor * values
    column = values[:, _COMPONENT[field.axis[-1]] if field.axis else 0]
    if field.axis.startswith("-"):
        column = -column
    force = np.zeros((len(column), 3))
    force[:, 2] = factor * (column - foot.offset)
    return force


def _contact(foot: Foot, field: FootField, values: Floats) -> Floats:
    """Return (n, 3): NaN, an unknown force, where a number is above the threshold, else 0."""
    del foot
    touches = values[:, 0] > field.threshold
    if field.sign < 0:
        touches = ~touches
    force = np.zeros((len(touches), 3))
    force[touches, 2] = np.nan
    return force
