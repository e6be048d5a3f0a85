"""States of Unitree's robots: raw counts of the pressure sensors in all feet, and no header.

Offset and scale of the counts differ from foot to foot and are nowhere documented, so both stand
in the robot's file: newtons = newtons_per_count x (counts - offset). Without a scale the counts
only tell whether a foot touches, and only if the file says from how many counts on.

Drivers differ in the package and in the spelling of the fields, so messages are known by their name
and by the fields that they have. High-level states also have the positions of the feet, in the
base's frame.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.fields import Field, fixed_numbers, table, vector
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    foot_samples,
    of_all_feet,
)
from dogbot_logtool.reader.messages.contacts.whole_robot import matrix
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LEGS: Final = ("front_right", "front_left", "back_right", "back_left")
"""The order of every array in Unitree's messages: FR, FL, RR, RL."""
_FORCES: Final = ("foot_force", "footForce", "footforce")
_POINT_ARRAYS: Final = ("footPosition2Body", "footposition2body", "foot_position2body")
_POINT_NUMBERS: Final = "foot_position_body"


def _to_contact_samples(
    messages: DecodedMessages, feet: FootChannels, *, force: str, position: str
) -> ContactSamples:
    """Reduce messages to samples; see `ContactSource.read`."""
    rows = len(messages.channel)
    return raw_samples(
        messages,
        feet,
        messages.table.numbers(force).astype(np.float64),
        stamp=np.zeros(rows, np.int64),
        points=_positions(messages.table, position, rows),
    )


def raw_samples(
    messages: DecodedMessages,
    feet: FootChannels,
    counts: Floats,
    *,
    stamp: Ints,
    points: Floats | None = None,
) -> ContactSamples:
    """Return samples of raw counts, as far as the robot's file tells what they mean.

    Args:
        messages: n messages.
        feet: which of their elements is which foot's.
        counts: (n, k); NaN in messages that have none.
        stamp: (n,) ns; 0: none.
        points: (n, k, 3) m, positions of the feet in the base's frame.
    """
    parts = []
    for index, foot in enumerate(feet.feet):
        if foot.element is None or foot.element >= counts.shape[1]:
            continue
        if foot.newtons_per_count is None and feet.contact_on_counts is None:
            # Neither force nor contact can be known of it.
            continue
        rows = feet.sent(index, messages.channel, ~np.isnan(counts[:, foot.element]))
        loads = np.zeros((len(rows), 3))
        loads[:, 2] = _newtons(foot, counts[rows, foot.element], feet.contact_on_counts)
        samples = foot_samples(messages, rows, index, stamp, loads)
        if points is not None and foot.element < points.shape[1]:
            samples = replace(samples, position=points[rows, foot.element])
        parts.append(samples)
    return of_all_feet(parts)


def _newtons(foot: Foot, counts: Floats, on_counts: float | None) -> Floats:
    """(n,) N; NaN for a contact whose force is not known."""
    loaded = counts - foot.offset
    if foot.newtons_per_count is not None:
        force: Floats = foot.newtons_per_count * loaded
        return force
    return np.where(loaded >= (on_counts or 0.0), np.nan, 0.0)


def _positions(columns: Table, path: str, rows: int) -> Floats | None:
    """(n, 4, 3) m in the base's frame, NaN where a robot does not fill them in."""
    if not path:
        return None
    if path == _POINT_NUMBERS:
        points = columns.numbers(path).astype(np.float64)[:, : 3 * len(_LEGS)]
        points = points.reshape(rows, len(_LEGS), 3)
    else:
        nested = columns.nested(path)
        points = matrix(nested, nested.table.vectors("", "xyz"), rows)
    filled = (points != 0.0).any(axis=2, keepdims=True)
    return np.where(filled, points, np.nan)


def _position_field(path: str) -> tuple[Field, ...]:
    if not path:
        return ()
    if path == _POINT_NUMBERS:
        return (fixed_numbers(path, at_least=3 * len(_LEGS)),)
    return (table(path, *vector("")),)


def _sources(type_name: str) -> Iterator[ContactSource]:
    """Yield the ways to read a type, those with the most fields first."""
    high_level = not type_name.endswith("/LowState")
    for position in (_POINT_NUMBERS, *_POINT_ARRAYS, "") if high_level else ("",):
        for force in _FORCES:
            yield ContactSource(
                type_name=type_name,
                fields=(
                    fixed_numbers(force, at_least=len(_LEGS)),
                    *_position_field(position),
                ),
                read=partial(_to_contact_samples, force=force, position=position),
                elements=_LEGS,
                any_package=True,
                frame=WrenchFrame.UNKNOWN,
                has_header=False,
                has_points=bool(position),
                in_base=bool(position),
                is_raw=True,
            )


_TYPES: Final = (
    "unitree_go/SportModeState",
    "go2_interfaces/Go2State",
    "unitree_legged_msgs/HighState",
    "ros2_unitree_legged_msgs/HighState",
    "unitree_legged_msgs/LowState",
    "unitree_go/LowState",
    "go2_interfaces/LowState",
    "ros2_unitree_legged_msgs/LowState",
)
SOURCES: Final = tuple(source for name in _TYPES for source in _sources(name))
"""A1 and Go1 use `unitree_legged_msgs`, Go2 `unitree_go`; the others are well-known drivers'.
States with positions come first; where they come much less often than low-level ones, those are
taken."""
