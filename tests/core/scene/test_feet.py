"""A foot at any time, against what was measured of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core import timespans
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.foot_history import foot_history
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.scene.feet import TRAIL, LoadState
from tests.core.scene.drawn_feet import MS, NOWHERE, RULE, Message, foot_of, samples_of

walks = st.lists(
    st.tuples(
        st.sampled_from([1, 4, 9, 10, 24, 25, 26, 61, 200, 3001]),
        st.sampled_from([0.0, 0.0, 3.0, 6.0, 50.0, 50.0, math.nan]),
    ),
    min_size=1,
    max_size=40,
)


def walk_of(steps: list[tuple[int, float]]) -> list[Message]:
    times = np.cumsum([step for step, _ in steps]).tolist()
    return [
        (time, force, (row + 1.0, 0.0, 0.0))
        for row, (time, (_, force)) in enumerate(zip(times, steps, strict=True))
    ]


@given(walks)
def test_samples_are_drawn_as_they_are_measured(steps: list[tuple[int, float]]) -> None:
    messages = walk_of(steps)
    foot = foot_of(messages)
    record = foot_history(samples_of(messages), RULE, TimeSource.HEADER, force_in_world=False)
    for row, (time, force, _) in enumerate(messages):
        stamp = np.array([time * MS + 5])
        if math.isnan(force):
            assert foot.state[row] == LoadState.UNKNOWN
            continue
        assert foot.touching[row] == (foot.state[row] == LoadState.STANCE)
        # What ends a known span is known by the sample itself.
        if timespans.covers(record.known, stamp)[0]:
            down = timespans.covers(record.in_contact, stamp)[0]
            assert foot.state[row] == (LoadState.STANCE if down else LoadState.SWING)


@given(walks)
def test_between_samples_the_newest_one_counts_until_a_silence(
    steps: list[tuple[int, float]],
) -> None:
    messages = walk_of(steps)
    foot = foot_of(messages)
    times = [time for time, _, _ in messages]
    for tick in sorted({time + after for time in times for after in (0, 1, 24, 60, 61)}):
        state = foot.at(np.array([tick * MS]))
        row = max(row for row, time in enumerate(times) if time <= tick)
        known = foot.state[row] != LoadState.UNKNOWN
        assert state.known[0] <= known
        assert state.down[0] == (state.known[0] and foot.state[row] == LoadState.STANCE)
        if tick == times[row]:
            assert state.known[0] == known
        if tick > times[-1] + 60:
            assert not state.known[0]


def test_a_stance_has_the_point_of_its_last_sample_that_has_one() -> None:
    stance = [(10.0 * row, 50.0, (row + 1.0, 0.0, 0.0)) for row in range(6)]
    stance[4] = (40.0, 50.0, NOWHERE)
    state = foot_of(stance).at(np.array([35, 45, 50, 110]) * MS)
    assert state.point[:3, 0].tolist() == [4.0, 4.0, 6.0]
    assert state.down.tolist() == [True, True, True, True]
    # Unlike the state, a point is known for 60 ms.
    assert state.known.tolist() == [True] * 4
    assert not np.isnan(state.point[3, 0])
    assert foot_of(stance).at(np.array([111 * MS])).known.tolist() == [False]


def test_footfalls_are_where_feet_touched_down_newest_first() -> None:
    messages = [
        (10.0 * row, 50.0 if row % 10 < 5 else 0.0, (float(row // 10), 0.0, 0.0))
        for row in range(50)
    ]
    trail = foot_of(messages).trail_at(np.array([-1, 0, 99, 100, 1000]) * MS)
    assert trail.shape == (5, TRAIL, 3)
    nan = math.nan
    np.testing.assert_equal(
        trail[:, :, 0],
        [[nan, nan, nan], [0.0, nan, nan], [0.0, nan, nan], [1.0, 0.0, nan], [4.0, 3.0, 2.0]],
    )


def test_a_touch_that_is_too_short_is_neither_drawn_nor_a_footfall() -> None:
    messages = [(10.0 * row, 50.0 if row == 10 else 0.0, (1.0, 0.0, 0.0)) for row in range(20)]
    foot = foot_of(messages)
    assert not foot.touching.any()
    assert len(foot.touchdown) == 0


def test_where_contact_is_not_known_the_sensor_is_believed() -> None:
    messages = [(0.0, 50.0, NOWHERE), (10.0, 0.0, NOWHERE)]
    stuck = replace(RULE, unusable="it is stuck")
    for foot in (foot_of(messages, stuck), foot_of(messages, contact_known=False)):
        assert set(foot.state.tolist()) == {LoadState.UNKNOWN}
        assert foot.touching.tolist() == [True, False]
        assert not foot.at(np.array([0, 10 * MS])).known.any()


def test_a_foot_without_messages_is_not_known() -> None:
    foot = foot_of([])
    state = foot.at(np.array([0, MS]))
    assert not state.known.any()
    assert np.isnan(foot.trail_at(np.array([0, MS]))).all()


@pytest.mark.parametrize(
    ("in_world", "told", "vertical"),
    [(True, False, 50.0), (False, True, 50.0), (False, False, math.nan)],
)
def test_vertical_force_needs_the_world_frame(
    vertical: float, *, in_world: bool, told: bool
) -> None:
    foot = foot_of([(0.0, 50.0, NOWHERE)])
    samples = replace(foot.samples, in_world=np.array([in_world]))
    foot = replace(foot, samples=samples, force_in_world=told)
    np.testing.assert_equal(foot.at(np.array([0])).vertical, [vertical])


def test_a_sample_whose_time_does_not_advance_is_as_the_one_before() -> None:
    rule = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.0)
    messages = [(0.0, 50.0, NOWHERE), (10.0, 50.0, NOWHERE), (10.0, 0.0, NOWHERE)]
    foot = foot_of([*messages, (20.0, 50.0, NOWHERE)], rule)
    assert foot.state.tolist() == [LoadState.STANCE] * 4
