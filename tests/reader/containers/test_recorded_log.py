"""Logs without the annotations that `convert` added."""

import struct
from pathlib import Path

from dogbot_logtool.reader.containers.log import EarlierAnnotations
from dogbot_logtool.reader.opening import open_log
from tests.reader.mcap_bytes import resealed, small_mcap


def recorded_times(path: Path, annotations: frozenset[int]) -> tuple[list[int], str]:
    """Return the times of the messages that are read, and what is said of damage."""
    log = open_log(path).without(EarlierAnnotations(annotations))
    batches = [log.read(span) for span in log.spans()]
    log.close()
    times = [each for batch in batches for each in batch.messages.log_time.tolist()]
    losses = [*log.losses, *(loss for batch in batches for loss in batch.losses)]
    return times, "\n".join(loss.what for loss in losses)


def test_a_chunk_whose_index_names_only_annotations_is_read(tmp_path: Path) -> None:
    """The index of the second chunk says that its messages of channel 1 are of channel 3."""
    mcap = small_mcap("lz4")
    mcap.topics = {1: "/left", 2: "/annotation", 3: "/other_annotation"}
    mcap.stated_counts = {1: 4, 2: 6, 3: 2}
    data = mcap.build()
    at = data.index(struct.pack("<Q", mcap.chunk_starts[1]), mcap.summary_start)
    where = at + 20 if data[at + 20] == 1 else at + 30
    assert data[where : where + 2] == b"\x01\x00"
    path = tmp_path / "log.mcap"
    path.write_bytes(resealed(data[:where] + b"\x03" + data[where + 1 :], mcap))

    times, losses = recorded_times(path, frozenset({2, 3}))

    recorded = [each.log_time for chunk in mcap.chunks for each in chunk if each.channel == 1]
    assert times == recorded
    assert f"chunk at byte {mcap.chunk_starts[1]} holds" in losses
