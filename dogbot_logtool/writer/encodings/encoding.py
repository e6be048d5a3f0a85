"""What an output encoding must offer, and what both have in common."""

from collections.abc import Mapping
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


@dataclass(frozen=True, slots=True)
class SupportShape:
    """What a support message holds; messages of one shape are of one size."""

    line_points: int
    """Points of the outline, one after the other."""
    pressure: bool
    """Whether the centre of pressure is known; also `projection`, the base's."""
    projection: bool
    footfalls: int


@dataclass(frozen=True, slots=True)
class SupportStyle:
    """What is the same for all support messages."""

    line_m: float
    """m, thickness of the outline."""
    mark_m: float
    """m, diameter of a footfall's mark."""
    lifetime_s: float


@dataclass(frozen=True, slots=True)
class BallLook:
    """How a point of a support message is drawn: as a sphere, or flat on the ground."""

    width: float
    """Times the diameter of a footfall's mark; also `height`."""
    height: float
    colour: tuple[float, float, float, float]
    """Red, green, blue, alpha; Okabe and Ito's, besides those of the outline."""


PRESSURE_LOOK: Final = BallLook(1.5, 1.5, (0.8, 0.475, 0.655, 1.0))
"""Reddish purple."""
PROJECTION_LOOK: Final = BallLook(1.5, 0.25, (0.337, 0.706, 0.914, 1.0))
"""Sky blue."""
FOOTFALL_LOOK: Final = BallLook(1.0, 0.25, (0.6, 0.6, 0.6, 1.0))
"""Grey."""


@dataclass(frozen=True, slots=True)
class SupportPoints:
    """Names of a support message's points."""

    line: tuple[str, ...]
    pressure: tuple[str, ...]
    projection: tuple[str, ...]
    footfalls: tuple[str, ...]

    @property
    def fields(self) -> Mapping[str, Kind]:
        """Their numbers."""
        names = (*self.line, *self.pressure, *self.projection, *self.footfalls)
        return {f"{name}.{axis}": Kind.FLOAT64 for name in names for axis in "xyz"}


def support_points(shape: SupportShape) -> SupportPoints:
    """Return the names of a support message's points."""
    return SupportPoints(
        line=tuple(f"line{number}" for number in range(shape.line_points)),
        pressure=("pressure",) * shape.pressure,
        projection=("projection",) * shape.projection,
        footfalls=tuple(f"footfall{number}" for number in range(shape.footfalls)),
    )


class Encoding(Protocol):
    """Makes templates of the annotations.

    Numbers are named alike in all encodings: ``stamp``; ``x``, ``y``, ``z`` of a position;
    ``qx``, ``qy``, ``qz``, ``qw`` of an orientation; ``length`` of an arrow or, where an encoding
    has none, ``shaft`` and ``head``; ``r``, ``g``, ``b``, ``a``; those of `LOAD_FIELDS`; and of
    each of the `support_points`, ``x``, ``y`` and ``z`` after its name and a dot.
    """

    transform_type: MessageType
    arrow_type: MessageType
    load_type: MessageType
    support_type: MessageType

    def transform(self, parent: str, child: str) -> Template:
        """Return a message of one transform."""

    def arrow(self, foot: str, frame: str, style: ArrowStyle) -> Template:
        """Return a message that draws a foot's arrow."""

    def removal(self, foot: str, frame: str) -> Template:
        """Return a message that removes a foot's arrow."""

    def load(self) -> Template:
        """Return a message that gives a foot's load."""

    def support(self, shape: SupportShape, frame: str, style: SupportStyle) -> Template:
        """Return a message that draws what the robot stands on; it replaces the one before."""
