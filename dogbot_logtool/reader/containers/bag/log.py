"""ROS 1 bags: opened through their index where there is a sound one, else by a walk."""

from dataclasses import replace

from dogbot_logtool.core.geometry.arrays import Bytes
from dogbot_logtool.reader.containers.bag.chunk import check_bag_chunk, parse_bag_chunk
from dogbot_logtool.reader.containers.bag.format import BagFormat
from dogbot_logtool.reader.containers.bag.index import Connections, read_index
from dogbot_logtool.reader.containers.bag.records import BagOp
from dogbot_logtool.reader.containers.channel_ids import ChannelIds
from dogbot_logtool.reader.containers.log import Chunk, ChunkContent, Contents, Log
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.salvage.bag_survey import BagSurvey


class BagLog(Log):
    """A ROS 1 bag of format 2.0."""

    container = "ROS 1 bag"

    def __init__(self, source: ByteSource, contents: Contents, connections: Connections) -> None:
        super().__init__(source, contents)
        self._connections = connections
        self._channel_ids = ChannelIds(connections.channel_ids)
        self._numbers = {number: each for each, number in connections.channel_ids.items()}
        """Connection numbers by channel id."""
        self._format = BagFormat()

    def check(self, chunk: Chunk) -> None:
        """See `Log.check`."""
        check_bag_chunk(chunk, self.source.size)

    def parse(self, chunk: Chunk, stored: memoryview, target: Bytes) -> ChunkContent:
        """See `Log.parse`."""
        counts = chunk.counts and {self._numbers[each]: n for each, n in chunk.counts.items()}
        content = parse_bag_chunk(replace(chunk, counts=counts), stored, target, self._format)
        found = {
            self._connections.contradiction(target[place:end].tobytes(), chunk.offset): None
            for op, place, end in content.others.tolist()
            if op == BagOp.CONNECTION
        }
        contradictions = [loss for loss in found if loss is not None]
        if not contradictions:
            return content
        return replace(content, losses=(*content.losses, *contradictions))


def open_bag(source: ByteSource) -> BagLog:
    """Open a bag whose magic has been seen."""
    connections = Connections()
    contents, problem = read_index(source, connections)
    if contents is None:
        connections = Connections()
        source = source.nearby()
        contents = BagSurvey(source, connections).contents(problem)
    return BagLog(source, contents, connections)
