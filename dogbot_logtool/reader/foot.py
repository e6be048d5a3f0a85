"""A foot of a robot, and where messages tell of it."""

from dataclasses import MISSING, dataclass
from typing import Final

from dogbot_logtool.io.toml_table import (
    COUNT,
    FRAME,
    NOT_ZERO,
    NUMBER,
    POSITIVE,
    TEXT,
    VECTOR,
    Kind,
    one_of,
    toml_field,
)

NEWTONS: Final = {"N": 1.0, "kN": 1e3, "kg": 9.80665, "g": 9.80665e-3, "lbf": 4.4482216152605}
"""Newtons in units of force."""


_ENDS, _SIDES = ("front", "middle", "back"), ("left", "right", "centre")
_PAIRS: Final = [[end, side] for end in _ENDS for side in _SIDES]
_LEG_POSITION: Final = Kind('a pair such as ["front", "left"]', _PAIRS.__contains__, tuple)


@dataclass(frozen=True, slots=True)
class FootField:
    """A field of a message of any type that is a foot's force or contact."""

    path: str = toml_field(TEXT, MISSING, key="field")
    """From the message: ``data[3]``, ``legs[2].force``."""
    kind: str = toml_field(one_of("force", "contact"), "")
    """``force`` or ``contact``; empty: booleans and integers are contacts, all others forces."""
    scale: float = toml_field(NOT_ZERO, 1.0)
    """Units a recorded number."""
    unit: str = toml_field(one_of(*NEWTONS), "N")
    """One of `NEWTONS`."""
    sign: str = toml_field(one_of("+", "-"), "+")
    """Which sign a load has; of contacts, ``-`` where the field says that a foot is up."""
    axis: str = toml_field(one_of("x", "y", "z", "-x", "-y", "-z"), "")
    """``x``, ``-z`` ...: the axis of a vector along which the ground pushes the foot; empty: the
    vector is used as a whole."""
    threshold: float = toml_field(NUMBER, 0.0)
    """A number above it is a contact."""

    @property
    def newtons(self) -> float:
        """N a recorded number, with its sign."""
        return (-1.0 if self.sign == "-" else 1.0) * self.scale * NEWTONS[self.unit]


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot of a robot."""

    name: str
    topic: str = toml_field(TEXT, MISSING)
    """Contact topic; empty: the log has none."""
    collision: str = toml_field(TEXT, "")
    """Glob for the name of the foot's collision; empty: recognised by the names in the log."""
    leg_position: tuple[str, str] | None = toml_field(_LEG_POSITION, key="place")
    """("front" | "middle" | "back", "left" | "right" | "centre"); None when not known."""
    frame: str | None = toml_field(FRAME)
    """Frame that places the foot where its sensor tells no contact point; None: the sensor's."""
    contact_point_m: tuple[float, float, float] = toml_field(VECTOR, (0.0, 0.0, 0.0))
    """m, where the foot touches, in that frame."""
    element: int | None = toml_field(COUNT)
    """Place in the arrays of a message that tells of all feet; None: told by the message type."""
    label: str = toml_field(TEXT, "")
    """Its name in messages that name their feet; empty: found by its name and leg."""
    field: FootField | None = None
    """Which field of its messages is the foot's; None: the type of the messages tells."""
    offset: float = toml_field(NUMBER, 0.0)
    """Counts of a raw sensor, or a field's number, without load."""
    offset_n: tuple[float, float, float] | None = toml_field(VECTOR)
    """N, what its sensor reads without load; None: estimated from the log."""
    newtons_per_count: float | None = toml_field(POSITIVE)
    """Scale of a raw sensor; None: it was never measured."""

    sensor_of: str = toml_field(TEXT, "")
    """The foot that this is one of several sensors of; empty: it is a foot of its own."""

    @property
    def word(self) -> str:
        """Its topic and field, as ``--foot`` takes them."""
        return f"{self.topic}:{self.field.path}" if self.field else self.topic
