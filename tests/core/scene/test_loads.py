"""The load on a foot, in newtons and in body weights, and where feet fall silent."""

import math

import numpy as np
import pytest

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.scene.feet import LoadState
from dogbot_logtool.core.scene.loads import Loads, foot_loads, silences
from tests.core.scene.drawn_feet import MS, NOWHERE, foot_of


def loads_of(*vertical: float, weight_n: float | None = None, opening: int = 0) -> Loads:
    """Loads of a foot that tells one each 10 ms, from 10 ms on."""
    rule = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.0)
    messages = [(10.0 * (row + 1), force, NOWHERE) for row, force in enumerate(vertical)]
    return foot_loads(foot_of(messages, rule), slice(0, len(vertical)), weight_n, opening)


def test_states_are_those_of_contact_detection() -> None:
    loads = loads_of(5.0, 20.0, 5.0, 2.0, math.nan, 2.0, opening=10 * MS)
    assert [LoadState(state) for state in loads.state.tolist()] == [
        LoadState.SWING,
        LoadState.STANCE,
        LoadState.STANCE,
        LoadState.SWING,
        LoadState.UNKNOWN,
        LoadState.SWING,
    ]
    assert loads.in_contact.tolist() == [False, True, True, False, True, False]


def test_the_first_load_stands_at_the_log_s_first_time_if_near() -> None:
    loads = loads_of(20.0, 30.0)
    assert loads.log_time.tolist() == [0, 10 * MS, 20 * MS]
    assert loads.stamp.tolist() == [0, 10 * MS + 5, 20 * MS + 5]
    assert loads.force.tolist() == [20.0, 20.0, 30.0]
    assert loads_of(20.0, opening=10 * MS).log_time.tolist() == [10 * MS]
    assert loads_of(20.0, opening=-100 * MS).log_time.tolist() == [10 * MS]


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
