"""Channel ids by the numbers that records give."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.reader.containers.channel_ids import UNKNOWN_CHANNEL, ChannelIds

NUMBERS = st.one_of(st.integers(0, 5), st.integers(0, 2**32 - 1))


@given(st.dictionaries(NUMBERS, st.integers(0, 2**16)), st.lists(NUMBERS))
def test_ids_are_those_of_a_dictionary(ids: dict[int, int], numbers: list[int]) -> None:
    found = ChannelIds(ids).of(np.array(numbers, np.int64))
    assert found.tolist() == [ids.get(number, UNKNOWN_CHANNEL) for number in numbers]
