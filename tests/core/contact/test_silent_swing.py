"""Silence of sensors that speak only in contact, told as swing."""

import numpy as np
import pytest

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.silent_swing import (
    LONGEST_SWING_NS,
    with_swings,
)
from dogbot_logtool.core.corrections.clock import TimeSource

MS = 1_000_000
INTERVAL = 10 * MS
ZERO = 1_000_000 * MS


def in_contact(times_ms: list[int], foot: int = 0, stamp_rate: float = 1.0) -> Samples:
    time = np.array(times_ms, np.int64) * MS
    count = len(time)
    return Samples(
        foot=np.full(count, foot),
        log_time=ZERO + time,
        stamp=500 * MS + (time * stamp_rate).astype(np.int64),
        in_contact=np.ones(count, np.bool_),
        force=np.full((count, 3), 30.0),
        in_world=np.ones(count, np.bool_),
        points=np.ones(count, np.int64),
        position=np.zeros((count, 3)),
        normal=np.zeros((count, 3)),
    )


def told_ms(samples: Samples, *, contact: bool) -> list[int]:
    rows = samples.in_contact == contact
    times: list[int] = ((samples.log_time[rows] - ZERO) // MS).tolist()
    return times


def swinging(samples: Samples, *ends: int) -> Samples:
    (told,) = with_swings([samples], {0: INTERVAL}, TimeSource.LOG, *(ends or (None, None)))
    return told


def test_a_silence_begins_and_ends_one_interval_from_contact() -> None:
    whole = swinging(in_contact([0, 10, 20, 220, 230]))
    free = told_ms(whole, contact=False)
    assert (free[0], free[-1]) == (30, 210)
    assert max(np.diff([20, *free, 220])) <= 40
    assert told_ms(whole, contact=True) == [0, 10, 20, 220, 230]
    assert (np.diff(whole.log_time) > 0).all()
    assert not whole.force[~whole.in_contact].any()


@pytest.mark.parametrize("silence_ms", [10, 20, 25, LONGEST_SWING_NS // MS + 1, 10**9])
def test_jitter_and_drop_outs_are_no_swing(silence_ms: int) -> None:
    samples = in_contact([0, 10, 10 + silence_ms])
    assert swinging(samples) is samples


def test_feet_that_always_speak_stay_as_they_are() -> None:
    feet = in_contact([0, 10]), in_contact([0, 200], foot=1)
    assert with_swings(feet, {0: INTERVAL}, TimeSource.LOG, None, None) == feet


def test_stamps_run_at_their_own_rate() -> None:
    whole = swinging(in_contact([0, 200], stamp_rate=0.5))
    expected = 500 * MS + (whole.log_time - ZERO) // 2
    assert whole.stamp.tolist() == expected.tolist()


def test_the_log_s_ends_count_as_swing() -> None:
    ends = ZERO - 100 * MS, ZERO + 100 * MS
    whole = swinging(in_contact([0, 10]), *ends)
    free = told_ms(whole, contact=False)
    assert (free[0], free[-1]) == (-100, 100)
    assert -10 in free
    assert 20 in free


STANCE_MS, SWING_MS = 400, 300


def steps_ms(touch: list[int], lost: list[int]) -> list[int]:
    """Messages of nine steps; in the third swing the foot also touches at some times."""
    stances = [
        range(start, start + STANCE_MS + 1, 10)
        for start in range(0, 9 * (STANCE_MS + SWING_MS), STANCE_MS + SWING_MS)
    ]
    third = 3 * STANCE_MS + 2 * SWING_MS
    times = {*(each for stance in stances for each in stance), *(third + each for each in touch)}
    return sorted(times - set(lost))


@pytest.mark.parametrize("share", [0.3, 0.5, 0.6])
def test_a_foot_that_hits_something_swings_before_and_after_it(share: float) -> None:
    at = round(share * SWING_MS / 10) * 10
    samples = in_contact(steps_ms([at, at + 10, at + 20], []))
    free = told_ms(swinging(samples), contact=False)
    liftoff = 3 * STANCE_MS + 2 * SWING_MS
    mine = [each - liftoff for each in free if liftoff < each < liftoff + SWING_MS]
    assert (mine[0], mine[-1]) == (10, SWING_MS - 10)
    assert {at - 10, at + 30} <= set(mine)


def test_lost_messages_inside_a_stance_are_no_swing() -> None:
    lost = list(range(1500, 1600, 10))
    free = told_ms(swinging(in_contact(steps_ms([], lost))), contact=False)
    assert not set(free) & set(range(1400, 1800))
