"""Feet followed through batches, against a foot that is followed message by message."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import (
    TRAIL,
    ContactSensor,
    FootMemory,
    FootState,
    follow_feet,
    initial_memory,
)

MS = 1_000_000
RULE = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.020)
HEARING = ContactSensor(RULE)
SILENT = ContactSensor(RULE, swing_after_ns=25 * MS)


@dataclass(frozen=True)
class Message:
    """What one foot says at a time, ms."""

    time: int
    force: float
    x: float = 0.0


def samples(messages: list[Message], foot: int = 0) -> Samples:
    count = len(messages)
    force = np.zeros((count, 3))
    force[:, 2] = [message.force for message in messages]
    touching = force[:, 2] > 0.0
    position = np.full((count, 3), np.nan)
    position[touching] = np.array([[m.x, 2.0 * m.x, 0.5] for m in messages]).reshape(-1, 3)[
        touching
    ]
    return Samples(
        foot=np.full(count, foot),
        log_time=np.array([message.time * MS for message in messages], np.int64),
        stamp=np.zeros(count, np.int64),
        in_contact=touching,
        force=force,
        in_world=np.ones(count, np.bool_),
        points=touching.astype(np.int64),
        position=position,
        normal=np.full((count, 3), np.nan),
    )


def followed(
    parts: list[list[Message]], sensor: ContactSensor, ticks: list[int]
) -> tuple[list[tuple[object, ...]], list[list[float]], FootMemory]:
    """Follow a foot batch by batch; ask each batch for the ticks from its first message on."""
    memory, states, trails = initial_memory(), [], []
    bounds = [*(part[0].time for part in parts[1:]), 10**9]
    begin = -(10**9)
    for part, end in zip(parts, bounds, strict=True):
        (tracker,) = follow_feet([samples(part)], [memory], [sensor], force_in_world=False)
        time = np.array([tick for tick in ticks if begin <= tick < end], np.int64) * MS
        states += rows_of(tracker.at(time))
        trails += [
            [x for x in trail.tolist() if not np.isnan(x)]
            for trail in tracker.trail_at(time)[:, :, 0]
        ]
        memory, begin = tracker.memory(), end
    return states, trails, memory


def rows_of(state: FootState) -> list[tuple[object, ...]]:
    known, down = state.known.tolist(), state.down.tolist()
    places = np.where(state.down, np.nan_to_num(state.point[:, 0]), 0.0).tolist()
    return list(zip(known, down, places, strict=True))


def expected(
    messages: list[Message], sensor: ContactSensor, tick: int
) -> tuple[tuple[object, ...], list[float]]:
    """Listen to one message after the other up to a tick."""
    heard: list[Message] = []
    for message in messages:
        if message.time <= tick and (not heard or message.time > heard[-1].time):
            heard.append(message)
    told: list[tuple[int, bool, float]] = []
    for message in heard:
        on = told[-1][1] if told else False
        before = heard[heard.index(message) - 1] if message is not heard[0] else None
        swing = sensor.swing_after_ns
        if swing is not None and before is not None and message.time - before.time >= swing // MS:
            told.append((before.time + swing // MS, False, 0.0))
            on = False
        on = message.force >= 10.0 or (on and message.force >= 4.0)
        told.append((message.time, on, message.x))
    return state_of(heard, told, sensor, tick), footfalls_of(told)


def state_of(
    heard: list[Message], told: list[tuple[int, bool, float]], sensor: ContactSensor, tick: int
) -> tuple[object, ...]:
    if not heard or not (sensor.works or any(on for _, on, _ in told)):
        return False, False, 0.0
    silence = tick - heard[-1].time
    down = told[-1][1]
    if sensor.swing_after_ns is None:
        known = silence <= 60
    else:
        known = silence <= 3000
        down = down and silence < sensor.swing_after_ns // MS
    return known, known and down, heard[-1].x if known and down else 0.0


def footfalls_of(told: list[tuple[int, bool, float]]) -> list[float]:
    """Take each message as it comes; a stance that is long enough is a footfall, once."""
    found: list[float] = []
    since = left = None
    place, counted, was_on = 0.0, False, False
    for time, on, x in told:
        if on and (since is None or (left is not None and time - left >= 20)):
            since, place, counted = time, x, False
        if since is not None and (on or was_on) and time - since >= 20 and not counted:
            found.append(place)
            counted = True
        if on:
            left = None
        elif was_on:
            left = time
        was_on = on
    return found[-TRAIL:][::-1]


walks = st.lists(
    st.tuples(
        st.sampled_from([1, 4, 9, 10, 24, 25, 26, 61, 200, 3001]),
        st.sampled_from([0.0, 0.0, 3.0, 6.0, 50.0, 50.0]),
    ),
    min_size=1,
    max_size=40,
)


sensors = st.builds(replace, st.sampled_from([HEARING, SILENT]), works=st.booleans())


@given(walks, st.sets(st.integers(1, 39), max_size=5), sensors)
def test_a_foot_is_followed_whatever_the_batches(
    steps: list[tuple[int, float]], cuts: set[int], sensor: ContactSensor
) -> None:
    times = np.cumsum([step for step, _ in steps]).tolist()
    messages = [
        Message(time, force, number + 1.0)
        for number, (time, (_, force)) in enumerate(zip(times, steps, strict=True))
    ]
    edges = [0, *sorted(cut for cut in cuts if cut < len(messages)), len(messages)]
    parts = [messages[a:b] for a, b in pairwise(edges)]
    ticks = sorted({*times, *(time + step for time in times for step in (1, 7, 24, 25, 60, 61))})
    states, trails, _ = followed(parts, sensor, ticks)
    wanted = [expected(messages, sensor, tick) for tick in ticks]
    assert states == [state for state, _ in wanted]
    assert trails == [trail for _, trail in wanted]


def test_a_batch_without_the_foot_changes_nothing() -> None:
    (tracker,) = follow_feet(
        [samples([Message(0, 50.0)])], [initial_memory()], [HEARING], force_in_world=False
    )
    other = samples([Message(5, 50.0)], foot=1)
    for nothing in ([], [other]):
        (later,) = follow_feet(nothing, [tracker.memory()], [HEARING], force_in_world=False)
        assert later.at(np.array([30 * MS])).down.tolist() == [True]
        assert later.at(np.array([90 * MS])).known.tolist() == [False]


def test_a_foot_that_was_never_heard_is_not_known() -> None:
    (tracker,) = follow_feet([], [initial_memory()], [HEARING], force_in_world=False)
    state = tracker.at(np.array([0, MS]))
    assert not state.known.any()
    assert np.isnan(tracker.trail_at(np.array([0, MS]))).all()
    assert len(tracker.memory().rows) == 0


def test_forces_that_are_no_numbers_are_left_out() -> None:
    messages = samples([Message(0, 50.0, 1.0), Message(10, np.inf, 2.0), Message(20, np.nan, 3.0)])
    (tracker,) = follow_feet([messages], [initial_memory()], [HEARING], force_in_world=False)
    state = tracker.at(np.array([25 * MS, 61 * MS]))
    assert (state.known.tolist(), state.point[0, 0]) == ([True, False], 1.0)


def test_vertical_force_needs_the_world_frame() -> None:
    for in_world, told, vertical in (
        (True, False, 50.0),
        (False, True, 50.0),
        (False, False, np.nan),
    ):
        reduced = replace(samples([Message(0, 50.0)]), in_world=np.array([in_world]))
        (tracker,) = follow_feet([reduced], [initial_memory()], [HEARING], force_in_world=told)
        np.testing.assert_equal(tracker.at(np.array([0])).vertical, [vertical])


def test_a_foot_of_two_sorts_of_messages_is_heard_in_the_order_of_time() -> None:
    first = samples([Message(0, 50.0, 1.0), Message(20, 50.0, 3.0)])
    second = samples([Message(10, 50.0, 2.0)])
    (tracker,) = follow_feet([first, second], [initial_memory()], [HEARING], force_in_world=False)
    assert tracker.at(np.array([12 * MS, 20 * MS])).point[:, 0].tolist() == [2.0, 3.0]
