"""Encodings of annotations: what all of them have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import partial
from typing import ClassVar, NamedTuple, Self

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.writer.described import STAMP, Described
from dogbot_logtool.writer.template import Columns, Literal, Of, Template, learn


class MessageType(NamedTuple):
    """One of our schemas, as an MCAP file describes it."""

    name: str
    schema_encoding: str
    schema: bytes
    message_encoding: str


class Encoding(ABC):
    """Makes messages, and templates of those that are many; `registry.py` lists the encodings."""

    profile: ClassVar[str] = ""
    """MCAP profile of a file in which all messages have this encoding."""
    types: Mapping[str, MessageType]
    """By the names of ROS 2's types; others have no message in this encoding."""
    kinds: ClassVar[Mapping[Of, str]]
    """How values are written: dtypes."""

    def __reduce__(self) -> "tuple[type[Self], tuple[()]]":
        """Be made anew in another process: classes of messages are made when it runs."""
        return type(self), ()

    @abstractmethod
    def own_terms(self, message: Described) -> Literal:
        """Return a message in the terms of this encoding."""

    @abstractmethod
    def serialise(self, name: str, literal: Literal) -> bytes:
        """Serialise a message without slots.

        Args:
            name: of its type in ROS 2.
            literal: in the terms of this encoding.
        """

    def message(self, message: Described) -> bytes:
        """Return a message that has no slots."""
        return self.serialise(message.name, self.own_terms(message))

    def template(self, message: Described) -> Template:
        """Learn how a message is written."""
        return learn(partial(self.serialise, message.name), self.own_terms(message), self.kinds)

    def stamp_columns(self, time: Ints) -> Columns:
        """Return times, (n,) ns, as the columns of a message's stamp."""
        # numpy divides by a constant several times faster than it takes the remainder.
        seconds = time // 1_000_000_000
        nanoseconds = time - seconds * 1_000_000_000
        names = [slot.name for slot in STAMP.values()]
        return dict(zip(names, (seconds, nanoseconds), strict=True))
