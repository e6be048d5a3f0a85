"""Contacts and samples of which arrows are drawn."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import FOOT_IS_COLLISION1, Contacts

Vector = tuple[float, float, float]

INF: Final = math.inf
NAN: Final = math.nan

generated = settings(max_examples=75, deadline=None)


def vectors(rows: list[Vector]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array(rows, np.float64).reshape(len(rows), 3)


@dataclass(frozen=True)
class State:
    total_force: Vector
    points: tuple[Vector, ...]


@dataclass(frozen=True)
class Message:
    foot: int
    log_time: int
    stamp: int
    states: tuple[State, ...]


def contacts_of(messages: list[Message]) -> Contacts:
    """Columns of messages: all their first states, then all second ones, as the reader does."""
    most = max((len(message.states) for message in messages), default=0)
    states = [
        (row, message.states[index])
        for index in range(most)
        for row, message in enumerate(messages)
        if index < len(message.states)
    ]
    points = [(row, point) for row, (_, state) in enumerate(states) for point in state.points]
    return Contacts(
        foot=np.array([message.foot for message in messages], np.int64),
        log_time=np.array([message.log_time for message in messages], np.int64),
        stamp=np.array([message.stamp for message in messages], np.int64),
        state_message=np.array([row for row, _ in states], np.int64),
        foot_side=np.full(len(states), FOOT_IS_COLLISION1, np.int8),
        newest=np.arange(len(states)) % 2 == 0,  # classic does not look
        total_force=vectors([state.total_force for _, state in states]),
        point_state=np.array([row for row, _ in points], np.int64),
        point=vectors([point for _, point in points]),
        wrench_state=np.empty(0, np.int64),
        wrench_force=vectors([]),
        normal_state=np.empty(0, np.int64),
        normal=vectors([]),
    )


def pressed(force: Vector) -> Message:
    return Message(0, 5, 7, (State(force, ((1.0, 2.0, 3.0),)),))


components: Final = st.one_of(
    st.floats(-250, 250),
    st.floats(-30, 30),
    st.floats(),
    st.sampled_from([0.0, -0.0, NAN, INF, -INF, 1e154, 1.4e154, -1e200, 5e-324, 200.0]),
)
points: Final = st.tuples(*[st.floats(-9, 9) | st.sampled_from([NAN, INF])] * 3)


def turned_x(quaternion: object) -> list[float]:
    """Rotate (1, 0, 0) by a unit quaternion x, y, z, w: the first column of its matrix."""
    x, y, z, w = np.asarray(quaternion).tolist()
    return [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]
