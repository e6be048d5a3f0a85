import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.geometry.arrays import Flags, Ints
from dogbot_logtool.core.quality.stamps import StampCheck, set_spans, why_unusable

MS = 1_000_000
S = 1_000 * MS
START = 100 * S


def steady(count: int = 400) -> Ints:
    return START + np.arange(count, dtype=np.int64) * 10 * MS


def checked(
    stamp: Ints, log_time: Ints | None = None, cuts: tuple[int, ...] = ()
) -> tuple[StampCheck, Flags]:
    log_time = steady(len(stamp)) if log_time is None else log_time
    check = StampCheck("/foot")
    rows = np.split(np.arange(len(stamp)), cuts)
    decided = [check.add(stamp[part], log_time[part]) for part in rows]
    return check, np.concatenate([*decided, check.finish()])


def test_sound_stamps_are_all_usable() -> None:
    check, usable = checked(steady())
    assert usable.all()
    assert (check.messages, check.bad, check.steps, why_unusable([check])) == (400, 0, [], "")


@pytest.mark.parametrize("row", [0, 1, 200, 398, 399])
def test_a_zero_stamp_costs_its_own_message(row: int) -> None:
    stamp = steady()
    stamp[row] = 0
    check, usable = checked(stamp)
    assert np.flatnonzero(~usable).tolist() == [row]
    assert (check.zeros, check.bad, why_unusable([check])) == (1, 1, "")


def test_of_two_swapped_neighbours_one_is_lost() -> None:
    stamp = steady()
    stamp[[200, 201]] = stamp[[201, 200]]
    check, usable = checked(stamp)
    # The recorders leave out the later one, since its time does not advance.
    assert usable.all()
    assert (check.behind, check.bad, why_unusable([check])) == (1, 1, "")


@pytest.mark.parametrize("row", [0, 1, 200, 390, 398, 399])
@pytest.mark.parametrize("ahead", [300 * S, 2**62])
def test_a_stamp_far_ahead_costs_its_own_message(row: int, ahead: int) -> None:
    stamp = steady()
    stamp[row] += ahead
    check, usable = checked(stamp)
    assert np.flatnonzero(~usable).tolist() == [row]
    assert (check.ahead, check.steps, why_unusable([check])) == (1, [], "")


def test_a_stamp_half_a_second_ahead_costs_its_own_message() -> None:
    stamp = steady()
    stamp[200] += S // 2
    _, usable = checked(stamp)
    assert np.flatnonzero(~usable).tolist() == [200]


def test_mostly_zero_stamps_are_unusable() -> None:
    stamp = steady()
    stamp[:300] = 0
    assert why_unusable([checked(stamp)[0]]) == "header stamps of /foot are zero"


def test_many_swapped_stamps_are_unusable_and_counted() -> None:
    stamp = steady()
    stamp[100:200] = stamp[100:200].reshape(-1, 2)[:, ::-1].ravel()
    check, _ = checked(stamp)
    assert why_unusable([check]) == "header stamps of /foot go backwards (50 of 400)"


def test_a_reset_is_a_step_and_its_neighbours_are_no_bad_stamps() -> None:
    stamp = steady()
    stamp[250:] -= stamp[250] - 1 * S
    check, usable = checked(stamp)
    assert usable.all()
    (step,) = check.steps
    assert (step.before, step.after) == (steady()[249], steady()[250])
    assert step.by_ns == pytest.approx(-(START + 2.5 * S - S), abs=20 * MS)
    assert set_spans([check]).tolist() == [[steady()[249], steady()[250]]]
    reason = why_unusable([check])
    assert reason == (
        "the clock of all topics was set back by 101.50 s at 2.50 s (was the simulation reset?)"
    )


def test_a_clock_that_is_set_forward_is_a_step() -> None:
    stamp = steady()
    stamp[250:] += 1_700_000_000 * S
    check, usable = checked(stamp)
    assert usable.all()
    assert [step.by_ns for step in check.steps] == [1_700_000_000 * S]


def test_a_pause_of_recording_is_no_step() -> None:
    stamp = steady()
    stamp[250:] += 60 * S
    assert checked(stamp, stamp + MS)[0].steps == []


def test_a_fast_simulation_is_no_step() -> None:
    log_time = START + np.arange(400, dtype=np.int64) * MS
    assert checked(steady(), log_time)[0].steps == []


def test_two_publishers_with_clocks_apart_are_no_reset() -> None:
    stamp = steady()
    stamp[::2] -= 30 * S
    check, _ = checked(stamp)
    assert check.steps == []
    assert "/foot go backwards" in why_unusable([check])


faults = st.lists(
    st.tuples(st.integers(0, 119), st.sampled_from([0, 1, -3 * S, 5 * S, 400 * S])), max_size=6
)


@settings(max_examples=100, deadline=None)
@given(faults, st.integers(0, 119), st.lists(st.integers(0, 120), max_size=6))
def test_decisions_do_not_depend_on_batches(
    found: list[tuple[int, int]], reset: int, cuts: list[int]
) -> None:
    stamp = steady(120)
    stamp[reset:] -= 60 * S
    for row, by in found:
        stamp[row] = 0 if by == 0 else stamp[row] + by
    whole, usable = checked(stamp)
    parts, usable_parts = checked(stamp, cuts=tuple(sorted(cuts)))
    assert usable.tolist() == usable_parts.tolist()
    assert (whole.zeros, whole.ahead, whole.behind) == (parts.zeros, parts.ahead, parts.behind)
    assert whole.steps == parts.steps


def test_clocks_that_were_never_set_have_no_spans() -> None:
    assert set_spans([]).shape == (0, 2)


def test_a_stamp_that_is_a_little_late_before_a_reset_is_no_reset() -> None:
    stamp = steady()
    stamp[249] = stamp[248] - 5 * MS
    stamp[250:] -= 60 * S
    check, _ = checked(stamp)
    (step,) = check.steps
    assert (step.before, step.after) == (steady()[249], steady()[250])
