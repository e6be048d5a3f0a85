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


@pytest.mark.parametrize("row", [0, 1, 200, 398, 399])
def test_a_zero_stamp_costs_its_own_message(row: int) -> None:
    stamp = steady()
    stamp[row] = 0
    check = checked(stamp)
    assert np.flatnonzero(~check.usable).tolist() == [row]
    assert (check.zeros, check.bad, why_unusable([check])) == (1, 1, "")


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


def test_two_publishers_with_clocks_apart_are_no_reset() -> None:
    stamp = steady()
    stamp[::2] -= 30 * S
    check = checked(stamp)
    assert check.steps == ()
    assert "/foot go backwards" in why_unusable([check])


def test_a_stamp_that_is_a_little_late_before_a_reset_is_no_reset() -> None:
    stamp = steady()
    stamp[249] = stamp[248] - 5 * MS
    stamp[250:] -= 60 * S
    check = checked(stamp)
    (step,) = check.steps
    assert (step.before, step.after) == (steady()[249], steady()[250])
