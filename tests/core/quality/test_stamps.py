import numpy as np
import pytest

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.corrections.clock import StampCheck, check_stamps, set_spans, why_unusable

MS = 1_000_000
S = 1_000 * MS
START = 100 * S


def steady(count: int = 400) -> Ints:
    return START + np.arange(count, dtype=np.int64) * 10 * MS


def checked(stamp: Ints, log_time: Ints | None = None) -> StampCheck:
    return check_stamps("/foot", stamp, steady(len(stamp)) if log_time is None else log_time)


def test_sound_stamps_are_all_usable() -> None:
    check = checked(steady())
    assert check.usable.all()
    assert (check.messages, check.bad, check.steps, why_unusable([check])) == (400, 0, (), "")


@pytest.mark.parametrize("row", [0, 1, 200, 398, 399])
def test_a_zero_stamp_costs_its_own_message(row: int) -> None:
    stamp = steady()
    stamp[row] = 0
    check = checked(stamp)
    assert np.flatnonzero(~check.usable).tolist() == [row]
    assert (check.zeros, check.bad, why_unusable([check])) == (1, 1, "")


def test_of_two_swapped_neighbours_one_is_lost() -> None:
    stamp = steady()
    stamp[[200, 201]] = stamp[[201, 200]]
    check = checked(stamp)
    # What measures leaves out the later one, since its time does not advance.
    assert check.usable.all()
    assert (check.behind, check.bad, why_unusable([check])) == (1, 1, "")


@pytest.mark.parametrize("row", [0, 1, 200, 390, 398, 399])
@pytest.mark.parametrize("ahead", [300 * S, 2**62])
def test_a_stamp_far_ahead_costs_its_own_message(row: int, ahead: int) -> None:
    stamp = steady()
    stamp[row] += ahead
    check = checked(stamp)
    assert np.flatnonzero(~check.usable).tolist() == [row]
    assert (check.ahead, check.steps, why_unusable([check])) == (1, (), "")


def test_a_stamp_half_a_second_ahead_costs_its_own_message() -> None:
    stamp = steady()
    stamp[200] += S // 2
    check = checked(stamp)
    assert np.flatnonzero(~check.usable).tolist() == [200]


def test_mostly_zero_stamps_are_unusable() -> None:
    stamp = steady()
    stamp[:300] = 0
    assert why_unusable([checked(stamp)]) == "header stamps of /foot are zero"


def test_many_swapped_stamps_are_unusable_and_counted() -> None:
    stamp = steady()
    stamp[100:200] = stamp[100:200].reshape(-1, 2)[:, ::-1].ravel()
    check = checked(stamp)
    assert why_unusable([check]) == "header stamps of /foot go backwards (50 of 400)"


def test_a_reset_is_a_step_and_its_neighbours_are_no_bad_stamps() -> None:
    stamp = steady()
    stamp[250:] -= stamp[250] - 1 * S
    check = checked(stamp)
    assert check.usable.all()
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
    check = checked(stamp)
    assert check.usable.all()
    assert [step.by_ns for step in check.steps] == [1_700_000_000 * S]


def test_a_pause_of_recording_is_no_step() -> None:
    stamp = steady()
    stamp[250:] += 60 * S
    assert checked(stamp, stamp + MS).steps == ()


def test_a_fast_simulation_is_no_step() -> None:
    log_time = START + np.arange(400, dtype=np.int64) * MS
    assert checked(steady(), log_time).steps == ()


def test_two_publishers_with_clocks_apart_are_no_reset() -> None:
    stamp = steady()
    stamp[::2] -= 30 * S
    check = checked(stamp)
    assert check.steps == ()
    assert "/foot go backwards" in why_unusable([check])


def test_clocks_that_were_never_set_have_no_spans() -> None:
    assert set_spans([]).shape == (0, 2)


def test_a_stamp_that_is_a_little_late_before_a_reset_is_no_reset() -> None:
    stamp = steady()
    stamp[249] = stamp[248] - 5 * MS
    stamp[250:] -= 60 * S
    check = checked(stamp)
    (step,) = check.steps
    assert (step.before, step.after) == (steady()[249], steady()[250])
