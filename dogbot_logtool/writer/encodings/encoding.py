"""Interface of output encodings, and their common parts."""

from collections.abc import Mapping, Sequence
from typing import Final, Protocol

from dogbot_logtool.core.events.event import EventMessage, GaitState
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.writer.template import Kind, Template

Rgb = tuple[float, float, float]
"""Red, green and blue in [0, 1]."""
SHAFT_SHARE: Final = 0.77
"""The shaft's share of an arrow's length, as viewers draw ROS markers."""
HEAD_TO_SHAFT: Final = 2.0
"""Diameter of an arrow's head over its shaft's."""
LOAD_STATES: Final = ("stance", "swing", "unknown")
"""Values of a load's `state`, in the order of `LoadState`."""
GAIT_NUMBERS: Final = ("stride_frequency_hz", "duty_factor")
"""Numbers of a gait's state, besides phases."""
EVENT_SOURCE: Final = "dogbot_logtool"
"""The program that log panels name."""
LOAD_FIELDS: Final = {
    "in_contact": Kind.BOOL,
    "force": Kind.FLOAT64,
    "force_bw": Kind.FLOAT64,
}


@dataclass(frozen=True, slots=True)
class MessageType:
    """One of our schemas, as an MCAP file describes it."""

    name: str
    schema_encoding: str
    schema: bytes
    message_encoding: str


@dataclass(frozen=True, slots=True)
class ArrowLook:
    """How all arrows of a style look."""

    shaft_diameter_m: float
    lifetime_s: float
    """0: for ever."""


@dataclass(frozen=True, slots=True)
class SupportShape:
    """Content of a support message; messages of one shape have one size."""

    line_points: int
    """Points of the outline."""
    pressure: bool
    """Whether the centre of pressure is known; also `projection`, the base's."""
    projection: bool
    touchdowns: int


@dataclass(frozen=True, slots=True)
class SupportLook:
    """How all support messages look."""

    line_m: float
    """m, thickness of the outline."""
    mark_m: float
    """m, diameter of a touchdown's mark."""
    lifetime_s: float


@dataclass(frozen=True, slots=True)
class BallLook:
    """How a point of a support message is drawn: as a sphere, or flat on the ground."""

    width: float
    """Times the diameter of a touchdown's mark; also `height`."""
    height: float
    colour: tuple[float, float, float, float]
    """Red, green, blue, alpha; Okabe and Ito's, besides those of the outline."""


PRESSURE_LOOK: Final = BallLook(1.5, 1.5, (0.8, 0.475, 0.655, 1.0))
"""Reddish purple."""
PROJECTION_LOOK: Final = BallLook(1.5, 0.25, (0.337, 0.706, 0.914, 1.0))
"""Sky blue."""
TOUCHDOWN_LOOK: Final = BallLook(1.0, 0.25, (0.6, 0.6, 0.6, 1.0))
"""Touchdowns have the colours of their feet."""
LABEL_HEIGHT_M: Final = 0.05
LABEL_COLOUR: Final = (0.95, 0.95, 0.95, 1.0)
"""Pale: Foxglove writes it on black, RViz has a dark ground."""
LABEL_WIDTH: Final = 6
"""Characters of the number and its unit in a label, padded with spaces."""


@dataclass(frozen=True, slots=True)
class SupportPoints:
    """Names of a support message's points."""

    line: tuple[str, ...]
    pressure: tuple[str, ...]
    projection: tuple[str, ...]
    touchdowns: tuple[str, ...]

    @property
    def fields(self) -> Mapping[str, Kind]:
        """Their numbers."""
        names = (*self.line, *self.pressure, *self.projection, *self.touchdowns)
        return {f"{name}.{axis}": Kind.FLOAT64 for name in names for axis in "xyz"}

    def colours(self, kind: Kind) -> Mapping[str, Kind]:
        """The numbers of the touchdowns' colours, each of a kind."""
        return {f"{name}.{part}": kind for name in self.touchdowns for part in "rgb"}


def support_points(shape: SupportShape) -> SupportPoints:
    """Return the names of a support message's points."""
    return SupportPoints(
        line=tuple(f"line{number}" for number in range(shape.line_points)),
        pressure=("pressure",) * shape.pressure,
        projection=("projection",) * shape.projection,
        touchdowns=tuple(f"touchdown{number}" for number in range(shape.touchdowns)),
    )


LEG_COLOUR: Final = (0.36, 0.39, 0.44, 1.0)
"""Colour of a leg's line at the hip; at its foot it has the foot's colour."""


def leg_points(legs: int) -> tuple[str, ...]:
    """Return the names of the points of some legs' lines: each hip, then its foot."""
    return tuple(f"{end}{leg}" for leg in range(legs) for end in ("hip", "foot"))


def leg_fields(legs: int) -> Mapping[str, Kind]:
    """Return the numbers of some legs' lines."""
    return {f"{point}.{axis}": Kind.FLOAT64 for point in leg_points(legs) for axis in "xyz"}


def numbered(fields: Mapping[str, Kind], count: int) -> Mapping[str, Kind]:
    """Return fields for each of a count, named after its index and a dot."""
    return {f"{index}.{name}": kind for index in range(count) for name, kind in fields.items()}


class Encoding(Protocol):
    """Makes templates of the annotations; `registry.py` lists the encodings.

    Numbers have the same names in all encodings: ``stamp``; ``x``, ``y``, ``z`` of a position;
    ``qx``, ``qy``, ``qz``, ``qw`` of an orientation; ``length`` of an arrow or, where an encoding
    has none, ``shaft`` and ``head``; ``r``, ``g``, ``b``, ``a``; those of `LOAD_FIELDS`; ``text``
    of a label; and of each of the `support_points` and `leg_points`, ``x``, ``y`` and ``z`` after
    its name and a dot, of touchdowns also ``r``, ``g`` and ``b``.
    """

    transform_type: MessageType
    arrow_type: MessageType
    load_type: MessageType
    support_type: MessageType
    event_type: MessageType
    gait_type: MessageType
    span_type: MessageType | None
    """Message of events as spans of time; None: the encoding has none."""

    def __hash__(self) -> int:
        """Return a hash: templates are kept by encoding."""
        ...

    def transform(self, parent: str, child: str) -> Template:
        """Return a message of one transform."""

    def transforms(self, pairs: Sequence[tuple[str, str]]) -> Template:
        """Return a message of the transforms of some parents and children.

        Numbers of each have the names of `transform`'s after its index: ``0.stamp``, ``0.x`` ...
        """

    def arrow(self, foot: str, frame: str, style: ArrowLook) -> Template:
        """Return a message that draws a foot's arrow."""

    def removal(self, foot: str, frame: str) -> Template:
        """Return a message that removes a foot's arrow."""

    def label(self, foot: str, frame: str, name: str, lifetime_s: float) -> Template:
        """Return a message that writes a foot's load beside it, after a short name."""

    def load(self, state: str) -> Template:
        """Return a message that gives a foot's load in one of `LOAD_STATES`."""

    def support(self, shape: SupportShape, frame: str, style: SupportLook) -> Template:
        """Return a message that draws what the robot stands on; it replaces the one before."""

    def legs(self, colours: Sequence[Rgb], frame: str, look: SupportLook) -> Template:
        """Return a message of lines from hips to feet of some colours; none removes the lines."""

    def event(self, event: EventMessage) -> bytes:
        """Return a message that log panels show."""

    def span(self, event: EventMessage) -> bytes:
        """Return a message that gives an event from its begin to its end, of `span_type`."""

    def gait(self, state: GaitState) -> bytes:
        """Return a message that gives the gait from a time on."""
