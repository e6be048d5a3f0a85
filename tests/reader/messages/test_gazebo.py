"""Gazebo's contact sensors as columns: physics steps, bodies and links by their names."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.reader.decode.columns import Texts
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.gazebo import (
    UNTIMED,
    foot_sides,
    newest_step,
    step_times,
    steps_of_messages,
)


def texts(strings: list[str]) -> Texts:
    data = [string.encode() for string in strings]
    length = np.array([len(each) for each in data], np.int64)
    buffer = np.frombuffer(b"".join(data) + b"\0" * 8, np.uint8)
    return Texts(buffer, np.cumsum(length) - length, length)


def ros1_info(time_ns: int) -> str:
    seconds, nanoseconds = divmod(time_ns, 10**9)
    pair = "my geom:dogbot::leg::foot   other geom:ground_plane::link::collision"
    return f"Debug:  i:(0/1)     {pair}         time:{seconds}.{nanoseconds:09d}\n"


def ros2_info(time_ns: int) -> str:
    seconds, nanoseconds = divmod(time_ns, 10**9)
    pair = "my_geom: [dogbot::leg::foot]  other_geom: [ground_plane::link::collision]"
    return f"Debug:  i: (1/1)     {pair}        time: [{seconds}.{nanoseconds}]\n"


@given(
    st.lists(st.lists(st.integers(0, 3), max_size=5), min_size=1, max_size=6),
    st.sampled_from([ros1_info, ros2_info]),
    st.sampled_from([0, 999_999_998, 9_999_999_999, 1_760_000_123_999_999_999]),
)
def test_states_of_the_last_states_time_are_the_newest(
    messages: list[list[int]], info: Callable[[int], str], start: int
) -> None:
    steps = [step for message in messages for step in message]
    owner = np.array([n for n, message in enumerate(messages) for _ in message], np.int64)
    wanted = [step == message[-1] for message in messages for step in message]

    time = step_times(texts([info(start + step) for step in steps]))
    newest, _, untimed = newest_step(time, owner, np.zeros(len(messages), np.int64))

    assert newest.tolist() == wanted
    assert untimed == 0


@given(
    st.lists(st.lists(st.integers(0, 2000), max_size=5), min_size=1, max_size=6),
    st.sampled_from([ros1_info, ros2_info]),
    st.sampled_from([999_999_000, 1_760_000_123_999_999_000]),
)
def test_lags_and_steps_are_those_of_the_times_in_the_text(
    messages: list[list[int]], info: Callable[[int], str], start: int
) -> None:
    messages = [sorted(message) for message in messages]
    infos = texts([info(start + step) for message in messages for step in message])
    owner = np.array([n for n, message in enumerate(messages) for _ in message], np.int64)
    stamp = start + 3000 * np.arange(len(messages))
    lags = [3000 * n - message[-1] if message else UNTIMED for n, message in enumerate(messages)]
    steps = [b - a for message in messages for a, b in pairwise(sorted(set(message)))]

    assert newest_step(step_times(infos), owner, stamp)[1].tolist() == lags
    assert steps_of_messages(step_times(infos), owner).tolist() == steps


@pytest.mark.parametrize("info", ["", "no time here", "time12.5", "x" * 100, "time"])
def test_a_message_that_tells_no_time_is_one_step_and_is_counted(info: str) -> None:
    infos = [ros1_info(1), info, ros1_info(2), info, ros1_info(3)]
    owner = np.array([0, 0, 0, 1, 2], np.int64)

    newest, _, untimed = newest_step(step_times(texts(infos)), owner, np.zeros(3, np.int64))

    assert newest.tolist() == [True] * 5
    assert untimed == 1


@pytest.mark.parametrize(
    ("collision", "link"),
    [
        ("dogbot::front_left_lowerleg::lump__foot_collision_5", "front_left_lowerleg"),
        ("world::dogbot::leg::foot", "leg"),
        ("foot_collision", None),
    ],
)
def test_the_link_stands_in_the_collisions_name(collision: str, link: str | None) -> None:
    pair = texts([collision, "ground_plane::link::collision"])
    foot = Foot("front_left", "/x", collision=collision)
    _, links = foot_sides(pair.pick(np.array([0])), pair.pick(np.array([1])), np.array([0]), [foot])
    assert links == ({0: {link}} if link else {})
