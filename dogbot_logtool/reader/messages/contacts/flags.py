"""Contact flags of all feet and nothing else: muse's and pronto's estimates."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Flags, Floats
from dogbot_logtool.reader.decode.fields import HEADER, number
from dogbot_logtool.reader.messages.contacts.source import ContactSource, FootValues
from dogbot_logtool.reader.messages.contacts.whole_robot import QUADRUPED
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot

_LETTERS: Final = ("lf", "rf", "lh", "rh")
_NOTHING: Final = 0.01
"""Pronto writes a number of its own for each foot in contact, for plots: none is a probability."""


def _values(
    messages: DecodedMessages,
    feet: Sequence[Foot],
    *,
    paths: Sequence[str],
    touches: Callable[[Floats], Flags],
) -> FootValues:
    del feet
    columns = [messages.table.numbers(path).astype(np.float64) for path in paths]
    values = np.stack(columns, axis=1)
    flags = np.where(np.isnan(values), np.nan, touches(values).astype(np.float64))
    return FootValues(stamp=messages.table.nanoseconds("header.stamp"), contact=flags)


def _is_set(values: Floats) -> Flags:
    return np.asarray(values != 0.0)


def _is_plotted(values: Floats) -> Flags:
    return np.asarray(np.abs(values) > _NOTHING)


def _source(
    type_name: str, paths: Sequence[str], touches: Callable[[Floats], Flags]
) -> ContactSource:
    values = partial(_values, paths=tuple(paths), touches=touches)
    return ContactSource(
        type_name=type_name,
        fields=(*HEADER, *map(number, paths)),
        values=values,
        elements=QUADRUPED,
        any_package=True,
        frame=WrenchFrame.UNKNOWN,
        has_force=False,
        has_points=False,
        has_flags=True,
    )


SOURCES: Final = (
    _source(
        "state_estimator_msgs/ContactDetection", [f"stance_{each}" for each in _LETTERS], _is_set
    ),
    _source("pronto_msgs/QuadrupedStance", _LETTERS, _is_plotted),
)
