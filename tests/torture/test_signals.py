"""A few of the interruptions that `make torture` tries by the hundred."""

import sys

import pytest

from tests.torture.signals import INT, KILL, TERM, torture


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_nothing_is_left_after_signals() -> None:
    rows = dict(torture(1, [(INT,), (TERM, TERM), (KILL,)], ["convert"]))
    assert {name: row.faults for name, row in rows.items() if row.faults} == {}
    assert len(rows) == 6
