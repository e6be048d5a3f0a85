"""Encodings of annotations: what all of them have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Self

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.writer.drawing import Drawing, point_slots
from dogbot_logtool.writer.template import Columns, Kind, Literal, Of, Slot, Template, learn

LOAD_STATES: Final = ("stance", "swing", "unknown")
"""Values of a load's `state`, in the order of `LoadState`."""
EVENT_SOURCE: Final = "dogbot_logtool"
"""The program that log panels name."""
UPRIGHT: Final[Literal] = {"w": 1.0}
STAMP: Final = ("stamp.sec", "stamp.nanosec")
"""Slots of a message's time."""


@dataclass(frozen=True, slots=True)
class MessageType:
    """One of our schemas, as an MCAP file describes it."""

    name: str
    schema_encoding: str
    schema: bytes
    message_encoding: str


class Encoding(ABC):
    """Makes messages, and templates of those that are many; `registry.py` lists the encodings.

    Slots have the same names in all encodings: ``stamp.sec``, ``stamp.nanosec``; ``x``, ``y``,
    ``z`` of a position; ``qx``, ``qy``, ``qz``, ``qw`` of an orientation; those of transforms after
    their index and a dot; ``in_contact``, ``force``, ``force_bw``; and those of a `Drawing`.
    """

    transform_type: MessageType
    arrow_type: MessageType
    load_type: MessageType
    support_type: MessageType
    event_type: MessageType
    gait_type: MessageType
    span_type: MessageType | None = None
    """Message of events as spans of time; None: the encoding has none."""
    kinds: ClassVar[Mapping[Of, Kind]]
    """How values are written."""
    time_name: ClassVar[str]
    """The field of a load's and a gait's time."""
    time_fields: ClassVar[tuple[str, str]]
    """Fields of a time: seconds and nanoseconds."""

    def __reduce__(self) -> "tuple[type[Self], tuple[()]]":
        """Be made anew in another process: classes of messages are made when it runs."""
        return type(self), ()

    @abstractmethod
    def serialise(self, kind: MessageType, literal: Literal) -> bytes:
        """Serialise a message without slots."""

    @abstractmethod
    def _transform(self, parent: str, child: str, prefix: str) -> Literal:
        """Return one transform."""

    @abstractmethod
    def _drawing(self, drawing: Drawing) -> Literal:
        """Return a message that draws."""

    @abstractmethod
    def _removal(self, drawing: Drawing) -> Literal:
        """Return a message that removes a drawing."""

    @abstractmethod
    def event(self, event: EventMessage) -> bytes:
        """Return a message that log panels show."""

    def template(self, kind: MessageType, literal: Literal) -> Template:
        """Learn how a message is written."""
        return learn(lambda filled: self.serialise(kind, filled), literal, self.kinds)

    def transforms(self, pairs: Sequence[tuple[str, str]]) -> Template:
        """Return a message of the transforms of some parents and children."""
        each = [self._transform(*pair, f"{index}.") for index, pair in enumerate(pairs)]
        return self.template(self.transform_type, {"transforms": each})

    def drawing(self, drawing: Drawing) -> Template:
        """Return a message that draws."""
        several = len(drawing.primitives) > 1
        kind = self.support_type if several else self.arrow_type
        return self.template(kind, self._drawing(drawing))

    def removal(self, drawing: Drawing) -> Template:
        """Return a message that removes a drawing, whatever it is made of."""
        return self.template(self.arrow_type, self._removal(drawing))

    def load(self, state: str) -> Template:
        """Return a message that gives a foot's load in one of `LOAD_STATES`."""
        slots = {name: Slot(name) for name in ("force", "force_bw")}
        slots["in_contact"] = Slot("in_contact", Of.FLAG)
        return self.template(
            self.load_type, {self.time_name: self.stamp(), "state": state, **slots}
        )

    def span(self, event: EventMessage) -> bytes:
        """Return a message that gives an event from its begin to its end, of `span_type`."""
        raise NotImplementedError

    def gait(self, state: GaitState) -> bytes:
        """Return a message that gives the gait from a time on."""
        literal = {
            self.time_name: self.time(state.time),
            "gait": state.gait,
            "stride_frequency_hz": state.stride_frequency_hz,
            "duty_factor": state.duty_factor,
            "phases": list(state.phases),
        }
        return self.serialise(self.gait_type, literal)

    def time(self, time: int) -> Literal:
        """Return a time, ns."""
        return dict(zip(self.time_fields, divmod(time, 1_000_000_000), strict=True))

    def stamp(self) -> Literal:
        """Return the slots of the message's time."""
        return {
            field: Slot(name, Of.TIME) for field, name in zip(self.time_fields, STAMP, strict=True)
        }

    def stamp_columns(self, time: Ints) -> Columns:
        """Return times, (n,) ns, as the columns of a message's stamp."""
        # numpy divides by a constant several times faster than it takes the remainder.
        seconds = time // 1_000_000_000
        nanoseconds = time - seconds * 1_000_000_000
        return dict(zip(STAMP, (seconds, nanoseconds), strict=True))


def vector(values: Sequence[Slot | float]) -> Literal:
    """Return x, y and z."""
    return dict(zip("xyz", values, strict=True))


def colour(values: Sequence[Slot | float]) -> Literal:
    """Return red, green, blue and alpha."""
    return dict(zip("rgba", values, strict=True))


def position(prefix: str = "") -> Literal:
    """Return slots of a position."""
    return vector(point_slots(prefix))


def orientation(prefix: str = "") -> Literal:
    """Return slots of a quaternion."""
    return {axis: Slot(f"{prefix}q{axis}") for axis in "xyzw"}
