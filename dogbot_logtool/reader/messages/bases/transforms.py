"""The base from the log's own transforms: a pair of frames, such as ``odom/base_link``."""

from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.reader.messages.transforms import FIELDS, transform_columns


def pair_name(parent: str, child: str) -> str:
    """Return the name of a pair of frames, without leading slashes."""
    return f"{parent.lstrip('/')}/{child.lstrip('/')}"


def _elements(messages: DecodedMessages) -> frozenset[str]:
    """Return the names of the pairs of frames that messages hold."""
    recorded = transform_columns(messages)
    return frozenset(
        pair_name(recorded.parents[parent], recorded.children[child])
        for parent, child in _pairs(recorded)
    )


def _read(messages: DecodedMessages, element: str) -> BasePoses:
    """Read the transforms of one pair of frames."""
    recorded = transform_columns(messages)
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


def _pairs(recorded: RecordedTransforms) -> list[tuple[int, int]]:
    """Return the different pairs of codes of parents and children."""
    width = max(len(recorded.children), 1)
    pairs = distinct(recorded.parent * width + recorded.child).tolist()
    return [divmod(pair, width) for pair in pairs]


SOURCES: Final = tuple(
    BaseSource(type_name, fields, _read, _elements, has_one_pose=False, is_transform=True)
    for type_name, fields in FIELDS.items()
)
