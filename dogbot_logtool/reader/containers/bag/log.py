"""ROS 1 bags."""

from dataclasses import replace

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.bag.chunk import indexed_times
from dogbot_logtool.reader.containers.bag.records import BagOp
from dogbot_logtool.reader.containers.bag.scan import BagScan
from dogbot_logtool.reader.containers.chunked_log import ChunkedLog
from dogbot_logtool.reader.containers.contents import ChannelIds, Chunk, Contents
from dogbot_logtool.reader.containers.salvage.content import ChunkContent
from dogbot_logtool.reader.containers.signatures import BAG_MAGIC
from dogbot_logtool.reader.containers.sources.source import ByteSource


class BagLog(ChunkedLog):
    """A ROS 1 bag of format 2.0."""

    container = "ROS 1 bag"

    def __init__(self, source: ByteSource, contents: Contents, scan: BagScan) -> None:
        super().__init__(source, contents, scan)
        self._connections = scan.connections
        self._channel_ids = ChannelIds(self._connections.channel_ids)
        self._numbers = {each: number for number, each in self._connections.channel_ids.items()}
        """Connection numbers by channel id."""

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `ChunkedLog.parse`."""
        counts = chunk.counts and {self._numbers[each]: n for each, n in chunk.counts.items()}
        content = self._scan.parse(replace(chunk, counts=counts), stored, target)
        found = {
            self._connections.contradiction(target[offset:end].tobytes(), chunk.offset): None
            for op, offset, end in content.others.tolist()
            if op == BagOp.CONNECTION
        }
        contradictions = (loss for loss in found if loss is not None)
        return replace(content, losses=(*content.losses, *contradictions))

    def own_times(self, chunk: Chunk) -> tuple[int | None, int | None] | None:
        """See `ChunkedLog.own_times`: those that the index records behind it name."""
        return indexed_times(self.source, [chunk])[0]


def open_log(source: ByteSource, distribution: str) -> BagLog:
    """Open a bag through its index; where that is absent or damaged, by all of its records."""
    del distribution
    scan = BagScan(source)
    contents, problem = scan.indexed()
    if contents is None:
        source = source.nearby()
        scan = BagScan(source)
        contents = scan.scanned(len(BAG_MAGIC), problem)
    return BagLog(source, contents, scan)
