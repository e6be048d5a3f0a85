"""The base from the log's own transforms: a pair of frames, such as ``odom/base_link``."""

from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.reader.decode.fields import Fields
from dogbot_logtool.reader.messages import foxglove_transforms, transforms
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages

ToTransforms = Callable[[DecodedMessages], RecordedTransforms]


def pair_name(parent: str, child: str) -> str:
    """Return the name of a pair of frames, without leading slashes."""
    return f"{parent.lstrip('/')}/{child.lstrip('/')}"


def _elements(messages: DecodedMessages, *, columns: ToTransforms) -> frozenset[str]:
    """Return the names of the pairs of frames that messages hold."""
    recorded = columns(messages)
    return frozenset(
        pair_name(recorded.parents[parent], recorded.children[child])
        for parent, child in _pairs(recorded)
    )


def _read(messages: DecodedMessages, element: str, *, columns: ToTransforms) -> BasePoses:
    """Read the transforms of one pair of frames."""
    recorded = columns(messages)
    found = [
        (parent, child)
        for parent, child in _pairs(recorded)
        if pair_name(recorded.parents[parent], recorded.children[child]) == element
    ]
    rows = np.zeros(len(recorded.log_time), np.bool_)
    for parent, child in found:
        rows |= (recorded.parent == parent) & (recorded.child == child)
    return BasePoses(
        poses=poses_of(
            recorded.log_time[rows],
            recorded.stamp[rows],
            recorded.translation[rows],
            recorded.rotation[rows],
        ),
        channel=recorded.channel[rows],
        worlds=tuple(sorted({recorded.parents[parent] for parent, _ in found})),
        bases=tuple(sorted({recorded.children[child] for _, child in found})),
        malformed=messages.malformed,
    )


def _source(type_name: str, fields: Fields, columns: ToTransforms) -> BaseSource:
    return BaseSource(
        type_name,
        fields,
        partial(_read, columns=columns),
        partial(_elements, columns=columns),
        has_one_pose=False,
        is_transform=True,
    )


def _pairs(recorded: RecordedTransforms) -> list[tuple[int, int]]:
    """Return the different pairs of codes of parents and children."""
    width = max(len(recorded.children), 1)
    pairs = distinct(recorded.parent * width + recorded.child).tolist()
    return [divmod(pair, width) for pair in pairs]


SOURCES: Final = (
    *(
        _source(type_name, transforms.FIELDS, transforms.transform_columns)
        for type_name in sorted(transforms.TRANSFORM_TYPES)
    ),
    *(
        _source(type_name, fields, foxglove_transforms.foxglove_columns)
        for type_name, fields in foxglove_transforms.FIELDS.items()
    ),
)
