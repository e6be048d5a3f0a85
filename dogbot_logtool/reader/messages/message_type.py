"""A row of the table of message types: where in a message feet, base, joints and vectors are.

Paths are in the language of `reader.decode.paths`. Beside that,

- ``a|b`` is the first of several that the log's definition has, and ``a|`` one that it may lack;
- ``{}`` stands for the words of `each`, one a leg.
"""

from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.decode.paths import Want

Paths = str | tuple[str, ...]
"""A path, or one a leg."""


class Pairs(NamedTuple):
    """Where Gazebo's contact sensors have pairs of bodies that touch; paths inside `array`."""

    array: str
    bodies: tuple[str, str]
    points: str
    normals: str
    force: str
    """Of an element of `wrenches`, N on body 1."""
    total: str = ""
    """Their sum, as recorded; empty: they are added up."""
    info: str = ""
    """Text that tells the physics step; empty: a message is one step."""

    @property
    def paths(self) -> Mapping[str, Want]:
        """Everything that is read."""
        return {
            **{f"{self.array}[].{text}": "text" for text in (*self.bodies, self.info) if text},
            f"{self.array}[].{self.points}[]": "xyz",
            f"{self.array}[].{self.normals}[]": "xyz",
            f"{self.array}[].wrenches[].{self.force}": "xyz",
            **({f"{self.array}[].{self.total}": "xyz"} if self.total else {}),
        }


class MessageType(NamedTuple):
    """How messages of a type tell of the feet, of the base, of joints, or of several of these."""

    name: str
    """``package/Name``."""
    # When, and of whom.
    stamp: str = "header.stamp"
    """Empty: log time is the only time."""
    frame: str = "header.frame_id"
    """The frame that forces or poses are in."""
    planned: Literal["never", "by name", "always"] = "never"
    """Whether it tells what shall be; by name: where the topic's name says so."""
    anything: bool = False
    """Such messages can be about anything: only topics that name a foot or the base are taken."""
    topic_end: str = ""
    """End of the names of topics that are about feet, where others of this type are not."""
    # Feet.
    legs: tuple[str, ...] = ()
    """Names of the feet in the order of the message, where that is always the same."""
    each: tuple[str, ...] = ()
    """Words for each leg, in place of ``{}``."""
    label: str = ""
    """Name of the foot, beside its values; then the order does not matter."""
    only: str = ""
    """A number beside the label that is 0 of feet; others are hands."""
    by_place: bool = False
    """Whether the legs are told by where the feet are, seen from the base."""
    maybe_without_legs: bool = False
    """Whether robots without legs send it, too: then it has no forces."""
    flag: Paths = ""
    """Whether the foot touches; it decides, whatever the force."""
    closed: tuple[int, ...] = ()
    """Values of the flag that mean contact; none: all whose magnitude is `above`."""
    open: tuple[int, ...] = ()
    """Values that mean none; where `closed` stands, all others are not known."""
    above: float = 0.0
    force: Paths = ""
    """N on the foot, a vector or a number; `unit` says what else."""
    point: Paths = ""
    normal: Paths = ""
    """Of the ground, into the foot."""
    pairs: Pairs | None = None
    """Pairs of bodies, of which one is the foot."""
    unit: Literal["N", "counts"] = "N"
    """Counts are newtons only with the scale and offset in the robot's file."""
    axes: WrenchFrame | None = WrenchFrame.UNKNOWN
    """The frame of the forces; None: evidence decides. A link's: that of the header."""
    points_in: Literal["world", "base"] = "world"
    point_in_swing: bool = False
    """Whether `point` also tells where a foot in the air is."""
    silent_in_swing: bool = False
    """It is published only while in contact, so that absence is swing."""
    words: tuple[str, ...] = ()
    """Paths that users or robots' files name, one a foot; their feet say what the numbers mean."""
    one_axis: bool = False
    """Its sensors have one axis, along which a foot can only press."""
    # The base.
    position: str = ""
    orientation: str = ""
    """Quaternion x, y, z, w, or numbers in the order of `turned`."""
    turned: Literal["xyzw", "wxyz", "xyz", "zyx"] = "xyzw"
    """Three letters are angles of roll (x), pitch and yaw."""
    linear: str = ""
    """m/s."""
    numbered: tuple[str, ...] = ()
    """Number and position of the base's joints: roll, pitch, yaw, x, y, z, counted from 0."""
    body: str = ""
    """The frame that the pose places."""
    choose: tuple[str, ...] = ()
    """Names beside each pose, of which the user's choice is one: a model, a pair of frames."""
    on_request: bool = False
    """Only used if the user names it."""
    remark: str = ""
    """Caveats on its poses."""
    # Joints, and vectors that single messages hold.
    joint: str = ""
    """Names of the joints."""
    joints: tuple[str, ...] = ()
    """The same, where the messages do not tell them."""
    joint_position: str = ""
    joint_velocity: str = ""
    joint_effort: str = ""
    command: tuple[str, ...] = ()
    """Linear x and y in m/s and angular z in rad/s."""
    acceleration: str = ""
    """m/s^2, of an inertial unit."""
    turn_rate: str = ""
    """rad/s, of the same."""

    def paths(self, field: str) -> tuple[str, ...]:
        """Return the paths of a field, a path a leg where it has ``{}``."""
        value = getattr(self, field)
        if isinstance(value, tuple):
            return value
        if "{}" in value:
            return tuple(value.replace("{}", word) for word in self.each)
        return (value,) if value else ()


Part = Literal["feet", "base", "joints", "commands", "accelerations"]
"""What a row may tell of."""
TOLD_BY: Final[Mapping[Part, tuple[str, ...]]] = {
    "feet": ("flag", "force", "pairs"), "base": ("position", "numbered"),
    "joints": ("joint_position",), "commands": ("command",), "accelerations": ("acceleration",),
}  # fmt: skip
"""Fields of a row of which one is filled in if it tells of that part."""
WANTS: Final[Mapping[Part, Mapping[str, Want]]] = {
    "feet": {"stamp": "time", "frame": "text", "label": "text", "only": "number",
             "flag": "number", "force": "xyz", "point": "xyz", "normal": "xyz"},
    "base": {"position": "xyz", "orientation": "xyzw", "stamp": "time", "frame": "text",
             "body": "text", "choose": "text", "numbered": "number", "linear": "xyz"},
    "joints": {"stamp": "time", "joint": "text", "joint_position": "number",
               "joint_velocity": "number", "joint_effort": "number"},
    "commands": {"command": "number", "stamp": "time", "frame": "text"},
    "accelerations": {"acceleration": "xyz", "turn_rate": "xyz", "stamp": "time",
                      "frame": "text"},
}  # fmt: skip
"""The fields of a row that are read of each part, and what they lead to."""
COPIED: Final[tuple[Part, ...]] = ("feet", "base")
"""Parts that are read of any package: drivers copy messages into packages of their own."""
