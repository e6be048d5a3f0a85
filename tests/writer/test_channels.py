"""Which channels are declared, with which ids, under which topics."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.writer.channels import IdSource
from tests.writer.annotated import ENCODINGS, declared


@pytest.mark.parametrize("used", [{1, 2, 3}, {65535}, {40, 65535, 1}, set(range(1, 65500))])
def test_ids_are_free_and_unique(used: set[int]) -> None:
    annotations = declared(ENCODINGS[0], used=frozenset(used))
    for ids in (
        [channel.id for channel in annotations.added.channels],
        [schema.id for schema in annotations.added.schemas],
    ):
        assert len(set(ids)) == len(ids)
        assert used.isdisjoint(ids)
        assert all(0 < number < 65536 for number in ids)
    if max(used) < 65000:
        assert min(channel.id for channel in annotations.added.channels) > max(used)


@given(st.sets(st.integers(65000, 65535)))
def test_ids_above_the_highest_come_first(used: set[int]) -> None:
    source = IdSource(used | set(range(1, 65000)))
    free = [number for number in range(1, 65536) if number not in used and number >= 65000]
    taken = [source.take() for _ in free]
    assert sorted(taken) == free
    highest = max(used | {64999})
    assert taken[: 65535 - highest] == list(range(highest + 1, 65536))
    with pytest.raises(LogtoolError, match="ids"):
        source.take()
