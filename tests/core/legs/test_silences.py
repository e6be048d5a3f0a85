import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.legs.silences import silent_before, unbroken

SECOND = 1_000_000_000


def test_a_step_of_more_than_a_tenth_of_a_second_is_a_silence() -> None:
    time = np.array([0, 50, 150, 251, 252]) * 1_000_000
    assert silent_before(time).tolist() == [False, False, False, True, False]


@given(
    st.lists(st.tuples(st.integers(0, 40), st.booleans()), min_size=1, max_size=8),
    st.integers(-2, 42),
    st.integers(0, 20),
)
def test_a_span_is_unbroken_where_no_break_lies_in_it(
    rows: list[tuple[int, bool]], start: int, length: int
) -> None:
    end = start + length
    marked = dict(rows)
    time = sorted(marked)
    breaks = np.array([marked[each] for each in time])
    # A break marks the whole step from the row before.
    steps = [
        (before, after)
        for before, after in zip([-np.inf, *time], time, strict=False)
        if marked[after] and np.isfinite(before)
    ]
    expected = end <= time[-1] and not any(a < end and b > start for a, b in steps)
    found = unbroken(np.array(time), breaks, np.array([start]), np.array([end]))
    if start >= time[0]:
        assert found.tolist() == [expected]
