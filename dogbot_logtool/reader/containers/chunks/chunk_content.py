"""Content of a decompressed chunk, or the reason why there is none."""

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.contents import Chunk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.decode.message_table import Messages


class ChunkDamage(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """A chunk cannot be used; the text says why."""

    def __init__(self, what: str, messages: int | None = None) -> None:
        """Say why.

        Args:
            what: the rest of the sentence "it was left out: ...".
            messages: how many were in it, if an index behind it says so.
        """
        super().__init__(what)
        self.messages = messages


@dataclass(frozen=True, slots=True)
class ChunkContent:
    """Messages that a container's own code finds in a decompressed chunk."""

    messages: Messages
    """Channels as numbered in the records, offsets relative to the chunk's first byte."""
    others: Ints
    """(k, 3) records that are no messages: kind, first byte, and end."""
    losses: tuple[Loss, ...] = ()
    indexed: bool = False
    """The index behind the chunk names all messages truthfully."""


def left_out(chunk: Chunk, damage: ChunkDamage) -> Loss:
    """Say that nothing in a chunk can be used."""
    what = f"the chunk at byte {chunk.offset} was left out: {damage}"
    messages = chunk.messages if damage.messages is None else damage.messages
    return Loss(chunk.offset, what, chunk.data_size, messages)


def undescribed(chunk: Chunk, messages: int, size: int) -> Loss:
    """Say that the channels of some messages of a chunk are not described.

    Args:
        chunk: the chunk.
        messages: their number.
        size: bytes of their payloads.
    """
    what = (
        f"the chunk at byte {chunk.offset} holds {messages} "
        f"{'message' if messages == 1 else 'messages'} of channels that are nowhere described"
    )
    return Loss(chunk.offset, what, size, messages)
