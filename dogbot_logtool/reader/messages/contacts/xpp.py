"""xpp_msgs/RobotStateCartesian: the base, positions, forces and contacts of all feet, planned.

Planners (towr, xpp, ocs2) write it. Everything is along the world's axes. There is no header, and
the order of the feet differs from version to version, so where the feet are tells which is which.
"""

from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.order_statistics import median_of
from dogbot_logtool.core.geometry.rotations import conjugate, normalised, rotate
from dogbot_logtool.core.leg_position import leg_names
from dogbot_logtool.reader.decode.fields import numbers, table, vector
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues, MessageFoot
from dogbot_logtool.reader.messages.contacts.whole_robot import MOST_FEET, matrix
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot


def _values(
    messages: DecodedMessages, feet: Sequence[Foot], *, motion: str, contact: str
) -> FootValues:
    del feet
    table, rows = messages.table, len(messages.channel)
    flags = table.nested(contact)
    forces = table.nested("ee_forces")
    return FootValues(
        stamp=np.zeros(rows, np.int64),
        contact=matrix(flags, flags.table.numbers(ELEMENT).astype(np.float64), rows),
        force=matrix(forces, forces.table.vectors("", "xyz"), rows),
        position=_positions(messages, motion),
    )


def _positions(messages: DecodedMessages, motion: str) -> Floats:
    points = messages.table.nested(motion)
    return matrix(points, points.table.vectors("pos", "xyz"), len(messages.channel))


def _feet_in(messages: DecodedMessages, *, motion: str, base: str) -> tuple[MessageFoot, ...]:
    """Name the feet by where they are, seen from the base."""
    table = messages.table
    positions, turned = (
        table.vectors(f"{base}.position", "xyz"),
        table.vectors(f"{base}.orientation", "xyzw"),
    )
    points = _positions(messages, motion)
    usable = np.isfinite(points).all(axis=(1, 2)) & (turned != 0.0).any(axis=1)
    usable &= np.isfinite(turned).all(axis=1) & np.isfinite(positions).all(axis=1)
    if not usable.any() or points.shape[1] > MOST_FEET:
        return ()
    back = conjugate(normalised(turned[usable]))
    from_base = [
        rotate(back, points[usable, foot] - positions[usable]) for foot in range(points.shape[1])
    ]
    return tuple(
        MessageFoot(name=name) for name in leg_names(median_of(np.stack(from_base, 1), axis=0))
    )


def _source(motion: str, contact: str, base: str) -> ContactSource:
    values = partial(_values, motion=motion, contact=contact)
    return ContactSource(
        type_name="xpp_msgs/RobotStateCartesian",
        fields=(
            *vector(f"{base}.position"),
            *vector(f"{base}.orientation", "xyzw"),
            table(motion, *vector("pos")),
            table("ee_forces", *vector("")),
            numbers(contact),
        ),
        values=values,
        feet_in=partial(_feet_in, motion=motion, base=base),
        any_package=True,
        plans="always",
        frame=WrenchFrame.WORLD,
        has_header=False,
        has_flags=True,
    )


SOURCES: Final = (
    _source("ee_motion", "ee_contact", "base.pose"),
    _source("feet", "common.ee_in_contact", "common.base.pose"),
)
"""The present definition, and that of 2017."""
