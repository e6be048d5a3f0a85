"""Which chunks are looked at before a log is read through."""

import numpy as np
import pytest

from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot import chunks
from dogbot_logtool.robot.chunks import spread_chunks
from tests.paths import SAMPLE_LOGS

LOGS = ["dogbot_trot.bag", "dogbot_walk.mcap"]
MEBIBYTE = 1_048_576


@pytest.mark.parametrize("name", LOGS)
def test_small_chunks_are_looked_at_until_they_are_a_mebibyte(name: str) -> None:
    log = open_log(SAMPLE_LOGS / name)
    looked = spread_chunks(log, set(log.channels))
    log.close()
    assert 8 < len(looked) <= len(log.chunks)
    mean = sum(chunk.data_size for chunk in log.chunks) / len(log.chunks)
    assert len(looked) == pytest.approx(min(MEBIBYTE / mean, len(log.chunks)), abs=1)


@pytest.mark.parametrize("name", LOGS)
def test_eight_large_chunks_are_enough(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunks, "_LEAST_SIZE", 1)
    log = open_log(SAMPLE_LOGS / name)
    looked = [chunk.offset for chunk in spread_chunks(log, set(log.channels))]
    log.close()
    offsets = [chunk.offset for chunk in log.chunks]
    assert (len(looked), looked[0], looked[-1]) == (8, offsets[0], offsets[-1])
    steps = np.diff([offsets.index(offset) for offset in looked])
    assert steps.max() - steps.min() <= 1


def test_without_channels_nothing_is_looked_at() -> None:
    log = open_log(SAMPLE_LOGS / LOGS[0])
    assert spread_chunks(log, set()) == []
    log.close()
