"""A foot of a robot, and where messages tell of it."""

from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FootField:
    """A field of a message of any type that is a foot's force or contact."""

    path: str
    """From the message: ``data[3]``, ``legs[2].force``."""
    kind: str = ""
    """``force`` or ``contact``; empty: booleans and integers are contacts, all others forces."""
    scale: float = 1.0
    """Units a recorded number."""
    newtons_per_unit: float = 1.0
    sign: int = 1
    """1 or -1: which sign a load has; of contacts, -1 where the field says that a foot is up."""
    axis: str = ""
    """``x``, ``-z`` ...: the axis of a vector along which the ground pushes the foot; empty: the
    vector is used as a whole."""
    threshold: float = 0.0
    """A number above it is a contact."""


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot of a robot."""

    name: str
    topic: str
    """Contact topic."""
    collision: str = ""
    """Glob for the name of the foot's collision; empty: recognised by the names in the log."""
    leg_position: tuple[str, str] | None = None
    """("front" | "middle" | "back", "left" | "right" | "centre"); None when not known."""
    frame: str | None = None
    """Frame that places the foot where its sensor tells no contact point; None: the sensor's."""
    contact_point_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, where the foot touches, in that frame."""
    element: int | None = None
    """Place in the arrays of a message that tells of all feet; None: told by the message type."""
    label: str = ""
    """Its name in messages that name their feet; empty: found by its name and leg."""
    field: FootField | None = None
    """Which field of its messages is the foot's; None: the type of the messages tells."""
    offset: float = 0.0
    """Counts of a raw sensor, or a field's number, without load."""
    offset_n: tuple[float, float, float] | None = None
    """N, what its sensor reads without load; None: estimated from the log."""
    newtons_per_count: float | None = None
    """Scale of a raw sensor; None: it was never measured."""
