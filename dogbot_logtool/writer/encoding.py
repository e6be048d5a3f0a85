"""What an output encoding must offer, and what both have in common."""

from dataclasses import dataclass
from typing import Final, Protocol

from dogbot_logtool.writer.template import Kind, Template

SHAFT_SHARE: Final = 0.77
"""Part of an arrow's length that is its shaft; viewers draw ROS markers so."""
HEAD_TO_SHAFT: Final = 2.0
"""Diameter of an arrow's head over its shaft's."""
LOAD_FIELDS: Final = {
    "in_contact": Kind.BOOL,
    "force": Kind.FLOAT64,
    "force_bw": Kind.FLOAT64,
}


@dataclass(frozen=True, slots=True)
class MessageType:
    """A schema of ours, as an MCAP file names it."""

    name: str
    schema_encoding: str
    schema: bytes
    message_encoding: str


@dataclass(frozen=True, slots=True)
class ArrowStyle:
    """What is the same for all arrows of a style."""

    shaft_diameter_m: float
    lifetime_s: float
    """0: for ever."""


class Encoding(Protocol):
    """Makes templates of the annotations.

    Numbers are named alike in all encodings: ``stamp``; ``x``, ``y``, ``z`` of a position;
    ``qx``, ``qy``, ``qz``, ``qw`` of an orientation; ``length`` of an arrow or, where an encoding
    has none, ``shaft`` and ``head``; ``r``, ``g``, ``b``, ``a``; and those of `LOAD_FIELDS`.
    """

    transform_type: MessageType
    arrow_type: MessageType
    load_type: MessageType

    def transform(self, parent: str, child: str) -> Template:
        """Return a message of one transform."""

    def arrow(self, foot: str, frame: str, style: ArrowStyle) -> Template:
        """Return a message that draws a foot's arrow."""

    def removal(self, foot: str, frame: str) -> Template:
        """Return a message that removes a foot's arrow."""

    def load(self) -> Template:
        """Return a message that gives a foot's load."""
