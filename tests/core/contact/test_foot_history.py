"""One foot's samples: contact, debouncing, gaps, impulses."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.contact_detection import schmitt
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.contact.stances import Cut
from dogbot_logtool.core.corrections.clock import TimeSource

MS = 1_000_000
RULE = ContactRule(10.0, 0.0, 0.020)
START = 1_700_000_000_000_000_000


def samples(force: Floats, time: Ints | None = None) -> Samples:
    """Samples of one foot, straight up, every 5 ms unless times are given."""
    count = len(force)
    at = START + np.arange(count, dtype=np.int64) * 5 * MS if time is None else time
    touching = force > 0.0
    up = np.zeros((count, 3))
    up[:, 2] = 1.0
    unknown = np.where(touching, 0.0, np.nan)[:, None]
    return Samples(
        foot=np.zeros(count, np.int64),
        log_time=at,
        stamp=at,
        in_contact=touching,
        force=up * force[:, None],
        in_world=np.zeros(count, np.bool_),
        points=touching.astype(np.int64),
        position=np.zeros((count, 3)) + unknown,
        normal=up + unknown,
    )


def record(
    given: Samples,
    *,
    rule: ContactRule = RULE,
    clock: TimeSource = TimeSource.HEADER,
    world: bool = True,
) -> FootHistory:
    return foot_history(given, rule, clock, force_in_world=world)


def signal(*runs: tuple[int, float]) -> Floats:
    """Force from (number of samples, newtons)."""
    return np.concatenate([np.full(count, force) for count, force in runs])


def in_ms(time: Ints) -> list[int]:
    return [int(each) // MS for each in time - START]


def test_a_light_touch_does_not_start_a_stance_but_keeps_one() -> None:
    """A walking foot may carry next to nothing in mid-stance: only the sensor ends a contact."""
    result = record(samples(signal((10, 0), (10, 3), (10, 60), (10, 3), (10, 60), (10, 0))))
    assert in_ms(result.stances.touchdown) == [100]
    assert in_ms(result.stances.liftoff) == [250]


def test_a_lower_threshold_ends_contact_if_one_is_set() -> None:
    rule = ContactRule(10.0, 5.0, 0.020)
    result = record(samples(signal((10, 0), (10, 60), (10, 3), (10, 60), (10, 0))), rule=rule)
    assert len(result.stances.touchdown) == 2


def test_between_the_thresholds_the_state_stays() -> None:
    rule = ContactRule(10.0, 5.0, 0.0)
    force = np.array([0.0, 7.0, 10.0, 7.0, 5.0, 4.9, 7.0])
    assert schmitt(force, rule).tolist() == [0, 0, 1, 1, 1, 0, 0]


def test_a_dropout_in_stance_cuts_it_and_is_no_swing() -> None:
    force = signal((20, 0), (60, 50), (20, 0), (40, 50), (20, 0))
    whole = samples(force)
    silent = np.ones(len(force), np.bool_)
    silent[40:60] = False
    result = record(whole.pick(silent))
    assert in_ms(result.gaps.ravel()) == [39 * 5, 60 * 5]
    assert result.stances.cut.tolist() == [Cut.GAP, Cut.WHOLE]
    known = len(force) * 5 - 5 - 105
    contact = 60 * 5 - 105 + 40 * 5
    assert result.contact_fraction() == pytest.approx(contact / known)


def test_duplicates_and_steps_back_are_left_out_and_counted() -> None:
    force = signal((10, 0), (20, 50), (10, 0))
    sound = record(samples(force))
    order = np.array([*range(15), 14, 14, 12, 13, *range(15, 40)])
    torn = record(samples(force).pick(order))
    assert torn.not_advancing == 4
    assert torn.stances.touchdown.tolist() == sound.stances.touchdown.tolist()
    assert torn.stances.figures.mean_force_n.tolist() == sound.stances.figures.mean_force_n.tolist()


def test_a_foot_that_stands_is_not_reduced_but_is_in_contact() -> None:
    result = record(samples(signal((100, 0), (4000, 50), (100, 0))))
    assert in_ms(result.stances.touchdown) == [500]
    assert in_ms(result.stances.liftoff) == [20_500]
    assert result.stances.cut.tolist() == [Cut.WHOLE]
    assert np.isnan(result.stances.figures.peak_force_n).all()
    assert result.track.vertical_within(result.known) == pytest.approx(1000.0)


def naive_stances(force: list[float]) -> list[tuple[int, int]]:
    """Debounce sample by sample, the obvious way: rows of touchdown and lift-off."""
    runs: list[list[int]] = []
    for row, value in enumerate(force):
        if value <= 0.0:
            continue
        if runs and runs[-1][1] == row:
            runs[-1][1] = row + 1
        else:
            runs.append([row, row + 1])
    joined: list[list[int]] = []
    for run in runs:
        if joined and (run[0] - joined[-1][1]) * 5 < 20:
            joined[-1][1] = run[1]
        else:
            joined.append(run)
    last = len(force) - 1
    return [
        (start, min(end, last))
        for start, end in joined
        # Swings that were filled do not make a stance long; a short one at either end of the log
        # may be part of a longer one.
        if sum(value > 0.0 for value in force[start:end]) * 5 >= 20
        or start == 0
        or (last - end) * 5 < 20
    ]


patterns = st.lists(
    st.tuples(st.integers(1, 7), st.sampled_from([0.0, 0.0, 40.0, 70.0])), min_size=1, max_size=30
)


@settings(max_examples=60, deadline=None)
@given(patterns)
def test_stances_are_what_the_obvious_way_finds(runs: list[tuple[int, float]]) -> None:
    force = signal(*runs)
    result = record(samples(force))
    found = [
        (touchdown // 5, liftoff // 5)
        for touchdown, liftoff in zip(
            in_ms(result.stances.touchdown), in_ms(result.stances.liftoff), strict=True
        )
    ]
    assert found == naive_stances(force.tolist())


def test_a_touchdown_is_dated_back_to_where_the_force_rose() -> None:
    rule = ContactRule(10.0, 5.0, 0.020, backdates=True)
    force = signal((10, 0), (2, 6), (1, 8), (20, 60), (10, 0))
    whole = samples(force)
    assert in_ms(record(whole, rule=rule).stances.touchdown) == [50]
    assert in_ms(record(whole, rule=replace(rule, backdates=False)).stances.touchdown) == [65]


def test_a_rise_is_dated_back_by_a_tenth_of_a_second_at_most() -> None:
    rule = ContactRule(10.0, 5.0, 0.020, backdates=True)
    force = signal((10, 0), (60, 6), (20, 60), (10, 0))
    assert in_ms(record(samples(force), rule=rule).stances.touchdown) == [250]
