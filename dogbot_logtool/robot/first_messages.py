"""The first messages of a channel, which tell names: of feet, of frames, of models."""

from collections.abc import Iterator
from itertools import islice
from typing import Final

from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.fields import Fields
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels

_SPAN_NS: Final = 5_000_000_000
"""ns of a log in which a robot has named all of its feet and frames."""
_MOST_CHUNKS: Final = 64


def first_messages(log: Log, channel: Channel, fields: Fields) -> Iterator[DecodedMessages]:
    """Decode the messages of a channel's first seconds, whatever the chunks that they stand in."""
    chunks = (c for c in log.chunks if c.counts is None or channel.id in c.counts)
    end: int | None = None
    for chunk in islice(chunks, _MOST_CHUNKS):
        if end is not None and chunk.start_time is not None and chunk.start_time > end:
            return
        batch = log.read((chunk,))
        time = batch.messages.log_time[batch.messages.channel == channel.id]
        if len(time):
            end = int(time.min()) + _SPAN_NS if end is None else end
            yield from decode_channels(batch.cropped(None, end), [channel], fields)
