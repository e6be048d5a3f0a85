"""The load on a foot, in newtons and in body weights, and where feet fall silent."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import foot_history
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.scene.feet import DrawnFoot, LoadState, drawn_foot
from dogbot_logtool.core.scene.loads import opening_load, silences

MS = 1_000_000
NOWHERE = (math.nan, math.nan, math.nan)
RULE = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.020)
Point = tuple[float, float, float]
Message = tuple[float, float, Point]
"""When, ms; the vertical force, N; the contact point, m."""


def samples_of(messages: Sequence[Message], number: int = 0) -> Samples:
    time = np.array([round(time * MS) for time, _, _ in messages], np.int64)
    force = np.array([force for _, force, _ in messages], np.float64)
    touching = np.isnan(force) | (force > 0.0)
    position = np.array([point for _, _, point in messages], np.float64).reshape(-1, 3)
    return Samples(
        foot=np.full(len(time), number),
        log_time=time,
        stamp=time + 5,
        in_contact=touching,
        force=np.column_stack([np.zeros(len(time)), np.zeros(len(time)), force]),
        in_world=np.ones(len(time), np.bool_),
        points=(touching & np.isfinite(position[:, 0])).astype(np.int64),
        position=np.where(touching[:, None], position, np.nan),
        normal=np.full((len(time), 3), np.nan),
    )


def foot_of(
    messages: Sequence[Message],
    rule: ContactRule = RULE,
    *,
    number: int = 0,
    contact_known: bool = True,
    has_force: bool = True,
) -> DrawnFoot:
    """Measure a foot, and return it as it is drawn."""
    samples = samples_of(messages, number)
    record = foot_history(
        samples, rule, TimeSource.HEADER, force_in_world=False, has_force=has_force
    )
    return drawn_foot(
        number,
        samples,
        record,
        contact_known=contact_known,
        has_force=has_force,
    )


def foot_with(*vertical: float) -> DrawnFoot:
    """Return a foot that tells one load each 10 ms, from 10 ms on."""
    rule = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.0)
    messages = [(10.0 * (row + 1), force, NOWHERE) for row, force in enumerate(vertical)]
    return foot_of(messages, rule)


def test_the_first_load_stands_at_the_log_s_first_time_if_near() -> None:
    load = opening_load(foot_with(20.0, 30.0), None, 0)
    assert (load.log_time.tolist(), load.stamp.tolist(), load.force.tolist()) == ([0], [0], [20.0])
    for opening in (10 * MS, -100 * MS):
        assert not len(opening_load(foot_with(20.0), None, opening).foot)
    assert not len(opening_load(foot_with(), None, 0).foot)


@pytest.mark.parametrize(
    ("times_ms", "end_ms", "unknown_ms"),
    [
        ([10, 20, 30, 200, 210], 215, [40]),
        (range(0, 1000, 10), 1000, []),
        ([], 1000, [0]),
        ([0, 10, 20], 500, [30]),
        ([300, 310], 320, [0]),
        (range(0, 4000, 200), 4500, []),
        (range(0, 4000, 200), 6000, [4000]),
    ],
)
def test_a_silence_begins_when_the_next_message_is_due(
    times_ms: list[int], end_ms: int, unknown_ms: list[int]
) -> None:
    foot = foot_of([(time, 50.0, NOWHERE) for time in times_ms])
    rows = silences([foot], 0, end_ms * MS)
    assert set(rows.state.tolist()) <= {LoadState.UNKNOWN}
    assert np.isnan(rows.force).all()
    assert (rows.log_time // MS).tolist() == unknown_ms
