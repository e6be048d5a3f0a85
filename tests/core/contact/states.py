"""Contact messages as a test writes them, and their columns."""

from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.contact.contacts import FOOT_IS_COLLISION1, Contacts

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class State:
    force: Vector = (0, 0, 10)
    points: tuple[Vector, ...] = ((0, 0, 0),)
    wrenches: tuple[Vector, ...] = ((0, 0, 10),)
    normals: tuple[Vector, ...] = ((0, 0, 1),)
    side: int = FOOT_IS_COLLISION1
    newest: bool = True


Message = tuple[State, ...]


def vectors(rows: list[Vector]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array(rows, np.float64).reshape(len(rows), 3)


def contacts_of(messages: list[Message], order: list[int] | None = None) -> Contacts:
    """Columns of messages.

    Args:
        messages: the messages.
        order: the message of each state in turn, so that states of different messages mix;
            None: message by message.
    """
    if order is None:
        order = [row for row, message in enumerate(messages) for _ in message]
    left = [list(message) for message in messages]
    states = [(row, left[row].pop(0)) for row in order]
    points = [(row, point) for row, (_, state) in enumerate(states) for point in state.points]
    wrenches = [(row, one) for row, (_, state) in enumerate(states) for one in state.wrenches]
    normals = [(row, normal) for row, (_, state) in enumerate(states) for normal in state.normals]
    count = len(messages)
    return Contacts(
        foot=np.arange(count) % 4,
        log_time=np.arange(count) * 10 + 1000,
        stamp=np.arange(count) * 10,
        state_message=np.array(order, np.int64),
        foot_side=np.array([state.side for _, state in states], np.int8),
        newest=np.array([state.newest for _, state in states], np.bool_),
        total_force=vectors([state.force for _, state in states]),
        point_state=np.array([row for row, _ in points], np.int64),
        point=vectors([point for _, point in points]),
        wrench_state=np.array([row for row, _ in wrenches], np.int64),
        wrench_force=vectors([wrench for _, wrench in wrenches]),
        normal_state=np.array([row for row, _ in normals], np.int64),
        normal=vectors([normal for _, normal in normals]),
    )
