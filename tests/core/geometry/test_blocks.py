import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.geometry import blocks
from dogbot_logtool.core.geometry.blocks import Blocks, GrowingTable


def odometry(start: int, count: int) -> Odometry:
    time = np.arange(start, start + count, dtype=np.int64)
    vector, turn = np.zeros((count, 3)), np.zeros((count, 4))
    return Odometry(time, time, vector, turn, vector, vector)


@given(st.lists(st.integers(0, 25), max_size=8), st.integers(1, 9))
def test_blocks_are_of_one_size_whatever_comes_in(counts: list[int], size: int) -> None:
    stream: Blocks[Odometry] = Blocks(size)
    found: list[Odometry] = []
    row = 0
    for count in counts:
        found += stream.add(odometry(row, count))
        row += count
    assert all(len(block.log_time) == size for block in found)
    found += stream.rest()
    times = [time for block in found for time in block.log_time.tolist()]
    assert times == list(range(row))
    assert list(stream.rest()) == []


@pytest.mark.parametrize("large_bytes", [0, 100, 1 << 20])
def test_a_table_keeps_its_rows_in_order(monkeypatch: pytest.MonkeyPatch, large_bytes: int) -> None:
    monkeypatch.setattr(blocks, "_LARGE_BYTES", large_bytes)
    table = GrowingTable(2)
    rows = np.arange(60.0).reshape(-1, 2)
    for part in np.array_split(rows, 7):
        table.append(part)
    np.testing.assert_array_equal(table.stacked(), rows)
    table.append(rows[:1])
    np.testing.assert_array_equal(table.stacked(), np.concatenate([rows, rows[:1]]))


def test_an_empty_table_has_its_columns() -> None:
    assert GrowingTable(3).stacked().shape == (0, 3)
